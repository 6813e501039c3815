//! Bodies between clips and physics: each led, pinned, held by muscles or limp, while clips and mover go on.

use super::{Character, CharacterEvent, State};
use crate::character::tuning::{
    FALLS_BEYOND, FALLS_TURNED, PIN_BEARS, PIN_HELPS, PIN_STEPS, PIN_TURNS, POWERED_HALF_LIFE,
};
use crate::drive::{DriveMode, Drives, Muscle, Pin};
use crate::ragdoll::Ragdoll;
use sinew_math::{Transform, Vec3};
use sinew_physics::{ContactRule, World};

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

impl Character {
    /// Has all of it moved in another way.
    ///
    /// # Panics
    /// If it is not in the world.
    pub fn set_preset(&mut self, world: &mut World, preset: Preset) {
        match (preset, self.state) {
            (Preset::Limp, _) => self.go_limp(world),
            (Preset::Animated, State::Powered) => {
                self.drives.set_all(DriveMode::Keyed, POWERED_HALF_LIFE);
                self.flinching = 6.0 * POWERED_HALF_LIFE;
                self.state = State::Flinching;
                self.stumble(world);
            }
            (Preset::Animated | Preset::Powered, _) if !self.may_get_up() => {}
            (Preset::Animated, State::Limp | State::Preparing) => self.get_up(world),
            (Preset::Animated, _) => {}
            (Preset::Flinching, State::Animated | State::Flinching) => {
                for body in self.pelvis_children() {
                    self.flinch(world, body, Vec3::ZERO);
                }
            }
            (Preset::Flinching, _) => {}
            (Preset::Powered, _) => {
                self.take_bodies(world, DriveMode::Powered(Muscle::ALIVE));
                let gravity = world.def().gravity.length();
                for body in 0..self.def.ragdoll.bodies.len() {
                    let pin = self.powered_pin(body, gravity);
                    self.drives.set(body, DriveMode::Pinned(Muscle::ALIVE, pin), POWERED_HALF_LIFE);
                }
                self.become_powered();
                self.drive_bodies(world);
            }
        }
    }

    fn become_powered(&mut self) {
        if self.state != State::Powered {
            self.state = State::Powered;
            self.events.push(CharacterEvent::Powered);
        }
    }

