//! View of the world for islands and their solvers.

use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::Body;
use crate::body::def::{Quality, WorldDef};
use crate::contact::Contact;
use crate::contact::modifiers::Modifiers;
use crate::contact::proxies::Proxies;
use crate::context::StepContext;
use crate::field::Fields;
use crate::joint::Joint;
use sinew_math::Vec3;

/// View of the world for islands and their solvers: bodies, joints, contacts and settings.
pub(crate) struct View<'a> {
    pub bodies: &'a Arena<Body>,
    pub activity: &'a Activity,
    pub proxies: &'a Proxies,
    pub joints: &'a Arena<Joint>,
    pub contacts: &'a [Contact],
    pub modifiers: &'a Modifiers,
    pub def: &'a WorldDef,
    pub fields: Fields<'a>,
    pub pace: Pace,
}

impl View<'_> {
    /// Quality of a body: its own, otherwise that of the world.
    pub fn quality(&self, body: u32) -> Quality {
        self.bodies.at(body).quality.unwrap_or(self.def.quality)
    }
}

/// Substeps of the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    /// Length of a substep, seconds; and the number of substeps in a step.
    pub h: f32,
    pub substeps: u32,
    pub grading: Grading,
}

impl Pace {
    pub fn new(context: &StepContext<'_>, grading: Grading) -> Self {
        Self { h: context.h, substeps: context.substeps, grading }
    }

    /// Length of substeps `times` as long, seconds, and their number in a step.
    pub fn stretched(&self, times: f32) -> (f32, u32) {
        (self.h * times, (self.substeps as f32 / times) as u32)
    }
}

/// Rule that decides whether an island may take fewer substeps than the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Grading {
    /// The content of the island decides.
    ByContent,
    /// All islands take the world's substeps.
    None,
}

/// Force and torque that act on a body for the whole step: gravity and the forces of the user.
pub(super) fn lasting_force(body: &Body, view: &View<'_>) -> (Vec3, Vec3) {
    (body.force + view.def.gravity * (body.gravity_scale * body.mass), body.torque)
}
