//! A character's share of the world while its clips move it: a mover that stands, walks and falls, and bodies that can be
//! hit. Settings, and how it comes and goes.

use super::distances::Detail;
use super::memory::Hold;
use super::stumble::Stumble;
use super::{Character, CharacterDef, State};
use crate::character::tuning::{FELLING_SPEED, MOVER_RADIUS};
use crate::def::RagdollDef;
use crate::ragdoll::{BodyState, Ragdoll};
use sinew_math::{Transform, Vec3, max, min};
use sinew_physics::{BodyId, ContactRule, MoverDef, MoverId, Velocity, World, Yields};
use std::sync::Arc;

/// Bodies of a character that its clips move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HitBodies {
    /// In the world, kinematic: rays and shapes find them, contacts tell of them, what flies bounces off. They push within
    /// these bounds. Default.
    Present(Yields),
    /// Not in the world.
    Absent,
}

/// A blow that a character got.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blow {
    /// Body that was struck, by index in the definition.
    pub body: usize,
    /// N·s, world axes.
    pub impulse: Vec3,
}

/// Rule by which blows fell a character that stands, or let it flinch.
#[derive(Clone, Copy, Debug)]
pub enum Toughness {
    /// Each blow does.
    None,
    /// Blows of that many N·s and more; weaker ones let it flinch. While it gets up, 2.5 times as many where it is still near the ground.
    /// Default: the speed of 0.6 m/s for its whole mass.
    Impulse(f32),
    /// The user's function says: true fells it.
    Function(fn(&Character, &Blow) -> bool),
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

/// The share of a world that characters of a kind have while their clips move them, and the blows and falls that they stand.
#[derive(Clone, Debug, PartialEq)]
pub struct InWorld {
    /// Its bodies. Default present.
    pub hit_bodies: HitBodies,
    /// Mover that stands for it, by size, mass and filter; `position` does nothing. `None`: nothing stops or carries it, and
    /// it goes where its clips take it over the static world. Default: as tall and heavy as the character.
    pub mover: Option<MoverDef>,
    /// Speed at which it turns to where it is to face, rad/s. Default 8.
    pub turn_speed: f32,
    /// Speed of a jump, m/s. Default 3.5, which is 0.6 m.
    pub jump_speed: f32,
    /// Time without ground after which it falls limp, seconds. Default 1.2.
    pub air_time: f32,
    /// Speed toward the ground with which a landing fells it, m/s. Default 7, a fall from 2.5 m.
    pub landing_speed: f32,
    /// Rule by which blows fell it or let it flinch.
    pub toughness: Toughness,
    /// Steps in a row with which it tries, powered, to catch itself from a push: a powered character that may step is felled by losing its
    /// balance and not by [`toughness`](Self::toughness), unless that is a function's or none. 0: it stands or falls where it is. Humanoids with a mover only.
    /// Default 4.
    pub most_steps: u32,
    /// Impulse from which it feels what strikes its bodies by itself, N·s; infinite: it feels only what it is told of by
    /// [`Character::hit`]. Default 3.
    pub feels: f32,
    /// True: [`CharacterEvent::Contact`](super::CharacterEvent::Contact) tells which of its bodies begin and stop to touch something. Default false: in crowds that
    /// is much to look through.
    pub tells_contacts: bool,
}

impl InWorld {
    /// The defaults for a ragdoll's size and mass.
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
            toughness: Toughness::Impulse(FELLING_SPEED * mass),
            most_steps: 4,
            feels: 3.0,
            tells_contacts: false,
        }
    }

    /// Rule for contacts of its bodies while its clips or its muscles move them.
    pub(super) fn rule(&self) -> ContactRule {
        match self.hit_bodies {
            HitBodies::Present(yields) => ContactRule::Yields(yields),
            HitBodies::Absent => ContactRule::Yields(Yields::default()),
        }
    }
}

/// A character's share of a world.
#[derive(Clone, Debug, Default)]
pub(super) struct Presence {
    /// While it stands.
    pub mover: Option<MoverId>,
    /// Dynamic body that bears the mover, through which its own bodies pass.
    pub bearer: Option<BodyId>,
    /// Hit bodies, which are the ragdoll's while it has one.
    pub bodies: Vec<BodyId>,
    /// Poses of the bodies a step ago as clips had them; empty: none.
    pub before: Vec<Transform>,
    /// Velocity that it is to go with, m/s; `None`: as its clips do.
    pub wish: Option<Vec3>,
    /// Direction in which it is to look, level, of length 1.
    pub facing: Option<Vec3>,
    /// The mover's turn as it was last asked.
    pub yaw: f32,
    /// Velocity of the mover, m/s.
    pub velocity: Vec3,
    /// Speed at which the looped clip is played, m/s.
    pub pace: f32,
    /// Seconds since the mover had ground.
    pub air: f32,
    /// Way from its mover to where it is shown: it takes a moment to come down a step, or to where the mover was pushed out, metres.
    pub beside: Vec3,
    /// It left the ground for too long or came down too fast.
    pub falls: bool,
    /// Steps with which it catches itself.
    pub stumble: Option<Stumble>,
    pub detail: Detail,
    pub holds: Vec<Hold>,
}

