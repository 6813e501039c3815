//! Between lying still and getting up: a body that lies like no clip begins is brought to where the nearest one does.
//!
//! Its muscles draw its limbs there. What rolls its trunk over is a torque from nowhere, as no limp body has: a pin that only
//! turns, bounded in torque and time, so that [`Drives::pin_effort`](crate::Drives::pin_effort) tells how much that was.

use super::get_up::{Choice, choose};
use super::memory::Preparation;
use super::{Character, CharacterEvent, GettingReady, State};
use crate::character::tuning::{PREPARES_HALF_LIFE, ROLL_HERTZ, ROLL_STRENGTH, TIME_TO_PULL, TIME_TO_ROLL};
use crate::drive::{DriveMode, Muscle, Pin};
use sinew_math::Rotation;
use sinew_physics::{Velocity, World};

/// By so much a trunk is turned from how its clip begins, radians, and so far are the joints on the mean from where they are
/// then, share of the body's height: where a body may get up at once, and when one that is brought there has come near
/// enough.
const AT_ONCE: [f32; 2] = [0.85, 0.16];
const NEAR_ENOUGH: [f32; 2] = [0.7, 0.14];
/// Muscle that draws the limbs.
const PULL: Muscle = Muscle { hertz: 2.0, damping_ratio: 1.0, strength: 0.6 };

impl Character {
    /// Gets up, or first brings the body to where it can.
    pub(super) fn prepare(&mut self, world: &mut World) {
        let lies = self.stance();
        let def = self.def.clone();
        let moves = def.moves();
        let choice = choose(&moves.get_ups, &moves.landmarks, &lies).filter(|choice| {
            def.getting_ready == GettingReady::RollOver && !self.is_like(choice, lies.pelvis, AT_ONCE)
        });
        let Some(choice) = choice else {
            self.scratch.points = lies.points;
            return self.get_up_where_free(world);
        };
        let rolls = trunk_off(&choice, lies.pelvis) > AT_ONCE[0];
        let index = |at: Option<usize>| at.unwrap_or_default() as u32;
        self.preparation = Preparation {
            get_up: index(moves.get_ups.iter().position(|get_up| core::ptr::eq(get_up, choice.get_up))),
            start: index(choice.get_up.starts.iter().position(|start| core::ptr::eq(start, choice.start))),
            seconds: if rolls { TIME_TO_ROLL } else { TIME_TO_PULL },
        };
        self.state = State::Preparing;
        self.events.push(CharacterEvent::Preparing { rolls });
        self.drives.set_all(DriveMode::Powered(PULL), PREPARES_HALF_LIFE);
        if rolls {
            let gravity = world.def().gravity.length();
            let max_torque = ROLL_STRENGTH * def.ragdoll.total_mass * gravity * def.ragdoll.height;
            let pin = Pin { hertz: ROLL_HERTZ, damping_ratio: 1.0, max_force: 0.0, max_torque };
            for body in moves.landmarks.trunk_bodies() {
                self.drives.set(body, DriveMode::Pinned(PULL, pin), PREPARES_HALF_LIFE);
            }
        }
        self.draw(world, &choice);
    }

    /// Goes on with that for a step; gets up where the body lies as the clip begins, or time is up.
    pub(super) fn go_on_preparing(&mut self, world: &mut World) {
        self.follow_bodies(world);
        if self.is_gripped(world) {
            return self.go_limp(world);
        }
        self.stillness.steps += 1;
        self.preparation.seconds -= world.def().dt();
        let lies = self.stance();
        let def = self.def.clone();
        let moves = def.moves();
        let get_up = &moves.get_ups[self.preparation.get_up as usize];
        let start = &get_up.starts[self.preparation.start as usize];
        let choice = Choice { get_up, start, pose_similarity: moves.landmarks.compare(&start.stance, &lies) };
        if self.preparation.seconds <= 0.0 || self.is_like(&choice, lies.pelvis, NEAR_ENOUGH) {
            self.scratch.points = lies.points;
            return self.get_up_where_free(world);
        }
        self.draw(world, &choice);
        self.scratch.points = lies.points;
    }

    fn is_like(&self, choice: &Choice<'_>, pelvis: Rotation, [trunk, joints]: [f32; 2]) -> bool {
        let joints_off = choice.pose_similarity.distance / self.def.ragdoll.height;
        trunk_off(choice, pelvis) < trunk && joints_off < joints
    }

    /// Drives the bodies toward the moment of the clip, where they lie, for the next step.
    fn draw(&mut self, world: &mut World, choice: &Choice<'_>) {
        let ragdoll = self.ragdoll.as_ref().expect("a body that is rolled over has bodies");
        let targets = &mut self.scratch.before;
        targets.clear();
        targets.extend(choice.start.bodies.iter().map(|&body| choice.pose_similarity.motion * body));
        self.scratch.velocities.clear();
        self.scratch.velocities.resize(targets.len(), Velocity::default());
        self.drives.apply(world, &self.def.ragdoll, ragdoll, targets, &self.scratch.velocities);
    }
}

/// By how much the pelvis is turned from how the clip has it, radians.
fn trunk_off(choice: &Choice<'_>, pelvis: Rotation) -> f32 {
    (choice.pose_similarity.motion.rotation * choice.start.stance.pelvis).angle_to(pelvis)
}
