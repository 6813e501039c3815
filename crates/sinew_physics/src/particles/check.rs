//! Checks of the definitions of particles.

use super::{BackstopDef, BendDef, GroupDef, ParticleDef, SpringDef, TetherDef, VolumeDef};
use sinew_geometry::DefError;

/// Largest number of iterations of a substep.
const MAX_ITERATIONS: u32 = 64;

// The comparison is false for NaN.
fn positive(x: f32) -> bool {
    x > 0.0 && x < f32::INFINITY
}

fn not_negative(x: f32) -> bool {
    (0.0..f32::INFINITY).contains(&x)
}

/// Returns the error phrase `what`, unless the condition holds.
fn must(holds: bool, what: &'static str) -> Result<(), DefError> {
    if holds { Ok(()) } else { Err(DefError::new(what)) }
}

impl GroupDef {
    /// Checks that all numbers of the definition are valid; the error phrase names the problem.
    ///
    /// # Errors
    /// Returns a phrase that names the problem, in lower case.
    pub fn check(&self) -> Result<(), DefError> {
        let count = self.particles.len();
        self.particles.iter().try_for_each(ParticleDef::check)?;
        self.springs.iter().try_for_each(|s| s.check(count))?;
        self.bends.iter().try_for_each(|b| b.check(count))?;
        self.volumes.iter().try_for_each(|v| v.check(count))?;
        check_faces(&self.faces, count)?;
        let mut held = vec![false; count];
        for a in &self.attachments {
            let taken = held.get_mut(a.particle as usize).is_none_or(|held| core::mem::replace(held, true));
            must(!taken, "an attachment must hold a particle of its group that no other one holds")?;
            let finite = match a.target {
                super::AttachmentTarget::World(place) => place.is_finite(),
                super::AttachmentTarget::Body { point, .. } => point.is_finite(),
            };
            must(finite, "the point of an attachment must be finite")?;
        }
        self.tethers.iter().try_for_each(|t| t.check(&held))?;
        // A particle that is attached or has a backstop cannot have another backstop.
        let mut taken = held;
        self.backstops.iter().try_for_each(|b| b.check(&mut taken))?;
        self.material.check()?;
        must(
            not_negative(self.linear_damping) && self.gravity_scale.is_finite(),
            "damping must not be negative, and the gravity scale finite",
        )?;
        must(not_negative(self.thickness), "the thickness must not be negative")?;
        must((1..=MAX_ITERATIONS).contains(&self.iterations), "there must be 1 to 64 iterations")
    }
}

fn check_faces(faces: &[[u32; 3]], count: usize) -> Result<(), DefError> {
    let sorted = |face: &[u32; 3]| {
        let mut corners = *face;
        corners.sort_unstable();
        corners
    };
    let mut all: Vec<[u32; 3]> = faces.iter().map(sorted).collect();
    let is_face = |&[a, b, c]: &[u32; 3]| a < b && b < c && (c as usize) < count;
    must(all.iter().all(is_face), "a face must be of three different particles of its group")?;
    all.sort_unstable();
    must(all.windows(2).all(|pair| pair[0] != pair[1]), "a face must not be there twice")
}

impl ParticleDef {
    fn check(&self) -> Result<(), DefError> {
        must(
            self.position.is_finite() && self.velocity.is_finite(),
            "a particle's position and velocity must be finite",
        )?;
        must(
            positive(self.mass) && not_negative(self.radius),
            "a particle's mass must be positive and its radius not negative",
        )
    }
}

impl SpringDef {
    fn check(&self, count: usize) -> Result<(), DefError> {
        let known = |index: u32| (index as usize) < count;
        must(
            known(self.a) && known(self.b) && self.a != self.b,
            "a spring must join two different particles of its group",
        )?;
        must(
            positive(self.stiffness) && not_negative(self.rest_length) && not_negative(self.damping),
            "a spring's stiffness must be positive, its length and damping not negative",
        )
    }
}

impl BendDef {
    fn check(&self, count: usize) -> Result<(), DefError> {
        let [a, b, c] = self.particles;
        let known = self.particles.iter().all(|&i| (i as usize) < count);
        must(
            known && a != b && b != c && c != a,
            "bending must be of three different particles of its group",
        )?;
        must(
            positive(self.stiffness) && not_negative(self.rest),
            "a bending stiffness must be positive, its rest not negative",
        )
    }
}

impl TetherDef {
    fn check(&self, held: &[bool]) -> Result<(), DefError> {
        let (particle, to) = (self.particle as usize, self.to as usize);
        let ends = held.get(particle).is_some() && particle != to && held.get(to) == Some(&true);
        must(
            ends && positive(self.length),
            "a tether must lead from a particle to an attached one, over some length",
        )
    }
}

impl BackstopDef {
    fn check(&self, taken: &mut [bool]) -> Result<(), DefError> {
        let taken = taken.get_mut(self.particle as usize);
        let taken = taken.is_none_or(|taken| core::mem::replace(taken, true));
        must(
            !taken,
            "a backstop must be of a particle of its group that nothing holds and that has no other one",
        )?;
        must(
            self.center.is_finite() && positive(self.radius),
            "a backstop's radius must be positive, and its place finite",
        )
    }
}

impl VolumeDef {
    fn check(&self, count: usize) -> Result<(), DefError> {
        let known = self.triangles.iter().flatten().all(|&i| (i as usize) < count);
        must(
            known && positive(self.rest_volume) && positive(self.bulk_modulus),
            "a volume must be of particles of its group, and it and its bulk modulus positive",
        )
    }
}
