//! User functions and kinds of objects that lives register.

use sinew_math::{ReadError, Reader, Vec3, Writer};
use sinew_physics::field::{FieldPoint, PARAMETERS};
use sinew_physics::*;

pub const NUMBER: u32 = 1;

/// Registers all functions and kinds of objects.
pub fn register(world: &mut World) {
    world.register_pair_function(NUMBER, parity);
    world.register_modifier(NUMBER, slippery);
    world.register_field(NUMBER, pull);
    world.register_kind(|| Box::new(Tug::default()));
}

fn parity(p: &PairSide, q: &PairSide) -> bool {
    (p.user_data ^ q.user_data) & 1 == 0
}

fn slippery(found: &FoundContact<'_>, material: ContactMaterial) -> Option<ContactMaterial> {
    let passes = found.sides[0].user_data == found.sides[1].user_data && found.step % 64 < 8;
    (!passes).then_some(ContactMaterial { friction: 0.05, static_friction: 0.1, ..material })
}

fn pull(point: &FieldPoint, parameters: &[f32; PARAMETERS]) -> Wrench {
    let to = Vec3::new(parameters[0], parameters[1], parameters[2]) - point.position;
    Wrench { force: to * (point.mass * parameters[3]), torque: Vec3::ZERO }
}

/// Object that pulls a body toward a point.
#[derive(Clone, Copy, Debug)]
pub struct Tug {
    pub body: BodyId,
    pub place: Vec3,
    /// Stiffness, N/m.
    pub stiffness: f32,
    /// Number of substeps in which the object was called.
    pub asked: u32,
}

impl Default for Tug {
    fn default() -> Self {
        Self { body: BodyId::from_bits(0), place: Vec3::ZERO, stiffness: 0.0, asked: 0 }
    }
}

impl PhysicsObject for Tug {
    fn kind(&self) -> &'static str {
        "tug"
    }
    fn add_forces(&mut self, forces: &mut Forces<'_>) {
        self.asked += 1;
        if forces.contains(self.body) {
            let pull = (self.place - forces.center_of_mass(self.body)) * self.stiffness;
            // Bodies at huge distances are not pulled.
            if pull.length() < 1e12 {
                forces.apply_force_at_center(self.body, pull);
            }
        }
    }
    fn draw(&self, world: &World, out: &mut dyn DebugDraw) {
        if world.contains(self.body) {
            out.line(world.center_of_mass(self.body), self.place, DrawKind::Object);
        }
    }
    fn save(&self, w: &mut Writer) {
        w.u64(self.body.to_bits());
        w.vec3(self.place);
        w.f32(self.stiffness);
        w.u32(self.asked);
    }
    fn load(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError> {
        self.body = BodyId::from_bits(r.u64()?);
        (self.place, self.stiffness, self.asked) = (r.vec3()?, r.f32()?, r.u32()?);
        Ok(())
    }
}
