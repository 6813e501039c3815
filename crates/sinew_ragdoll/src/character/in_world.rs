//! Settings of a character's interaction with the world while clips move it: a mover that stands, walks and falls, and
//! bodies that can be hit.

use super::{CharacterDef, State};
use crate::character::tuning::{FELLING_SPEED, MOVER_RADIUS};
use crate::def::RagdollDef;
use sinew_math::{Vec3, min};
use sinew_physics::{ContactRule, MoverDef, Yields};

/// Bodies of a character that its clips move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HitBodies {
    /// The bodies are in the world, kinematic: rays, shapes and contacts find them, and flying bodies bounce off. They
    /// push within these bounds. Default.
    Present(Yields),
    /// The bodies are not in the world.
    Absent,
}

/// A hit on a character.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blow {
    /// Struck body, by index in the definition.
    pub body: usize,
    /// Impulse, N·s, world axes.
    pub impulse: Vec3,
    /// State of the character before the hit.
    pub state: State,
}

/// Rule that decides which hits make a standing character fall, and which make it flinch.
#[derive(Clone, Copy, Debug)]
pub enum Toughness {
    /// Every hit makes the character fall.
    None,
    /// Hits of at least this impulse, N·s, make the character fall; weaker ones make it flinch. While it gets up near
    /// the ground, 2.5 times this impulse is needed. Default: a speed of 0.6 m/s for the character's whole mass.
    Impulse(f32),
    /// A user's function decides: it returns true if the hit makes the character fall.
    Function(fn(&CharacterDef, &Blow) -> bool),
}

impl PartialEq for Toughness {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::None, Self::None) => true,
            (Self::Impulse(a), Self::Impulse(b)) => a == b,
            (&Self::Function(a), &Self::Function(b)) => core::ptr::fn_addr_eq(a, b),
            _ => false,
        }
    }
}

/// Placement of the feet of a walking or standing character.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FootPlanting {
    /// Feet are placed on the ground under them: on stairs, slopes, edges and moving ground; a planted foot keeps its
    /// position. Bodies lighter than a twentieth of the character, and limbs of others, are not ground. For humanoids
    /// in a world, with [hit bodies](InWorld::hit_bodies). Default.
    OnGround,
    /// Feet follow the clips, except those of a character that got up and still stands there.
    AsClips,
}

/// Settings of a kind of character in a world while clips move it: mover, bodies, hits and falls.
#[derive(Clone, Debug, PartialEq)]
pub struct InWorld {
    /// Bodies of the character. Default present.
    pub hit_bodies: HitBodies,
    /// Mover of the character, by size, mass and filter; `position` is ignored. `None`: nothing stops or carries the
    /// character, and root motion moves it over the static world. Default: as tall and heavy as the character.
    pub mover: Option<MoverDef>,
    /// Turning speed, rad/s; at most 3.5 while powered. Default 8.
    pub turn_speed: f32,
    /// Speed at which a jump begins, m/s. Default 3.5, which reaches 0.6 m.
    pub jump_speed: f32,
    /// Time without ground after which the character falls limp, seconds. Default 1.2.
    pub air_time: f32,
    /// Speed toward the ground from which a landing makes the character fall, m/s. Default 7, a fall from 2.5 m.
    pub landing_speed: f32,
    /// Placement of the feet. Default on the ground.
    pub foot_planting: FootPlanting,
    /// Rule that decides which hits make the character fall or flinch.
    pub toughness: Toughness,
    /// Largest number of steps in a row to catch a push while powered. Such a character falls when it loses its
    /// balance, not by [`toughness`](Self::toughness), unless that is a function or none. 0: the character does not
    /// step. Only for humanoids with a mover. Default 4.
    pub most_steps: u32,
    /// Smallest impulse from contacts and blasts that counts as a hit, N·s; infinite: only
    /// [`Character::hit`](super::Character::hit) counts. Default 3.
    pub feels: f32,
    /// True if [`CharacterEvent::Contact`](super::CharacterEvent::Contact) reports contacts of the character's bodies.
    /// Default false, because crowds have many.
    pub tells_contacts: bool,
}

impl InWorld {
    /// Returns the defaults for a ragdoll's size and mass.
    pub fn of(ragdoll: &RagdollDef) -> Self {
        let sound = |x: f32, else_: f32| if x > 0.0 && x < f32::INFINITY { x } else { else_ };
        let (height, mass) = (sound(ragdoll.height, 1.8), sound(ragdoll.total_mass, 80.0));
        let usual = MoverDef::default();
        let mover = MoverDef {
            height,
            radius: MOVER_RADIUS * height,
            mass,
            push_force: usual.push_force * mass / usual.mass,
            step_height: usual.step_height * height / usual.height,
            skin: min(usual.skin, 0.1 * MOVER_RADIUS * height),
            ..usual
        };
        Self {
            hit_bodies: HitBodies::Present(Yields::default()),
            mover: Some(mover),
            turn_speed: 8.0,
            jump_speed: 3.5,
            air_time: 1.2,
            landing_speed: 7.0,
            foot_planting: FootPlanting::OnGround,
            toughness: Toughness::Impulse(FELLING_SPEED * mass),
            most_steps: 4,
            feels: 3.0,
            tells_contacts: false,
        }
    }

    /// Returns the rule for contacts of the bodies while clips or muscles move them.
    pub(super) fn rule(&self) -> ContactRule {
        match self.hit_bodies {
            HitBodies::Present(yields) => ContactRule::Yields(yields),
            HitBodies::Absent => ContactRule::Yields(Yields::default()),
        }
    }
}
