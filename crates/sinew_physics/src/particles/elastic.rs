//! Elastic energy of springs, bends and volumes.

use super::ParticleGroup;
use super::net::{enclosed_volume, stretch};

impl ParticleGroup {
    /// Elastic energy of the group, J: `½ k s²` for each spring, likewise for each bend, and `½ K (V − V₀)²/V₀` for
    /// each volume. Tethers store none. A projected row counts with the compliance with which it alone returns energy,
    /// `1/k + h² Σ w`: rows that share particles may return less or more (ADR 0027).
    pub fn elastic_energy(&self) -> f32 {
        let solved = self.forest.solved_springs().map(|index| {
            let s = &self.springs[index as usize];
            energy(stretch(s, &self.positions), 1.0 / s.stiffness, 0.0)
        });
        let projected = self.forest.projected().iter().map(|&index| {
            let s = &self.springs[index as usize];
            let weights = self.weight(s.a) + self.weight(s.b);
            energy(stretch(s, &self.positions), 1.0 / s.stiffness, self.span * self.span * weights)
        });
        let bends = self.bends.iter().map(|bend| {
            let [a, b, c] = bend.particles.map(|i| self.positions[i as usize]);
            let bow = (a - b * 2.0 + c).length() - bend.rest;
            let [of_a, of_b, of_c] = bend.particles.map(|i| self.weight(i));
            energy(bow, 1.0 / bend.stiffness, self.span * self.span * (of_a + 4.0 * of_b + of_c))
        });
        let volumes = (0..self.volumes.len()).map(|k| {
            let volume = &self.volumes[k];
            energy(self.volume(k) - volume.rest_volume, volume.rest_volume / volume.bulk_modulus, 0.0)
        });
        solved.chain(projected).chain(bends).chain(volumes).sum()
    }

    /// Inverse mass of a particle in projections, 1/kg; 0 if it is attached.
    fn weight(&self, particle: u32) -> f32 {
        let i = particle as usize;
        if self.attachment_of[i] == u32::MAX { 1.0 / self.masses[i] } else { 0.0 }
    }

    /// Volume that the surface of `volumes()[index]` encloses, m³.
    ///
    /// # Panics
    /// If the volume does not exist.
    pub fn volume(&self, index: usize) -> f32 {
        enclosed_volume(&self.volumes[index].triangles, &self.positions, |_, _| ())
    }

    /// Stretch of spring `index`: length minus rest length, metres; 0 if it is slack.
    ///
    /// # Panics
    /// If the spring does not exist.
    pub fn stretch(&self, index: usize) -> f32 {
        stretch(&self.springs[index], &self.positions)
    }
}

/// Energy of a row with error `c`, compliance, and compliance added by projection, J.
fn energy(c: f32, compliance: f32, added: f32) -> f32 {
    0.5 * c * c / (compliance + added)
}
