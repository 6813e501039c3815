//! Bodies between clips and physics: each led, pinned, held by muscles or limp, while clips and mover go on.

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

/// Ways to move all of a character.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// Its clips: what lies gets up, what is powered comes back to them.
    Animated,
    /// Its clips, with bodies that give way and come back as if it had just been struck everywhere.
    Flinching,
    /// Muscles toward its clips, and soft pins, the strongest at the pelvis, that keep it near its place.
    Powered,
    /// Nothing: it falls.
    Limp,
}

/// Bodies of a character.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part<'a> {
    /// All.
    All,
    /// One, by index in the definition.
    Body(usize),
    /// One, by role or bone.
    Named(&'a str),
    /// That one, by role or bone, and all that hangs on it.
    From(&'a str),
}

/// Pins that keep a body of a powered character near its place, and its legs and pelvis firmer: else feet would drag.
const NEAR: Pin = Pin { hertz: 2.0, damping_ratio: 1.0, max_force: 0.0, max_torque: 0.0 };
const WALKS: Pin = Pin { hertz: 4.0, ..NEAR };

/// Pin that holds a body near its place by [`Preset::Powered`].
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

/// Has muscles and pins draw all bodies to the clips.
pub(super) fn set_drives(def: &CharacterDef, physique: &mut Physique, world: &World) {
    let gravity = world.def().gravity.length();
    for body in 0..def.ragdoll.bodies.len() {
        let pin = powered_pin(def, body, gravity);
        physique.drives.set(body, DriveMode::Pinned(Muscle::ALIVE, pin), POWERED_HALF_LIFE);
    }
}

/// True if the pelvis has got too far from where its clips want it for the feet to hold it, or leans too far; how far it is turned about the
/// vertical says nothing of that: it lags behind who turns on the spot.
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
