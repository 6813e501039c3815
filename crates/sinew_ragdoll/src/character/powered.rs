//! Bodies between clips and physics: kinematic, pinned, driven by muscles or limp, while clips and mover continue.

use super::CharacterDef;
use super::figure::Scratch;
use super::physique::Physique;
use crate::character::tuning::{
    FALLS_BEYOND, FALLS_TURNED, PIN_BEARS, PIN_HELPS, PIN_STEPS, PIN_TURNS, POWERED_HALF_LIFE,
};
use crate::drive::{DriveMode, Muscle, Pin};
use sinew_anim::Animator;
use sinew_math::{Rotation, Transform, Vec3};
use sinew_physics::World;

/// Presets for all bodies of a character.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// Clips move the character: a lying character gets up, a powered one returns to the clips.
    Animated,
    /// Clips move the character, and all its bodies are weak and return to the clips, as if each had been struck.
    Flinching,
    /// Muscles drive the bodies to the clips, and soft pins keep the character near its position, strongest at the
    /// pelvis.
    Powered,
    /// Nothing drives the bodies: the character falls.
    Limp,
}

/// Bodies of a character, selected by index or name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part<'a> {
    /// All bodies.
    All,
    /// One body, by index in the definition.
    Body(usize),
    /// One body, by role or bone.
    Named(&'a str),
    /// A body, by role or bone, and all bodies below it.
    From(&'a str),
}

/// Pin that keeps a body of a powered character near its position; its bounds depend on the body.
const NEAR: Pin = Pin { hertz: 2.0, damping_ratio: 1.0, max_force: 0.0, max_torque: 0.0 };
const WALKS: Pin = Pin { hertz: 4.0, ..NEAR };

/// Returns the pin that holds a body near its position in [`Preset::Powered`].
fn powered_pin(def: &CharacterDef, body: usize, gravity: f32) -> Pin {
    let def = &def.ragdoll;
    if body == 0 {
        let weight = def.total_mass * gravity;
        return Pin { max_force: PIN_BEARS * weight, max_torque: PIN_TURNS * weight, ..WALKS };
    }
    let weight = def.bodies[body].mass.mass * gravity;
    let role = &def.bodies[body].role;
    if ["Leg", "Foot", "Toes"].iter().any(|part| role.ends_with(part)) {
        Pin { max_force: PIN_STEPS * weight, ..WALKS }
    } else {
        Pin { max_force: PIN_HELPS * weight, ..NEAR }
    }
}

/// Sets muscles and pins that drive all bodies to the clips.
pub(super) fn set_drives(def: &CharacterDef, physique: &mut Physique, world: &World) {
    let gravity = world.def().gravity.length();
    for body in 0..def.ragdoll.bodies.len() {
        let pin = powered_pin(def, body, gravity);
        physique.drives.set(body, DriveMode::Pinned(Muscle::ALIVE, pin), POWERED_HALF_LIFE);
    }
}

/// Returns true if the pelvis is too far from its position in the clips, or leans too far from its rotation there. The
/// heading of the pelvis is ignored, because it lags behind when the character turns on the spot.
pub(super) fn is_toppled(
    def: &CharacterDef,
    animator: &Animator,
    place: Transform,
    physique: &Physique,
    scratch: &mut Scratch,
    world: &World,
) -> bool {
    let mut wanted = core::mem::take(&mut scratch.wanted);
    wanted.clear();
    wanted.extend(animator.pose().iter());
    let mut bodies = core::mem::take(&mut scratch.before);
    scratch.bodies_of(def, &wanted, place, &mut bodies);
    let pelvis: Transform = bodies[0];
    (scratch.wanted, scratch.before) = (wanted, bodies);
    let now = world.transform(physique.limp().bodies[0]);
    let away = (now.translation - pelvis.translation).length();
    let leaning = Rotation::from_arc(Vec3::Y, now.rotation * pelvis.rotation.inverse() * Vec3::Y);
    away > FALLS_BEYOND * def.ragdoll.height || leaning.to_scaled_axis().length() > FALLS_TURNED
}
