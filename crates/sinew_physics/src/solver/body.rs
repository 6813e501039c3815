//! A body of an island, and how it answers to impulses by itself.

use crate::spatial::{Vec6, add_scaled, angular, dot, join, linear};
use sinew_math::{Sym3, Transform, Vec3};

/// A body of the island. Moving ones come first, in tree order; fixed ones (static, kinematic, asleep) follow.
#[derive(Clone, Debug)]
pub(crate) struct SolverBody {
    /// World index.
    pub index: u32,
    pub pose: Transform,
    pub mass: f32,
    /// Principal moments.
    pub inertia: Vec3,
    /// Moments added for stability, kg·m²: geometric stiffness beyond what the inertia can carry.
    pub excess: Vec3,
    /// Factor on mass and inertia in the body's answer to forces and impulses: 1 unless it is squeezed.
    pub mass_scale: f32,
    /// Inverse of inertia and excess with mass scaling, world axes.
    pub inverse_inertia: Sym3,
    /// Gravity's, the user's and those of fields, N and N·m.
    pub force: Vec3,
    pub torque: Vec3,
    /// Angular momentum that the body would have at the substep's end without impulses, N·m·s.
    pub(super) momentum: Vec3,
    pub linear_damping: f32,
    pub angular_damping: f32,
    /// In a substep of this step it was faster than the world lets it be.
    pub is_limited: bool,
}

/// A row's answer to its own impulse if nothing held the bodies; those from `moving` on are fixed.
pub(super) fn free_response(bodies: &[SolverBody], moving: usize, ends: [(u32, &Vec6); 2]) -> f32 {
    let on = |(body, row): (u32, &Vec6)| match bodies.get(body as usize) {
        Some(of) if (body as usize) < moving => dot(row, &of.velocity_change(row)),
        _ => 0.0,
    };
    on(ends[0]) + on(ends[1])
}

impl SolverBody {
    /// N·m·s, without what geometric stiffness adds.
    pub(super) fn angular_momentum(&self, w: Vec3) -> Vec3 {
        self.pose.rotation.turn(self.pose.rotation.inverse().turn(w) * self.inertia)
    }

    /// Answer to an impulse if no joint held it.
    pub(super) fn velocity_change(&self, p: &Vec6) -> Vec6 {
        join(linear(p) / (self.mass * self.mass_scale), self.inverse_inertia * angular(p))
    }
}

/// Pose after moving with a velocity for `h` seconds.
pub(super) fn advance(pose: &Transform, v: &Vec6, h: f32) -> Transform {
    Transform::new(pose.translation + linear(v) * h, pose.rotation.integrate(angular(v), h))
}

/// Adds `row · impulse` to a body, if it moves.
pub(super) fn add_row(impulses: &mut [Vec6], body: u32, row: &Vec6, impulse: f32) {
    if let Some(p) = impulses.get_mut(body as usize) {
        add_scaled(p, row, impulse);
    }
}
