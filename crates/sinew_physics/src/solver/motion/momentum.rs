//! Momentum of bodies, and the rigid motion with the same momentum.

use crate::solver::body::SolverBody;
use crate::spatial::{Vec6, angular, join, linear};
use sinew_math::{Sym3, Vec3};

/// Motion of several bodies as one rigid piece.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::solver) struct RigidMotion {
    pub(in crate::solver) center: Vec3,
    pub(in crate::solver) linear: Vec3,
    pub(in crate::solver) angular: Vec3,
}

impl RigidMotion {
    /// Computes the rigid motion with the bodies' momentum and angular momentum.
    pub(in crate::solver) fn of(bodies: &[SolverBody], velocities: &[Vec6]) -> Self {
        let center = center_of_mass(bodies).1;
        let mut momentum = Momentum::default();
        for (body, v) in bodies.iter().zip(velocities) {
            momentum.add(body, center, linear(v), body.angular_momentum(angular(v)));
        }
        Self::with_momentum(bodies, &momentum)
    }

    pub(in crate::solver) fn with_momentum(bodies: &[SolverBody], momentum: &Momentum) -> Self {
        let (mass, center) = center_of_mass(bodies);
        let mut inertia = Sym3::ZERO;
        for body in bodies {
            let arm = body.pose.translation - center;
            let carried = Sym3::from_diagonal(Vec3::splat(arm.length_squared())) - Sym3::outer(arm);
            inertia += Sym3::from_rotated_diagonal(body.pose.rotation, body.inertia) + carried * body.mass;
        }
        Self { center, linear: momentum.linear / mass, angular: inertia.inverse() * momentum.angular }
    }

    pub(in crate::solver) fn at(&self, point: Vec3) -> Vec6 {
        join(self.linear + self.angular.cross(point - self.center), self.angular)
    }
}

/// Momentum of several bodies, N·s, and angular momentum about their common centre of mass, N·m·s.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::solver) struct Momentum {
    pub(in crate::solver) linear: Vec3,
    pub(in crate::solver) angular: Vec3,
}

impl Momentum {
    pub(in crate::solver) fn add(&mut self, body: &SolverBody, center: Vec3, velocity: Vec3, spin: Vec3) {
        self.linear += velocity * body.mass;
        self.angular += spin + (body.pose.translation - center).cross(velocity * body.mass);
    }
}

/// Returns the total mass, kg, and the centre of mass.
pub(in crate::solver) fn center_of_mass(bodies: &[SolverBody]) -> (f32, Vec3) {
    let (mut mass, mut center) = (0.0, Vec3::ZERO);
    for body in bodies {
        mass += body.mass;
        center += body.pose.translation * body.mass;
    }
    (mass, center / mass)
}
