//! Results of the islands' substeps, which the world copies.

use crate::body::Velocity;
use crate::body::external_work::Work;
use crate::collide::Manifold;
use crate::contact::ContactMemory;
use crate::island::Island;
use crate::joint::{LimitImpulse, MAX_LIMITS, Saturation};
use crate::slices::split_off;
use crate::spatial::Vec6;
use sinew_math::{Transform, Vec3};

/// A moving body after the step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SolvedBody {
    /// Index of the body in the world.
    pub index: u32,
    pub pose: Transform,
    pub velocity: Velocity,
    /// True if the body exceeded the world's speed limits in a substep.
    pub is_limited: bool,
}

/// State that a joint keeps for the next step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SolvedJoint {
    /// Index of the joint in the world.
    pub index: u32,
    pub limits: [LimitImpulse; MAX_LIMITS],
    pub force: Vec3,
    pub warm_impulse: Vec6,
    pub saturated: Saturation,
    pub mass: Vec6,
    /// Sum of the impulses on B in all substeps, torque about B's anchor, N·s and N·m·s.
    pub reaction: Vec6,
}

/// State that a contact keeps for the next step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SolvedContact {
    /// Index of the contact in the world's contact array.
    pub index: u32,
    /// Manifold of the contact, if it was recomputed within the step.
    pub found: Option<Manifold>,
    pub memory: ContactMemory,
}

/// Results of all islands, one after the other.
#[derive(Clone, Debug, Default)]
pub(crate) struct Solution {
    pub bodies: Vec<SolvedBody>,
    pub joints: Vec<SolvedJoint>,
    pub contacts: Vec<SolvedContact>,
    /// Work in each island.
    pub work: Vec<Work>,
}

impl Solution {
    /// Resizes the lists.
    pub fn resize(&mut self, islands: usize, bodies: usize, joints: usize, contacts: usize) {
        // There are never more islands than bodies, even when islands merge and split.
        self.work.clear();
        self.work.reserve(bodies);
        self.work.resize(islands, Work::default());
        self.bodies.resize(bodies, SolvedBody::default());
        self.joints.resize(joints, SolvedJoint::default());
        self.contacts.resize(contacts, SolvedContact::default());
    }

    /// Returns the storage of all islands, to be split among them.
    pub fn as_mut(&mut self) -> IslandSolution<'_> {
        IslandSolution {
            bodies: &mut self.bodies,
            joints: &mut self.joints,
            contacts: &mut self.contacts,
            work: &mut self.work,
        }
    }
}

/// Storage for the results of one or several islands.
pub(crate) struct IslandSolution<'a> {
    pub(super) bodies: &'a mut [SolvedBody],
    pub(super) joints: &'a mut [SolvedJoint],
    pub(super) contacts: &'a mut [SolvedContact],
    pub(super) work: &'a mut [Work],
}

impl<'a> IslandSolution<'a> {
    /// Splits off the storage of the first island.
    pub fn split_off(&mut self, island: &Island<'_>) -> Self {
        Self {
            bodies: split_off(&mut self.bodies, island.bodies.len()),
            joints: split_off(&mut self.joints, island.joints.len()),
            contacts: split_off(&mut self.contacts, island.contacts.len()),
            work: split_off(&mut self.work, 1),
        }
    }
}
