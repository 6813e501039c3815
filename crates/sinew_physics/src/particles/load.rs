//! A spring in the linear system of one step.

use super::{Resists, SpringDef};
use crate::particles::tuning::LENGTH_TOLERANCE;
use sinew_math::{Sym3, Vec3, max};

/// A spring during one step. Damping depends on its lengths at both ends of the step, so that it acts as a spring too.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Load {
    /// Length at the start of the step, metres; at least the rest length if the spring resists stretch only.
    begun: f32,
    /// Damping divided by the length of the step, N/m.
    rate: f32,
    /// Vector from A to B where the spring is linearised, metres.
    from_a: Vec3,
    /// Force on A, N, extrapolated linearly to equal velocities of A and B.
    pub force: Vec3,
    /// Inertia-like block of the spring in the system, `h² K + h D`, kg.
    pub block: Sym3,
}

impl Load {
    /// Creates the load at the start of a step of `h` seconds; `from_a` is the vector from A to B.
    pub fn new(spring: &SpringDef, from_a: Vec3, h: f32) -> Self {
        let length = from_a.length();
        let begun = match spring.resists {
            Resists::Both => length,
            Resists::Stretch => max(length, spring.rest_length),
        };
        let mut load = Self { begun, rate: spring.damping / h, ..Self::default() };
        load.linearise(spring, from_a, Vec3::ZERO, h);
        load
    }

    /// Tension for this `length` (m) at the end of the step, N; 0 if the spring is slack.
    pub fn tension(&self, spring: &SpringDef, length: f32) -> f32 {
        let tension = spring.stiffness * (length - spring.rest_length) + self.rate * (length - self.begun);
        if spring.resists == Resists::Stretch { max(tension, 0.0) } else { tension }
    }

    /// Energy of the spring at the end of the step, J: the integral of the tension over the length, from zero tension.
    pub fn energy(&self, spring: &SpringDef, from_a: Vec3) -> f64 {
        let tension = f64::from(self.tension(spring, from_a.length()));
        0.5 * tension * tension / f64::from(spring.stiffness + self.rate)
    }

    /// Linearises at the vector `from_a` from A to B, for velocities of A relative to B of `ahead`.
    pub fn linearise(&mut self, spring: &SpringDef, from_a: Vec3, ahead: Vec3, h: f32) {
        let length = from_a.length();
        let direction = sinew_math::normalize_or(from_a, Vec3::Y);
        (self.from_a, self.force, self.block) = (from_a, Vec3::ZERO, Sym3::ZERO);
        let tension = self.tension(spring, length);
        if spring.resists == Resists::Stretch && tension == 0.0 {
            return;
        }
        // A slack spring would have a negative geometric stiffness, with which the system may lose its solution.
        let across = match length > 1e-9 {
            true => max(tension / length, 0.0),
            false if spring.rest_length == 0.0 => spring.stiffness,
            false => 0.0,
        };
        let axial = spring.stiffness + self.rate;
        let stiffness = Sym3::IDENTITY * across + Sym3::outer(direction) * (axial - across);
        self.force = direction * tension + stiffness * ahead * h;
        self.block = stiffness * (h * h);
    }

    /// Impulse on A in a step that ends with these velocities of A and B, N·s.
    pub fn impulse(&self, h: f32, velocity_a: Vec3, velocity_b: Vec3) -> Vec3 {
        self.force * h - self.block * (velocity_a - velocity_b)
    }

    /// True if the force at the end of the step differs from the linearised one by more than the force that stretches
    /// the spring by `LENGTH_TOLERANCE` of its length.
    pub fn is_bent(&self, spring: &SpringDef, from_a: Vec3, ahead: Vec3, h: f32) -> bool {
        let length = from_a.length();
        let force = sinew_math::normalize_or(from_a, Vec3::Y) * self.tension(spring, length);
        let error = force - (self.force - self.block * ahead * (1.0 / h));
        let bar = LENGTH_TOLERANCE * max(self.begun, spring.rest_length) * (spring.stiffness + self.rate);
        error.length_squared() > bar * bar
    }
}
