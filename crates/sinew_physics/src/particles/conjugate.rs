//! Vectors of conjugate gradients over the springs of a group; see `elimination.rs`.

use crate::spatial::{Vec6, ZERO6, add_scaled};
use sinew_math::Vec3;

/// Vectors of conjugate gradients, by particle and by hub.
#[derive(Clone, Debug, Default)]
pub(super) struct Conjugate {
    /// Residual momentum of the current velocities, kg·m/s.
    pub residual: Vec<Vec3>,
    /// Preconditioned residual, a velocity, m/s.
    pub gain: Vec<Vec3>,
    /// Search direction of the velocities, m/s, and its product with the preconditioner, kg·m/s (`needed`).
    pub direction: Vec<Vec3>,
    pub needed: Vec<Vec3>,
    /// Momentum that closing springs transmit from one end to the other, kg·m/s.
    pub passed: Vec<Vec3>,
    /// Velocity of each hub, and its search direction.
    pub hubs: Vec<[Vec6; 2]>,
}

impl Conjugate {
    pub fn new(particles: usize, hubs: usize) -> Self {
        let vectors = vec![Vec3::ZERO; particles];
        Self {
            residual: vectors.clone(),
            gain: vectors.clone(),
            direction: vectors.clone(),
            needed: vectors.clone(),
            passed: vectors,
            hubs: vec![[ZERO6; 2]; hubs],
        }
    }

    /// Starts from the current solution: stores the hub velocities, and sets the residual to the transmitted momentum
    /// minus the previous residual.
    pub fn start<'a>(&mut self, hubs: impl Iterator<Item = &'a Vec6>) {
        for (residual, passed) in self.residual.iter_mut().zip(&self.passed) {
            *residual = *passed - *residual;
        }
        for (kept, hub) in self.hubs.iter_mut().zip(hubs) {
            *kept = [*hub, ZERO6];
        }
        self.direction.fill(Vec3::ZERO);
        self.needed.fill(Vec3::ZERO);
    }

    /// Computes the next direction of particles and hubs: the gain plus `carry` times the previous direction.
    pub fn turn<'a>(&mut self, carry: f32, hubs: impl Iterator<Item = &'a Vec6>) {
        for i in 0..self.gain.len() {
            self.direction[i] = self.gain[i] + self.direction[i] * carry;
            self.needed[i] = self.residual[i] + self.needed[i] * carry;
        }
        for (kept, hub) in self.hubs.iter_mut().zip(hubs) {
            let mut direction = *hub;
            add_scaled(&mut direction, &kept[1], carry);
            kept[1] = direction;
        }
    }

    /// Moves the velocities along the direction by the factor `by`, and updates the residual.
    pub fn go(&mut self, by: f32, velocities: &mut [Vec3]) {
        for (i, velocity) in velocities.iter_mut().enumerate() {
            *velocity += self.direction[i] * by;
            self.residual[i] -= (self.needed[i] - self.passed[i]) * by;
        }
        for [velocity, direction] in &mut self.hubs {
            add_scaled(velocity, direction, by);
        }
    }
}

/// Sum of the products of two lists of vectors.
pub(super) fn dot(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + f64::from(a.dot(*b)))
}
