//! Touching pairs of a pile, and their loads.

use crate::collide::{MAX_POINTS, ManifoldPoint};
use crate::contact::{Contact, PointImpulse};
use crate::solver::tuning::STANDING_SPEED;
use sinew_math::Vec3;

/// Impulses on a body in a substep, N·s: their vector sum, and the sum of their magnitudes.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::solver) struct Pressing {
    sum: Vec3,
    size: f32,
}

/// Two bodies that touch at the start of a step.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Touch {
    /// Local indices of the bodies.
    pub bodies: [u32; 2],
    /// Normal from A to B.
    pub normal: Vec3,
    /// Impulse on B along the normal in the last substep, or the guess for this one, N·s.
    pub load: f32,
    /// Gap below which points count as touching, metres.
    slop: f32,
    /// True if the bodies touch but the load between them is not known yet.
    pub is_new: bool,
}

impl Touch {
    /// Creates a touch of two bodies with the load between them in a substep.
    pub fn pressing(bodies: [u32; 2], normal: Vec3, load: f32) -> Self {
        Self { bodies, normal, load, slop: 0.0, is_new: false }
    }

    /// Creates a touch from a contact, for substeps `stretch` times as long as the world's. A body that approaches fast
    /// does not stand.
    pub fn new(bodies: [u32; 2], contact: &Contact, stretch: f32, slop: f32) -> Self {
        let points = contact.manifold.points();
        let load =
            stretch * contact.memory.points[..points.len()].iter().fold(0.0, |sum, point| sum + point.now);
        let is_new = load == 0.0
            && contact.approach < STANDING_SPEED
            && points.iter().any(|point| point.separation < slop);
        Self { bodies, normal: contact.manifold.normal, load, slop, is_new }
    }

    /// Starting impulses of the contact's points if its load is guessed, in substeps of the world's length: equal parts
    /// for the touching points.
    pub fn started(&self, contact: &Contact, stretch: f32) -> Option<[PointImpulse; MAX_POINTS]> {
        if !self.is_new || self.load == 0.0 {
            return None;
        }
        let touches = |point: &&ManifoldPoint| point.separation < self.slop;
        let count = contact.manifold.points().iter().filter(touches).count();
        let part = self.load / (stretch * count as f32);
        let mut started = [PointImpulse::default(); MAX_POINTS];
        for (impulse, _) in
            started.iter_mut().zip(contact.manifold.points()).filter(|(_, point)| touches(point))
        {
            *impulse = PointImpulse { now: part, before: part, lasting: part, total: 0.0 };
        }
        Some(started)
    }
}

impl Pressing {
    pub(super) fn add(&mut self, push: Vec3, size: f32) {
        self.sum += push;
        self.size += size;
    }

    /// Returns the part of the load that cancels itself, N·s.
    pub(super) fn scaled_load(&self) -> f32 {
        0.5 * (self.size - self.sum.length())
    }
}
