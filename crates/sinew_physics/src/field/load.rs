//! Loads of fields on items, limited to what a substep can integrate stably.

use crate::body::force::Wrench;
use sinew_math::{Vec3, min};

/// Load of fields on a body or particle.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Load {
    pub wrench: Wrench,
    /// Decrease of the force with velocity, `−∂F/∂v`, N·s/m: an upper bound over directions.
    pub resistance: f32,
    /// Decrease of the torque with spin, N·m·s: an upper bound over directions.
    pub spin_resistance: f32,
}

impl Load {
    pub(super) fn push(&mut self, force: Vec3) {
        self.wrench.force += force;
    }

    /// Adds a damping force at `arm` from the centre of mass.
    pub(super) fn push_at(&mut self, arm: Vec3, force: Vec3, resistance: f32) {
        self.wrench.force += force;
        self.wrench.torque += arm.cross(force);
        self.resistance += resistance;
        self.spin_resistance += resistance * arm.length_squared();
    }

    /// Adds `share` times another load.
    pub(super) fn add(&mut self, other: &Self, share: f32) {
        self.wrench.force += other.wrench.force * share;
        self.wrench.torque += other.wrench.torque * share;
        self.resistance += other.resistance * share;
        self.spin_resistance += other.spin_resistance * share;
    }

    /// Returns the field's part of the total force on a particle that `weight` also pulls, N; the total is limited as
    /// in `with`.
    pub fn beside(&self, weight: Vec3, mass: f32, h: f32) -> Vec3 {
        let share = held_back(h * self.resistance, mass);
        self.wrench.force * share + weight * (share - 1.0)
    }

    /// Returns the sum of this load and other loads, limited so that a substep cannot overshoot: see the module.
    pub fn with(&self, other: Wrench, mass: f32, least_moment: f32, h: f32) -> Wrench {
        Wrench {
            force: (other.force + self.wrench.force) * held_back(h * self.resistance, mass),
            torque: (other.torque + self.wrench.torque) * held_back(h * self.spin_resistance, least_moment),
        }
    }
}

/// Share of a force that remains if damping would remove `braking` of the inertia.
fn held_back(braking: f32, inertia: f32) -> f32 {
    if braking > inertia { inertia / braking } else { 1.0 }
}

/// Smallest of three moments.
pub(crate) fn least(moments: Vec3) -> f32 {
    min(moments.x, min(moments.y, moments.z))
}