    /// Pin that holds a body near its place by [`Preset::Powered`].
    fn powered_pin(&self, body: usize, gravity: f32) -> Pin {
        let def = &self.def.ragdoll;
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

    /// Has part of it moved in another way: half of the change is made within `half_life` seconds. What stands is powered
    /// from then on, all else of it as its clips have it.
    ///
    /// # Panics
    /// If no body is called so, or as [`Drives::set`].
    pub fn set_drive(&mut self, world: &mut World, part: Part<'_>, mode: DriveMode, half_life: f32) {
        let def = self.def.clone();
        let named = |name: &str| def.body_named(name).unwrap_or_else(|| panic!("no body is called '{name}'"));
        if self.state == State::Animated {
            self.take_bodies(world, DriveMode::Keyed);
        }
        if matches!(self.state, State::Animated | State::Flinching) {
            self.become_powered();
        }
        match part {
            Part::All => self.drives.set_all(mode, half_life),
            Part::Body(body) => self.drives.set(body, mode, half_life),
            Part::Named(name) => self.drives.set(named(name), mode, half_life),
            Part::From(name) => self.drives.set_from(&def.ragdoll, named(name), mode, half_life),
        }
        if self.state == State::Powered {
            self.drive_bodies(world);
        }
    }

    /// Drives of its bodies, to be changed: they count while it has any. [`set_drive`](Self::set_drive) gives it some.
    pub fn drives_mut(&mut self) -> &mut Drives {
        &mut self.drives
    }

    fn pelvis_children(&self) -> Vec<usize> {
        self.def.ragdoll.joints.iter().filter(|joint| joint.parent == 0).map(|joint| joint.child).collect()
    }

    /// Makes its bodies those of a ragdoll, at the pose and the speed that the animation has now, driven in one way.
    pub(super) fn take_bodies(&mut self, world: &mut World, mode: DriveMode) {
        if self.ragdoll.is_some() {
            return;
        }
        self.become_bodies(world, self.def.in_world.rule());
        self.drives.set_all(mode, 0.0);
    }

    /// Brings the bodies into the hands of physics, with joints between them.
    pub(super) fn become_bodies(&mut self, world: &mut World, rule: ContactRule) {
        if self.is_planted() {
            self.pose.clone_from(&self.planted);
        }
        let states = self.carried();
        (self.planting, self.passage) = Default::default();
        self.physical.rebase(self.def.mapping(), &self.def.rig, &self.pose);
        self.scratch.posed.clear();
        let def = self.def.clone();
        let hit = self.presence.as_ref().map(|presence| &presence.bodies).filter(|bodies| !bodies.is_empty());
        let lost: Vec<usize> = self.lost.iter().map(|&(body, _)| body).collect();
        let ragdoll = match hit {
            Some(bodies) => {
                let ragdoll = Ragdoll::wake_without(world, &def.ragdoll, bodies, &states, &lost);
                ragdoll.set_rule(world, rule);
                ragdoll
            }
            None => {
                let settings = &def.body_settings;
                let ragdoll = Ragdoll::spawn_without(world, &def.ragdoll, &states, settings, &self.lost);
                if rule != ContactRule::Push {
                    ragdoll.set_rule(world, rule);
                }
                ragdoll
            }
        };
        self.ragdoll = Some(ragdoll);
        self.keep_own();
        self.mark_own(world);
    }

    /// Gives the bodies back to the clips: they leave the world, or stay in it as hit bodies.
    pub(super) fn leave_bodies(&mut self, world: &mut World) {
        self.let_go(world);
        let Some(ragdoll) = self.ragdoll.take() else { return };
        match self.presence.as_mut().filter(|presence| !presence.bodies.is_empty()) {
            Some(presence) => {
                presence.before.clear();
                ragdoll.lull(world, self.def.in_world.rule());
                self.keep_own();
            }
            None => {
                self.undress(world);
                ragdoll.despawn(world);
                self.keep_own();
            }
        }
    }

    /// Goes on for a step while clips and physics share the bodies.
    pub(super) fn go_on_powered(&mut self, world: &mut World) {
        self.animate(world);
        let in_vain = self.stumble(world);
        let dt = world.def().dt();
        let mut resting = core::mem::take(&mut self.scratch.pose);
        resting.clone_from(&self.pose);
        self.body_poses(world);
        let place = self.world_from_character;
        let (mapping, bodies) = (self.def.mapping(), &self.scratch.after);
        self.physical.pose_over(mapping, &self.def.rig, &resting, place, bodies, &mut self.pose);
        self.scratch.pose = resting;
        if self.falls() || in_vain || self.state == State::Powered && self.is_toppled(world) {
            return self.go_limp(world);
        }
        if self.state == State::Flinching && self.is_gripped(world) {
            self.flinch_on();
        }
        if self.state == State::Flinching && self.come_back(dt) {
            self.leave_bodies(world);
            self.state = State::Animated;
            self.events.push(CharacterEvent::Recovered);
            self.lead_bodies(world);
        } else {
            self.drive_bodies(world);
        }
        self.steer(world);
    }

    /// Drives the bodies toward the pose of its clips, for the next step.
    pub(super) fn drive_bodies(&mut self, world: &mut World) {
        if self.ragdoll.is_some() {
            self.drive_toward_clips(world);
        }
    }

    pub(super) fn falls(&self) -> bool {
        self.presence.as_ref().is_some_and(|presence| presence.falls)
    }

    /// True if the pelvis has got too far from where its clips want it for the feet to hold it.
    fn is_toppled(&mut self, world: &World) -> bool {
        let mut wanted = core::mem::take(&mut self.scratch.wanted);
        wanted.clear();
        wanted.extend(self.animator.pose().iter());
        let mut bodies = core::mem::take(&mut self.scratch.before);
        self.bodies_of(&wanted, self.world_from_character, &mut bodies);
        let pelvis: Transform = bodies[0];
        (self.scratch.wanted, self.scratch.before) = (wanted, bodies);
        let ragdoll = self.ragdoll.as_ref().expect("a powered character has bodies");
        let now = world.transform(ragdoll.bodies[0]);
        let away = (now.translation - pelvis.translation).length();
        away > FALLS_BEYOND * self.def.ragdoll.height || now.rotation.angle_to(pelvis.rotation) > FALLS_TURNED
    }
}