impl Character {
    /// A character in a world, animated: with a mover and hit bodies as [`CharacterDef::in_world`] says. `world_from_character`
    /// is where it stands (metres, its +Y up, +Z the way it faces). [`despawn`](Self::despawn) takes all of it out again.
    ///
    /// # Panics
    /// If the place is not finite.
    pub fn spawn(world: &mut World, def: &Arc<CharacterDef>, world_from_character: Transform) -> Self {
        let mut character = Self::new(def.clone(), world_from_character, 0.0);
        character.enter(world);
        character
    }

    /// Brings a character that was made [`new`](Self::new) into a world, as [`spawn`](Self::spawn) does. Nothing happens if it
    /// is in one.
    ///
    /// # Panics
    /// If it stands nowhere finite, or is not animated.
    pub fn enter(&mut self, world: &mut World) {
        if self.presence.is_some() {
            return;
        }
        assert!(self.world_from_character.is_finite(), "a character stands at a finite place");
        assert!(self.state == State::Animated, "a character comes into a world standing");
        self.presence = Some(Presence::default());
        self.settle_detail(world);
    }

    /// Puts hit bodies into the world where the pose has them.
    pub(super) fn enter_bodies(&mut self, world: &mut World) {
        let HitBodies::Present(yields) = self.def.in_world.hit_bodies else { return };
        let def = self.def.clone();
        let mut poses = Vec::new();
        let pose = self.pose_without_springs().to_vec();
        self.bodies_of(&pose, self.world_from_character, &mut poses);
        let at = |&world_from_body: &Transform| BodyState { world_from_body, velocity: Velocity::default() };
        let states: Vec<BodyState> = poses.iter().map(at).collect();
        let rule = ContactRule::Yields(yields);
        let bodies = Ragdoll::spawn_kinematic_without(
            world,
            &def.ragdoll,
            &states,
            &def.body_settings,
            rule,
            &self.lost,
        );
        if let Some(presence) = &mut self.presence {
            (presence.bodies, presence.bearer) = (bodies, None);
        }
        self.keep_own();
        self.mark_own(world);
        self.dress(world);
    }

    /// Takes all of it out of the world: bodies, joints, drives, mover.
    ///
    /// # Panics
    /// If something of it is no longer there.
    pub fn despawn(mut self, world: &mut World) {
        self.leave(world);
    }

    /// Takes all of it out of the world and keeps its clips going, at the place where it stood.
    ///
    /// # Panics
    /// If something of it is no longer there, or it is not animated.
    fn leave(&mut self, world: &mut World) {
        self.release_all(world, false);
        self.undress(world);
        if let Some(ragdoll) = self.ragdoll.take() {
            self.drives.release(world, &ragdoll);
            ragdoll.despawn(world);
            if let Some(presence) = &mut self.presence {
                presence.bodies.clear();
            }
            self.keep_own();
        }
        self.sit_down(world);
        self.remove_hit_bodies(world);
        self.presence = None;
    }

    /// Takes its hit bodies out of the world.
    pub(super) fn remove_hit_bodies(&mut self, world: &mut World) {
        let lost: Vec<usize> = self.lost.iter().map(|&(body, _)| body).collect();
        let Some(presence) = &mut self.presence else { return };
        for (_, body) in presence.bodies.drain(..).enumerate().filter(|(index, _)| !lost.contains(index)) {
            world.disown_body(body);
            world.remove_body(body);
        }
        self.keep_own();
    }

    /// Its mover in the world; `None` without one, and while it lies.
    pub fn mover(&self) -> Option<MoverId> {
        self.presence.as_ref()?.mover
    }

    /// Its bodies in the world, in the order of the definition: hit bodies or those of its ragdoll; none of a character that
    /// was not brought into a world. Those that were [cut off](Self::detach) keep their places.
    pub fn bodies(&self) -> &[BodyId] {
        match (&self.ragdoll, &self.presence) {
            (Some(ragdoll), _) => &ragdoll.bodies,
            (None, Some(presence)) => &presence.bodies,
            (None, None) => &[],
        }
    }

    /// Index in the definition of a body of its: of what a ray hit, for one.
    pub fn body_index(&self, id: BodyId) -> Option<usize> {
        self.bodies().iter().position(|&body| body == id).filter(|&body| self.has_body(body))
    }

    /// Puts a mover where it stands, at a share of its height.
    pub(super) fn stand_up(&mut self, world: &mut World, share: f32) {
        let Some(presence) = self.presence.as_mut().filter(|presence| presence.mover.is_none()) else {
            return;
        };
        let Some(mover) = &self.def.in_world.mover else { return };
        let height = max(2.0 * mover.radius, share * mover.height);
        let position = self.world_from_character.translation + Vec3::Y * mover.skin;
        let lets_pass = match self.def.in_world.hit_bodies {
            HitBodies::Present(yields) => max(yields.max_impulse, mover.lets_pass),
            HitBodies::Absent => mover.lets_pass,
        };
        let mover = MoverDef { position, height, lets_pass, ..mover.clone() };
        presence.mover = Some(world.add_mover(&mover));
        (presence.yaw, presence.air, presence.pace) = (0.0, 0.0, 0.0);
        (presence.velocity, presence.beside, presence.falls) = (Vec3::ZERO, Vec3::ZERO, false);
        presence.stumble = None;
    }

    /// Takes its mover out: it lies.
    pub(super) fn sit_down(&mut self, world: &mut World) {
        let mover = self.presence.as_mut().and_then(|presence| {
            presence.stumble = None;
            presence.mover.take()
        });
        if let Some(mover) = mover.filter(|&mover| world.contains_mover(mover)) {
            world.remove_mover(mover);
        }
        self.spare_bearer(world);
    }
}
