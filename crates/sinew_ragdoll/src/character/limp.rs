//! Going limp at the speed of the animation, and lying still.

use super::ground::{self, GroundMotion};
use super::memory::Stillness;
use super::{AfterSettling, Character, CharacterEvent, State};
use crate::character::tuning::{
    HAND_OVER_TIME, LINGERS, SLACKENS, STILL_ANGULAR, STILL_LINEAR, STILL_TIME, SUNK,
};
use crate::def::RagdollBodyDef;
use crate::drive::DriveMode;
use crate::hand_over::body_velocity;
use crate::ragdoll::BodyState;
use sinew_anim::{Animator, Motion, Pose};
use sinew_math::{Transform, Vec3, min};
use sinew_physics::{BodyId, BodyKind, ContactRule, ShapeId, Velocity, World};

impl Character {
    /// Lets the bodies take over, at the pose and the speed that the animation has now. Nothing happens if they did
    /// already.
    pub fn go_limp(&mut self, world: &mut World) {
        if self.ragdoll.is_some() {
            return self.fall_again(world);
        }
        self.release_all(world, true);
        self.become_bodies(world, ContactRule::Push);
        self.let_linger(world);
        self.sit_down(world);
        self.drives.set_all(self.def.falling, 0.0);
        self.state = State::Limp;
        self.stillness = Stillness::default();
        self.slacken(world);
        self.events.push(CharacterEvent::WentLimp);
        self.clear(world);
    }

    /// Brings friction into the joints over [`SLACKENS`] seconds: what muscles held a moment ago goes on, for all of it at once
    /// would stop a hand within a step.
    fn slacken(&self, world: &mut World) {
        let share = self.stillness.steps as f32 * world.def().dt() / SLACKENS;
        let ragdoll = self.ragdoll.as_ref().expect("a limp character has bodies");
        for (child, id) in ragdoll.own_joints() {
            let joint = &self.def.ragdoll.joints[child - 1];
            world.set_joint_friction(id, joint.friction_torque * min(share, 1.0));
        }
    }

    /// Lets what no body moves come to rest by and by: toes, helpers, and the places of joints that a clip moved along.
    fn let_linger(&mut self, world: &World) {
        let now: Pose = self.pose.iter().copied().collect();
        let earlier: Pose = self.earlier.pose.iter().copied().collect();
        let seconds = world.def().dt();
        let from = Motion { now: &now, other: &earlier, seconds };
        self.lingering.start(from, Motion { now: &now, other: &now, seconds }, LINGERS);
        self.scratch.resting = now;
    }

    /// The base pose, and what lingers of its motion a step later.
    fn come_to_rest(&mut self, seconds: f32) {
        let base = self.physical.base();
        self.scratch.pose.clear();
        if self.lingering.is_over() {
            self.scratch.pose.extend_from_slice(base);
            return;
        }
        let resting = &mut self.scratch.resting;
        if resting.len() != base.len() {
            *resting = Pose::new(base.len());
        }
        base.iter().enumerate().for_each(|(joint, local)| resting.set(joint, local));
        self.lingering.apply(seconds, resting);
        self.scratch.pose.extend(resting.iter());
    }

    /// A body that was about to get up, or that muscles held, is limp again.
    fn fall_again(&mut self, world: &mut World) {
        let powered = match self.state {
            State::Flinching | State::Powered => true,
            State::Preparing => false,
            State::Animated | State::Limp | State::GettingUp => return,
        };
        let all: Vec<usize> =
            (0..self.def.ragdoll.bodies.len()).filter(|&body| self.has_body(body)).collect();
        self.slow_led(world, &all);
        self.let_go(world);
        self.state = State::Limp;
        self.stillness = Stillness { touched: !powered, ..Stillness::default() };
        if powered {
            self.release_all(world, true);
            self.let_linger(world);
            self.physical.rebase(self.def.mapping(), &self.def.rig, &self.pose);
            self.scratch.posed.clear();
            self.sit_down(world);
            self.ragdoll.as_ref().expect("it has bodies").set_rule(world, ContactRule::Push);
            self.slacken(world);
        }
        self.events.push(CharacterEvent::WentLimp);
        self.clear(world);
    }

    /// Gives bodies that clips lead the velocities that they have in the clips: with those that bring them to their place within a step, which a mover
    /// that takes a kerb has put up by the height of it, they would be thrown once they are let go.
    pub(super) fn slow_led(&mut self, world: &mut World, bodies: &[usize]) {
        self.look_ahead(world);
        let ragdoll = self.ragdoll.as_ref().expect("it has bodies");
        for (id, velocity) in bodies.iter().map(|&body| (ragdoll.bodies[body], self.scratch.velocities[body]))
        {
            if world.kind(id) == BodyKind::Kinematic {
                world.set_velocity(id, velocity);
            }
        }
    }

    /// Takes all drives off the bodies but those of a fall.
    pub(super) fn let_go(&mut self, world: &mut World) {
        if let Some(ragdoll) = &self.ragdoll {
            self.drives.release(world, ragdoll);
        }
        self.drives.set_all(self.def.falling, 0.0);
    }

