//! A row of two bodies, and its softness.

use crate::collide::{MAX_POINTS, Manifold};
use crate::contact::ContactMemory;
use crate::solver::tuning::{CONTACT_DAMPING, CONTACT_HERTZ, FIXED_HERTZ, WEIGHT_EVENLY, WEIGHT_OF_LOAD};
use crate::spatial::{Vec6, ZERO6, dot, join};
use sinew_math::{Vec3, min};

/// Coefficients of a soft constraint (Catto, "Soft Constraints", GDC 2011).
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Softness {
    /// Rate at which the position error decays, 1/s.
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

    /// Returns the Jacobians on A and on B.
    pub fn ends(&self) -> [&Vec6; 2] {
        [&self.a, &self.b]
    }

    pub fn dot(&self, other: &Self) -> f32 {
        dot(&self.a, &other.a) + dot(&self.b, &other.b)
    }
}

/// Separation divided by the substep for a point that cannot touch in any substep, m/s.
pub(in crate::solver) const NEVER: f32 = 1e6;

/// Softness of a contact before its firmness is applied, in a substep of `h` seconds.
pub(in crate::solver) fn contact_softness(both_move: bool, h: f32) -> Softness {
    let hertz = if both_move { CONTACT_HERTZ } else { FIXED_HERTZ };
    Softness::new(min(hertz, 0.25 / h), CONTACT_DAMPING, h)
}

/// Share of the load at each point. A point with a separation of at most `bearing` gets a smoothed share before it
/// bears any load.
pub(in crate::solver) fn weights(
    memory: &ContactMemory,
    manifold: &Manifold,
    bearing: f32,
) -> [f32; MAX_POINTS] {
    let points = manifold.points();
    let total: f32 = memory.points[..points.len()].iter().map(|point| point.now).sum();
    let bears = |separation: f32| separation <= bearing;
    let heirs = points.iter().filter(|point| bears(point.separation)).count();
    let mut weights = [0.0; MAX_POINTS];
    for (i, point) in points.iter().enumerate() {
        let even = match heirs {
            0 => 1.0 / points.len() as f32,
            _ if bears(point.separation) => 1.0 / heirs as f32,
            _ => 0.0,
        };
        let share = if total > 0.0 { memory.points[i].now / total } else { even };
        weights[i] = WEIGHT_OF_LOAD * share + WEIGHT_EVENLY * even;
    }
    weights
}
