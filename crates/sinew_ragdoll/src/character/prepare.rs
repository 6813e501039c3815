//! Between lying still and getting up: a body that lies like no clip begins is rolled over to the nearest that does.
//!
//! What rolls it is a torque on its trunk from nowhere, as no limp body has: it is bounded, and so is its time.

use super::get_up::{Choice, choose};
use super::{Character, Event, GettingReady, State};
use sinew_math::{Rotation, Vec3};
use sinew_physics::{BodyId, World};

/// A body may differ so much from where its clip begins, the trunk by turn (radians), and the whole by the mean distance of
/// its joints over its height.
const LIKE_ENOUGH: (f32, f32) = (0.6, 0.13);
/// Seconds in which the body is brought to where the clip begins: where its trunk has to turn, and where it has not.
const TIME_TO_ROLL: f32 = 1.5;
const TIME_TO_PULL: f32 = 0.5;
/// A trunk is turned like a spring of this many hertz, damped critically.
const HERTZ: f32 = 1.2;
/// Of the whole body about its length: radius of gyration over height.
const GYRATION: f32 = 0.12;
/// Largest torque over weight times height: 130 N·m of a man.
const STRENGTH: f32 = 0.1;

/// A body on its way to where a clip begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Preparation {
    /// Index of the way to get up, and of its moment.
    pub get_up: u32,
    pub start: u32,
    /// That are left.
    pub seconds: f32,
}

impl Character {
    /// Gets up, or first brings the body to where it can.
    pub(super) fn prepare(&mut self, world: &mut World) {
        let lies = self.stance();
        let def = self.def.clone();
        let moves = def.moves();
        let Some(choice) = choose(&moves.get_ups, &moves.landmarks, &lies) else {
            return self.get_up(world);
        };
        if self.def.getting_ready == GettingReady::AtOnce || self.is_like(&choice, lies.pelvis) {
            return self.get_up(world);
        }
        let turns = trunk_error(&choice, lies.pelvis).length() > LIKE_ENOUGH.0;
        let index = |at: Option<usize>| at.unwrap_or_default() as u32;
        self.preparation = Preparation {
            get_up: index(moves.get_ups.iter().position(|get_up| core::ptr::eq(get_up, choice.get_up))),
            start: index(choice.get_up.starts.iter().position(|start| core::ptr::eq(start, choice.start))),
            seconds: if turns { TIME_TO_ROLL } else { TIME_TO_PULL },
        };
        self.state = State::Preparing;
        self.events.push(Event::Preparing { rolls: turns });
        self.roll(world, trunk_error(&choice, lies.pelvis));
    }

    /// Goes on with that for a step; gets up where the body lies as the clip begins, or time is up.
    pub(super) fn go_on_preparing(&mut self, world: &mut World) {
        self.follow_bodies(world);
        self.preparation.seconds -= world.def().dt();
        let lies = self.stance();
        let def = self.def.clone();
        let moves = def.moves();
        let get_up = &moves.get_ups[self.preparation.get_up as usize];
        let start = &get_up.starts[self.preparation.start as usize];
        let choice = Choice { get_up, start, likeness: moves.landmarks.compare(&start.stance, &lies) };
        if self.preparation.seconds <= 0.0 || self.is_like(&choice, lies.pelvis) {
            return self.get_up(world);
        }
        self.roll(world, trunk_error(&choice, lies.pelvis));
    }

    fn is_like(&self, choice: &Choice<'_>, pelvis: Rotation) -> bool {
        trunk_error(choice, pelvis).length() < LIKE_ENOUGH.0
            && choice.likeness.distance < LIKE_ENOUGH.1 * self.def.ragdoll.height
    }

    /// Turns the trunk by a bounded torque, for the next step. `error` is what it has to turn, scaled axis, world axes.
    fn roll(&mut self, world: &mut World, error: Vec3) {
        let def = &self.def.ragdoll;
        let ragdoll = self.ragdoll.as_ref().expect("a body that is rolled over has bodies");
        let trunk = self.def.moves().landmarks.trunk_bodies();
        let speed = 2.0 * core::f32::consts::PI * HERTZ;
        let inertia = def.total_mass * (GYRATION * def.height) * (GYRATION * def.height);
        let gravity = world.def().gravity.length();
        let most = STRENGTH * def.total_mass * gravity * def.height;
        let spin = world.velocity(ragdoll.bodies[0]).angular;
        let wanted = (error * speed - spin * 2.0) * (speed * inertia);
        let size = wanted.length();
        let torque = if size > most { wanted * (most / size) } else { wanted };
        let bodies: Vec<BodyId> = trunk.map(|body| ragdoll.bodies[body]).collect();
        let share = 1.0 / bodies.len() as f32;
        bodies.into_iter().for_each(|body| world.apply_torque(body, torque * share));
    }
}

/// What the pelvis has to turn to be as the clip has it: scaled axis, world axes.
fn trunk_error(choice: &Choice<'_>, pelvis: Rotation) -> Vec3 {
    let wanted = choice.likeness.motion.rotation * choice.start.stance.pelvis;
    (wanted * pelvis.inverse()).to_scaled_axis()
}
