//! Objects for tests, each with one effect.

use sinew_math::{ReadError, Reader, Vec3, Writer, max};
use sinew_physics::*;

/// Object that counts its calls and has no other effect.
#[derive(Default)]
pub struct Counter {
    pub asked: u32,
}

impl PhysicsObject for Counter {
    fn kind(&self) -> &'static str {
        "counter"
    }
    fn add_forces(&mut self, _: &mut Forces<'_>) {
        self.asked += 1;
    }
    fn satisfy_constraints(&mut self, _: &mut Corrections<'_>) {
        self.asked += 1;
    }
    fn save(&self, w: &mut Writer) {
        w.u32(self.asked);
    }
    fn load(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError> {
        self.asked = r.u32()?;
        Ok(())
    }
}

/// Spring of length zero between a point in the world and the centre of a body.
pub struct Spring {
    pub body: BodyId,
    pub place: Vec3,
    /// Stiffness, N/m.
    pub stiffness: f32,
}

impl PhysicsObject for Spring {
    fn kind(&self) -> &'static str {
        "spring"
    }
    fn add_forces(&mut self, forces: &mut Forces<'_>) {
        let pull = (self.place - forces.center_of_mass(self.body)) * self.stiffness;
        forces.apply_force_at_center(self.body, pull);
    }
    fn save(&self, w: &mut Writer) {
        w.u64(self.body.to_bits());
    }
    fn load(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError> {
        self.body = BodyId::from_bits(r.u64()?);
        Ok(())
    }
}

/// Constant force at the centre of a body, N.
pub struct Thrust {
    pub body: BodyId,
    pub force: Vec3,
}

impl PhysicsObject for Thrust {
    fn kind(&self) -> &'static str {
        "thrust"
    }
    fn add_forces(&mut self, forces: &mut Forces<'_>) {
        forces.apply_force_at_center(self.body, self.force);
    }
    fn save(&self, w: &mut Writer) {
        w.vec3(self.force);
    }
    fn load(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError> {
        self.force = r.vec3()?;
        Ok(())
    }
}

/// Massless rod that keeps the centre of a body at a fixed distance from a point.
pub struct Leash {
    pub body: BodyId,
    pub place: Vec3,
    /// Length, metres.
    pub length: f32,
}

impl PhysicsObject for Leash {
    fn kind(&self) -> &'static str {
        "leash"
    }
    fn satisfy_constraints(&mut self, corrections: &mut Corrections<'_>) {
        let at = corrections.center_of_mass(self.body);
        let arm = at - self.place;
        let (error, out) = (arm.length() - self.length, arm.normalize());
        let response = corrections.response(self.body, at, out);
        let impulse = -error / (corrections.h() * response);
        corrections.correct(self.body, out * impulse, at);
    }
    fn save(&self, w: &mut Writer) {
        w.f32(self.length);
    }
    fn load(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError> {
        self.length = r.f32()?;
        Ok(())
    }
}

/// Frictionless ball that acts on particles only, by projecting them to its surface.
pub struct Bump {
    pub center: Vec3,
    pub radius: f32,
    pub group: GroupId,
}

impl PhysicsObject for Bump {
    fn kind(&self) -> &'static str {
        "bump"
    }
    fn satisfy_constraints(&mut self, corrections: &mut Corrections<'_>) {
        for i in 0..corrections.particles(self.group).positions().len() {
            let group = corrections.particles(self.group);
            let out = group.positions()[i] - self.center;
            let depth = max(self.radius + group.radii()[i] - out.length(), 0.0);
            if depth > 0.0 {
                corrections.move_particle(self.group, i as u32, out.normalize() * depth);
            }
        }
    }
    fn save(&self, _: &mut Writer) {}
    fn load(&mut self, _: &mut Reader<'_>) -> Result<(), ReadError> {
        Ok(())
    }
}

/// Object that calls a function of the test once, at the start of a substep.
pub struct Once<F> {
    pub act: Option<F>,
}

impl<F: FnOnce(&mut Forces<'_>) + Send + Sync + 'static> PhysicsObject for Once<F> {
    fn kind(&self) -> &'static str {
        "once"
    }
    fn add_forces(&mut self, forces: &mut Forces<'_>) {
        if let Some(act) = self.act.take() {
            act(forces);
        }
    }
    fn save(&self, _: &mut Writer) {}
    fn load(&mut self, _: &mut Reader<'_>) -> Result<(), ReadError> {
        Ok(())
    }
}

/// Object that calls a function of the test once, after all bodies have moved.
pub struct OnceMoved<F> {
    pub act: Option<F>,
}

impl<F: FnOnce(&mut Corrections<'_>) + Send + Sync + 'static> PhysicsObject for OnceMoved<F> {
    fn kind(&self) -> &'static str {
        "once moved"
    }
    fn satisfy_constraints(&mut self, corrections: &mut Corrections<'_>) {
        if let Some(act) = self.act.take() {
            act(corrections);
        }
    }
    fn save(&self, _: &mut Writer) {}
    fn load(&mut self, _: &mut Reader<'_>) -> Result<(), ReadError> {
        Ok(())
    }
}
