//! Who touches whom in a pile, and how hard.

use crate::collide::{MAX_POINTS, ManifoldPoint};
use crate::contact::{Contact, PointImpulse};
use crate::solver::tuning::STANDING_SPEED;
use sinew_math::Vec3;

/// Impulses that press on a body in a substep, N·s: their vector sum, and the sum of their sizes.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::solver) struct Pressing {
    sum: Vec3,
    size: f32,
}

/// Two bodies that touch, when a step begins.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Touch {
    /// Local.
    pub bodies: [u32; 2],
    /// From A to B.
    pub normal: Vec3,
    /// Impulse on B along the normal in the last substep, or guessed for this one, N·s.
    pub load: f32,
    /// Gap below which points are taken for touching, metres.
    slop: f32,
    /// They touch, and do not know their load yet.
    pub is_new: bool,
}

impl Touch {
    /// Two bodies with what presses between them in a substep.
    pub fn pressing(bodies: [u32; 2], normal: Vec3, load: f32) -> Self {
        Self { bodies, normal, load, slop: 0.0, is_new: false }
    }

    /// A contact in substeps `stretch` times as long as the world's. What comes in fast does not stand there.
    pub fn new(bodies: [u32; 2], contact: &Contact, stretch: f32, slop: f32) -> Self {
        let points = contact.manifold.points();
        let load =
            stretch * contact.memory.points[..points.len()].iter().fold(0.0, |sum, point| sum + point.now);
        let is_new = load == 0.0
            && contact.approach < STANDING_SPEED
            && points.iter().any(|point| point.separation < slop);
        Self { bodies, normal: contact.manifold.normal, load, slop, is_new }
    }

    /// Impulses that the points of the contact start with if its load is guessed, in substeps of the world's: equal parts to
    /// those that touch.
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

    /// The part that cancels itself.
    pub(super) fn scaled_load(&self) -> f32 {
        0.5 * (self.size - self.sum.length())
    }
}