    /// Poses and velocities of the bodies as the animation carries them, whatever it is made of: by where it will
    /// have them in a moment, for tracks, weights and transitions may all have changed since the last pose.
    pub(super) fn carried(&mut self) -> Vec<BodyState> {
        let (mut now, mut ahead) =
            (core::mem::take(&mut self.scratch.before), core::mem::take(&mut self.scratch.after));
        // Seen by the character: far from the world's origin small ways drown in rounding.
        let pose = core::mem::take(&mut self.pose);
        self.bodies_of(&pose, Transform::IDENTITY, &mut now);
        self.pose = pose;
        let (mut animator, mut way) = (self.sent_ahead(), Transform::IDENTITY);
        let laps = laps(&animator);
        // Velocities are those of the clips, from what they have now: the pose may be bodies', or stepping feet's, and a millimetre beside theirs.
        let (mut from, mut further) = (Vec::new(), Vec::new());
        self.bodies_ahead(&mut animator, &mut way, 0.0, &mut from);
        self.bodies_ahead(&mut animator, &mut way, HAND_OVER_TIME, &mut ahead);
        self.bodies_ahead(&mut animator, &mut way, HAND_OVER_TIME, &mut further);
        if self::laps(&animator) != laps {
            // Across a loop's seam poses may jump: what counts is how they go on behind it.
            core::mem::swap(&mut from, &mut further);
            self.bodies_ahead(&mut animator, &mut way, HAND_OVER_TIME, &mut ahead);
            self.bodies_ahead(&mut animator, &mut way, HAND_OVER_TIME, &mut further);
        }
        self.scratch.ahead = Some(animator);
        let place = self.world_from_character;
        let state = |(index, body): (usize, &RagdollBodyDef)| {
            let [first, second, third] = [from[index], ahead[index], further[index]];
            let between = |a, b| body_velocity(a, b, body.mass.center, HAND_OVER_TIME, self.def.speed_bound);
            let (soon, later) = (between(first, second), between(second, third));
            // Means of two spans, brought to the start of the first: a transition may well change speeds by a tenth in one.
            let start = |soon: Vec3, later: Vec3| place.rotation * (soon + (soon - later) * 0.5);
            let velocity = Velocity {
                linear: start(soon.linear, later.linear),
                angular: start(soon.angular, later.angular),
            };
            BodyState { world_from_body: place * now[index], velocity }
        };
        let states = self.def.ragdoll.bodies.iter().enumerate().map(state).collect();
        (self.scratch.before, self.scratch.after) = (now, ahead);
        states
    }

    /// Takes the pose from the bodies, but for what they do not move.
    pub(super) fn follow_bodies(&mut self, world: &World) {
        let dt = world.def().dt();
        self.keep_earlier();
        self.animator.update(self.def.set(), dt);
        self.body_poses(world);
        // Bodies that lie where the last pose had them need no other: most of a fall is lying.
        if !self.lingering.is_over() || self.scratch.posed != self.scratch.after {
            self.pose_by_bodies(dt);
        }
        for &joint in self.def.mapping().free() {
            self.pose[joint] = self.animator.pose().get(joint);
        }
    }

    /// The pose for bodies at `scratch.after`.
    fn pose_by_bodies(&mut self, dt: f32) {
        self.scratch.posed.clear();
        if self.lingering.is_over() {
            self.scratch.posed.extend_from_slice(&self.scratch.after);
        }
        self.come_to_rest(dt);
        self.physical.pose_over(
            self.def.mapping(),
            &self.def.rig,
            &self.scratch.pose,
            self.world_from_character,
            &self.scratch.after,
            &mut self.pose,
        );
    }

    /// Powers the joints of a falling body, for the next step, toward the pose of its clips.
    fn brace(&mut self, world: &mut World) {
        if self.def.falling != DriveMode::Limp {
            self.drive_toward_clips(world);
        }
    }

    /// Poses of the bodies in the clips at the end of the next step, in `scratch.after`, and their velocities on the way there, in `scratch.velocities`.
    fn look_ahead(&mut self, world: &World) {
        let mut targets = core::mem::take(&mut self.scratch.after);
        let mut before = core::mem::take(&mut self.scratch.before);
        let mut ahead = self.sent_ahead();
        let mut way = Transform::IDENTITY;
        self.bodies_ahead(&mut ahead, &mut way, 0.0, &mut before);
        let dt = world.def().dt();
        self.bodies_ahead(&mut ahead, &mut way, dt, &mut targets);
        self.scratch.ahead = Some(ahead);
        let place = self.world_from_character;
        for pose in before.iter_mut().chain(&mut targets) {
            *pose = place * *pose;
        }
        let velocity = |((&now, &ahead), body): ((&Transform, &Transform), &RagdollBodyDef)| {
            body_velocity(now, ahead, body.mass.center, dt, self.def.speed_bound)
        };
        let velocities = before.iter().zip(&targets).zip(&self.def.ragdoll.bodies).map(velocity);
        self.scratch.velocities.clear();
        self.scratch.velocities.extend(velocities);
        (self.scratch.before, self.scratch.after) = (before, targets);
    }

