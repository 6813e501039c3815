//! Bodies locked rigidly to each other: their mass and their response to rows.

use crate::joint::DIRECTIONS;
use crate::solver::body::SolverBody;
use crate::spatial::{Vec6, angular, linear};
use sinew_math::{Sym3, Vec3};

/// Mass, first moment and inertia of rigidly connected bodies about a common reference point.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::solver) struct Piece {
    mass: f32,
    moment: Vec3,
    inertia: Sym3,
}

impl Piece {
    pub(in crate::solver) fn of(body: &SolverBody, reference: Vec3) -> Self {
        let arm = body.pose.translation - reference;
        let own = Sym3::from_rotated_diagonal(body.pose.rotation, body.inertia);
        Self { mass: body.mass, moment: arm * body.mass, inertia: own + parallel_axis(arm) * body.mass }
    }

    pub(in crate::solver) fn plus(self, other: &Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            moment: self.moment + other.moment,
            inertia: self.inertia + other.inertia,
        }
    }

    pub(super) fn minus(self, other: &Self) -> Self {
        Self {
            mass: self.mass - other.mass,
            moment: self.moment - other.moment,
            inertia: self.inertia - other.inertia,
        }
    }

    /// Adds the velocity response matrix of rows on this piece. Each row is given for a body whose centre is at `arm` from the reference
    /// point. A piece without mass adds nothing.
    pub(super) fn add_response(&self, rows: &[Vec6], arm: Vec3, out: &mut [Vec6; DIRECTIONS]) {
        if self.mass <= 0.0 {
            return;
        }
        let center = self.moment / self.mass;
        let inverse = (self.inertia - parallel_axis(center) * self.mass).inverse();
        let wrench = |row: &Vec6| (linear(row), angular(row) + (arm - center).cross(linear(row)));
        for (i, row) in rows.iter().enumerate() {
            let (force, torque) = wrench(row);
            let (push, turn) = (force / self.mass, inverse * torque);
            for (k, other) in rows.iter().enumerate() {
                let (force, torque) = wrench(other);
                out[i][k] += push.dot(force) + turn.dot(torque);
            }
        }
    }
}

/// Computes `|r|² 1 − r rᵀ`.
fn parallel_axis(arm: Vec3) -> Sym3 {
    Sym3::from_diagonal(Vec3::splat(arm.length_squared())) - Sym3::outer(arm)
}
