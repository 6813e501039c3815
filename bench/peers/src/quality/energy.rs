//! Energy of the dynamic bodies.

use crate::engine::BodyState;
use sinew::math::Vec3;
use sinew::physics::MassProperties;
use sinew_scenes::blueprint::Blueprint;

/// Energies in joules; height counts from y = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct EnergyQuality {
    /// Linear and angular kinetic energy at the end.
    pub kinetic_end: f64,
    /// Kinetic and potential energy before the first step.
    pub total_start: f64,
    /// Kinetic and potential energy at the end.
    pub total_end: f64,
    /// Largest total energy, including the start: an excess over the start is an error.
    pub total_peak: f64,
}

pub(super) struct EnergyMeter {
    gravity: Vec3,
    /// Masses of dynamic bodies, with their indices.
    masses: Vec<(usize, MassProperties)>,
    total_start: f64,
    total_peak: f64,
}

impl EnergyMeter {
    pub fn new(scene: &Blueprint) -> Self {
        // Our world has integrated the densities; the sum below is computed independently.
        let (world, ids, _) = scene.build();
        let masses = scene.dynamic().map(|place| (place, world.mass(ids[place]))).collect();
        let mut meter = Self { gravity: scene.gravity, masses, total_start: 0.0, total_peak: 0.0 };
        let start: Vec<_> = scene
            .bodies
            .iter()
            .map(|def| BodyState {
                linear_velocity: def.linear_velocity,
                angular_velocity: def.angular_velocity,
                ..BodyState::at(def.position, def.rotation)
            })
            .collect();
        let (kinetic, potential) = meter.energy(&start);
        meter.total_start = kinetic + potential;
        meter.total_peak = meter.total_start;
        meter
    }

    pub fn observe(&mut self, states: &[BodyState]) {
        let (kinetic, potential) = self.energy(states);
        let total = kinetic + potential;
        if total.is_nan() || total > self.total_peak {
            self.total_peak = total;
        }
    }

    pub fn finish(&mut self, states: &[BodyState]) -> EnergyQuality {
        let (kinetic, potential) = self.energy(states);
        EnergyQuality {
            kinetic_end: kinetic,
            total_start: self.total_start,
            total_end: kinetic + potential,
            total_peak: self.total_peak,
        }
    }

    /// Returns kinetic and potential energy, summed in f64, because the changes are small.
    fn energy(&self, states: &[BodyState]) -> (f64, f64) {
        let (mut kinetic, mut potential) = (0.0, 0.0);
        for (place, mass) in &self.masses {
            let state = &states[*place];
            let spin = state.world_from_body.rotation.inverse() * state.angular_velocity;
            let center = state.world_from_body.point(mass.center);
            let twice = mass.mass * state.linear_velocity.length_squared() + spin.dot(mass.inertia * spin);
            kinetic += 0.5 * f64::from(twice);
            potential -= f64::from(mass.mass) * f64::from(self.gravity.dot(center));
        }
        (kinetic, potential)
    }
}
