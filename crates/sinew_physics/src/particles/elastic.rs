//! Energy of what is stretched, bent and compressed.

use super::ParticleGroup;
use super::net::{enclosed_volume, stretch};

impl ParticleGroup {
    /// Of its springs, `½ k s²` each, its bends likewise, and its volumes, `½ K (V − V₀)²/V₀`, J. Tethers hold without
    /// energy.
    pub fn elastic_energy(&self) -> f32 {
        let springs = self.springs.iter().map(|s| {
            let stretch = stretch(s, &self.positions);
            0.5 * s.stiffness * stretch * stretch
        });
        let bends = self.bends.iter().map(|bend| {
            let [a, b, c] = bend.particles.map(|i| self.positions[i as usize]);
            let bow = (a - b * 2.0 + c).length() - bend.rest;
            0.5 * bend.stiffness * bow * bow
        });
        let volumes = self.volumes.iter().map(|volume| {
            let gained = enclosed_volume(&volume.triangles, &self.positions, |_, _| ()) - volume.rest_volume;
            0.5 * volume.bulk_modulus * gained * gained / volume.rest_volume
        });
        springs.chain(bends).chain(volumes).sum()
    }

    /// Volume that the surface of `volumes()[index]` encloses, m³.
    ///
    /// # Panics
    /// If there is no such volume.
    pub fn volume(&self, index: usize) -> f32 {
        enclosed_volume(&self.volumes[index].triangles, &self.positions, |_, _| ())
    }

    /// Of spring `index`: length less rest length, metres; 0 where it is slack.
    ///
    /// # Panics
    /// If there is no such spring.
    pub fn stretch(&self, index: usize) -> f32 {
        stretch(&self.springs[index], &self.positions)
    }
}
