//! A row of two bodies, and how softly it gives.

use crate::spatial::{Vec6, ZERO6, dot, join};
use sinew_math::Vec3;

/// Coefficients of a soft constraint (Catto, "Soft Constraints", GDC 2011).
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Softness {
    /// 1/s.
    pub bias_rate: f32,
    pub mass_scale: f32,
    pub impulse_scale: f32,
}

impl Softness {
    pub fn new(hertz: f32, damping_ratio: f32, h: f32) -> Self {
        let omega = 2.0 * core::f32::consts::PI * hertz;
        let a1 = 2.0 * damping_ratio + h * omega;
        let a2 = h * omega * a1;
        let a3 = 1.0 / (1.0 + a2);
        Self { bias_rate: omega / a1, mass_scale: a2 * a3, impulse_scale: a3 }
    }
}

/// The two bodies that a row acts on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub a: u32,
    pub b: u32,
}

/// A row's Jacobian on both bodies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub a: Vec6,
    pub b: Vec6,
}

impl Row {
    pub const ZERO: Self = Self { a: ZERO6, b: ZERO6 };

    pub fn at(direction: Vec3, arm_a: Vec3, arm_b: Vec3) -> Self {
        Self { a: join(-direction, -arm_a.cross(direction)), b: join(direction, arm_b.cross(direction)) }
    }

    pub fn about(axis: Vec3) -> Self {
        Self { a: join(Vec3::ZERO, -axis), b: join(Vec3::ZERO, axis) }
    }

    pub fn rate(&self, pair: Pair, velocities: &[Vec6]) -> f32 {
        dot(&self.a, &velocities[pair.a as usize]) + dot(&self.b, &velocities[pair.b as usize])
    }

    /// On A and on B.
    pub fn ends(&self) -> [&Vec6; 2] {
        [&self.a, &self.b]
    }

    pub fn dot(&self, other: &Self) -> f32 {
        dot(&self.a, &other.a) + dot(&self.b, &other.b)
    }
}
