//! A body of an island, and its response to impulses without joints.

use crate::spatial::{Vec6, add_scaled, angular, dot, join, linear};
use sinew_math::{Sym3, Transform, Vec3};

/// A body of the island. Moving bodies come first, in tree order; fixed bodies (static, kinematic, asleep) follow.
#[derive(Clone, Debug)]
pub(crate) struct SolverBody {
    /// Index in the world.
    pub index: u32,
    pub pose: Transform,
    pub mass: f32,
    /// Principal moments of inertia, kg·m².
    pub inertia: Vec3,
    /// Moments added for stability, kg·m²: the geometric stiffness that exceeds the inertia.
    pub excess: Vec3,
    /// Factor on the mass and inertia that respond to forces and impulses; 1 without mass scaling.
    pub mass_scale: f32,
    /// Inverse of inertia plus excess, with mass scaling, world axes.
    pub inverse_inertia: Sym3,
    /// Force and torque of gravity, the user and fields, N and N·m.
    pub force: Vec3,
    pub torque: Vec3,
    /// Angular momentum that the body would have at the substep's end without impulses, N·m·s.
    pub(super) momentum: Vec3,
    pub linear_damping: f32,
    pub angular_damping: f32,
    /// True if the body exceeded the world's speed limits in a substep of this step.
    pub is_limited: bool,
}

/// Response of a row to its own impulse, ignoring all joints. Bodies from `moving` on are fixed.
pub(super) fn free_response(bodies: &[SolverBody], moving: usize, ends: [(u32, &Vec6); 2]) -> f32 {
    let on = |(body, row): (u32, &Vec6)| match bodies.get(body as usize) {
        Some(of) if (body as usize) < moving => dot(row, &of.velocity_change(row)),
        _ => 0.0,
    };
    on(ends[0]) + on(ends[1])
}

impl SolverBody {
    /// Angular momentum at angular velocity `w`, N·m·s, without the added stiffness moments.
    pub(super) fn angular_momentum(&self, w: Vec3) -> Vec3 {
        self.pose.rotation.turn(self.pose.rotation.inverse().turn(w) * self.inertia)
    }

    /// Velocity change from an impulse, ignoring all joints.
    pub(super) fn velocity_change(&self, p: &Vec6) -> Vec6 {
        join(linear(p) / (self.mass * self.mass_scale), self.inverse_inertia * angular(p))
    }
}

/// Pose of a body after moving at velocity `v` for `h` seconds.
pub(super) fn advance(pose: &Transform, v: &Vec6, h: f32) -> Transform {
    Transform::new(pose.translation + linear(v) * h, pose.rotation.integrate(angular(v), h))
}

/// Adds `row · impulse` to a body, if it moves.
pub(super) fn add_row(impulses: &mut [Vec6], body: u32, row: &Vec6, impulse: f32) {
    if let Some(p) = impulses.get_mut(body as usize) {
        add_scaled(p, row, impulse);
    }
}