    /// Drives the bodies, for the next step, toward the pose that the clips will have then.
    pub(super) fn drive_toward_clips(&mut self, world: &mut World) {
        self.look_ahead(world);
        let ragdoll = self.ragdoll.as_ref().expect("a limp character has bodies");
        let (targets, velocities) = (&self.scratch.after, &self.scratch.velocities);
        self.drives.apply(world, &self.def.ragdoll, ragdoll, targets, velocities);
    }

    /// True while something holds it: then movers pass through it, so that it is in nobody's way who drags it.
    fn mind_grips(&mut self, world: &mut World) -> bool {
        let is_gripped = self.is_gripped(world);
        let ragdoll = self.ragdoll.as_ref().expect("a limp character has bodies");
        let now = world.contact_rule(ShapeId { body: ragdoll.bodies[0], shape: 0 });
        if is_gripped && now == ContactRule::Push {
            ragdoll.set_rule(world, self.def.in_world.rule());
        } else if !is_gripped && now != ContactRule::Push && !self.is_entered(world) {
            ragdoll.set_rule(world, ContactRule::Push);
        }
        if is_gripped {
            // It lies anew once it is free.
            let slack = (SLACKENS / world.def().dt()) as u32 + 1;
            self.stillness.steps = u32::min(self.stillness.steps, slack);
            self.stillness.settled &= self.stillness.calm_steps > 0;
        }
        is_gripped
    }

    /// Waits until the bodies lie still.
    pub(super) fn lie(&mut self, world: &mut World) {
        self.follow_bodies(world);
        if self.is_clearing() {
            return self.go_out(world);
        }
        self.brace(world);
        let dt = world.def().dt();
        let was_slack = self.stillness.steps as f32 * dt < SLACKENS;
        self.stillness.steps += 1;
        if was_slack {
            self.slacken(world);
        }
        let gets_up = self.def.after_settling == AfterSettling::GetUp && self.may_get_up();
        let ragdoll = self.ragdoll.as_ref().expect("a limp character has bodies");
        let own: &[BodyId] = if self.lost.is_empty() { &ragdoll.bodies } else { &self.kept };
        let still = &mut self.stillness;
        if !still.touched && touches_world(world, own) {
            still.touched = true;
            self.events.push(CharacterEvent::Touched);
        }
        let ground = match self.presence {
            Some(_) => ground::motion_below(world, own),
            None => GroundMotion::default(),
        };
        let is_still = is_still_on(world, own, ground);
        still.calm_steps = if is_still { still.calm_steps + 1 } else { 0 };
        let mut calm = still.calm_steps as f32 * dt;
        if !still.settled && calm >= STILL_TIME && is_sunk(world, own) {
            (still.calm_steps, calm) = (0, 0.0);
        }
        if !still.settled && calm >= STILL_TIME {
            still.settled = true;
            self.events.push(CharacterEvent::Settled { since: world.time() as f32 - calm });
        }
        if self.mind_grips(world) {
            return;
        }
        let still = &mut self.stillness;
        let impatient = !still.settled && still.steps as f32 * dt >= self.def.patience;
        if gets_up && (still.settled || impatient) {
            if impatient {
                self.events.push(CharacterEvent::NeverSettled);
                self.stillness.settled = true;
            }
            self.prepare(world);
        }
    }
}

/// Laps of all tracks, summed: another sum after a moment tells of a seam between.
fn laps(animator: &Animator) -> i64 {
    animator.tracks().fold(0, |sum, track| sum.wrapping_add(track.playhead().lap()))
}

/// True if every body is slower than what counts as still.
pub(crate) fn is_still(world: &World, bodies: &[BodyId]) -> bool {
    is_still_on(world, bodies, GroundMotion::default())
}

/// The same beside what bears them.
fn is_still_on(world: &World, bodies: &[BodyId], ground: GroundMotion) -> bool {
    bodies.iter().all(|&body| {
        let velocity = world.velocity(body);
        let linear = velocity.linear - ground.at(world.center_of_mass(body));
        linear.length() < STILL_LINEAR && (velocity.angular - ground.angular()).length() < STILL_ANGULAR
    })
}

/// True if one of the bodies is deeper than [`SUNK`] in what stands, and on its way out.
pub(crate) fn is_sunk(world: &World, bodies: &[BodyId]) -> bool {
    bodies.iter().any(|&body| world.penetration(body) > SUNK)
}

/// True if one of the bodies began to touch something else in the last step.
pub(crate) fn touches_world(world: &World, bodies: &[BodyId]) -> bool {
    let own = |body: &BodyId| bodies.contains(body);
    world.events().begin.iter().any(|(a, b)| own(a) != own(b))
}
