//! Predicts poses and velocities of the bodies from the clips, for hand-over speeds and drives.

use super::CharacterDef;
use super::State;
use super::feet::Feet;
use super::figure::{Figure, Scratch};
use super::gait::Gait;
use super::stumble::Stumble;
use crate::character::tuning::HAND_OVER_TIME;
use crate::def::RagdollBodyDef;
use crate::hand_over::body_velocity;
use crate::ragdoll::BodyState;
use sinew_anim::Animator;
use sinew_math::{Transform, Vec3};
use sinew_physics::Velocity;

/// The state that determines the poses of the next step.
#[derive(Clone, Copy)]
pub(super) struct Foresight<'a> {
    pub def: &'a CharacterDef,
    pub state: State,
    pub gait: &'a Gait,
    pub figure: &'a Figure,
    pub feet: &'a Feet,
    pub stumble: Option<&'a Stumble>,
    /// True if clips will move the bodies; the bodies of feet are then no lower than the drawn skin.
    pub leads: bool,
}

impl Foresight<'_> {
    /// Advances an animator by `seconds` and returns the poses of the bodies relative to the character's present
    /// transform. `place` is the transform to which the animator has moved the character before this call.
    fn bodies(
        &self,
        ahead: &mut Animator,
        place: &mut Transform,
        seconds: f32,
        scratch: &mut Scratch,
        out: &mut Vec<Transform>,
    ) {
        let (def, here) = (self.def, self.figure.place);
        ahead.update(def.set(), seconds);
        *place = self.gait.gone_on(def, here.rotation, *place, ahead, seconds);
        let mut pose = core::mem::take(&mut scratch.pose);
        pose.clear();
        pose.extend(ahead.pose().iter());
        self.feet.place(def, here * *place, seconds, &mut pose, &mut scratch.model);
        self.feet.clear_floor(def, self.state, here, seconds, &mut pose, &mut scratch.model);
        if let Some(stumble) = self.stumble {
            stumble.hold_feet(def, here, *place, seconds, &mut pose, &mut scratch.model);
        }
        if self.leads {
            scratch.hit_bodies_of(def, &pose, *place, out);
        } else {
            scratch.bodies_of(def, &pose, *place, out);
        }
        scratch.pose = pose;
    }

    /// Returns the poses and velocities of the bodies in the animation. The velocities come from poses shortly
    /// afterwards, not from the last pose, because tracks, weights and transitions may have changed since.
    pub fn carried(&self, scratch: &mut Scratch) -> Vec<BodyState> {
        let (mut now, mut ahead) =
            (core::mem::take(&mut scratch.before), core::mem::take(&mut scratch.after));
        // Compute relative to the character, because far from the world's origin rounding would remove small
        // displacements.
        let pose = self.feet.led(&self.figure.pose);
        scratch.bodies_of(self.def, pose, Transform::IDENTITY, &mut now);
        let (mut animator, mut way) = (scratch.sent_ahead(&self.gait.animator), Transform::IDENTITY);
        let laps = laps(&animator);
        // Velocities start from the clips' present pose, because the shown pose may come from bodies or stepping feet.
        let (mut from, mut further) = (Vec::new(), Vec::new());
        self.bodies(&mut animator, &mut way, 0.0, scratch, &mut from);
        self.bodies(&mut animator, &mut way, HAND_OVER_TIME, scratch, &mut ahead);
        self.bodies(&mut animator, &mut way, HAND_OVER_TIME, scratch, &mut further);
        if self::laps(&animator) != laps {
            // Poses may jump across a loop's seam, so use only the motion after the seam.
            core::mem::swap(&mut from, &mut further);
            self.bodies(&mut animator, &mut way, HAND_OVER_TIME, scratch, &mut ahead);
            self.bodies(&mut animator, &mut way, HAND_OVER_TIME, scratch, &mut further);
        }
        scratch.ahead = Some(animator);
        let place = self.figure.place;
        let state = |(index, body): (usize, &RagdollBodyDef)| {
            let [first, second, third] = [from[index], ahead[index], further[index]];
            let between = |a, b| body_velocity(a, b, body.mass.center, HAND_OVER_TIME, self.def.speed_bound);
            let (soon, later) = (between(first, second), between(second, third));
            // Extrapolate the means of two intervals to the start of the first: a transition may change speeds by a
            // tenth in one interval.
            let start = |soon: Vec3, later: Vec3| place.rotation * (soon + (soon - later) * 0.5);
            let velocity = Velocity {
                linear: start(soon.linear, later.linear),
                angular: start(soon.angular, later.angular),
            };
            BodyState { world_from_body: place * now[index], velocity }
        };
        let states = self.def.ragdoll.bodies.iter().enumerate().map(state).collect();
        (scratch.before, scratch.after) = (now, ahead);
        states
    }

    /// Computes the poses of the bodies in the clips at the end of the next step, in `scratch.after`, and their
    /// velocities until then, in `scratch.velocities`.
    pub fn next(&self, dt: f32, scratch: &mut Scratch) {
        let mut targets = core::mem::take(&mut scratch.after);
        let mut before = core::mem::take(&mut scratch.before);
        let mut ahead = scratch.sent_ahead(&self.gait.animator);
        let mut way = Transform::IDENTITY;
        self.bodies(&mut ahead, &mut way, 0.0, scratch, &mut before);
        self.bodies(&mut ahead, &mut way, dt, scratch, &mut targets);
        scratch.ahead = Some(ahead);
        let place = self.figure.place;
        for pose in before.iter_mut().chain(&mut targets) {
            *pose = place * *pose;
        }
        let velocity = |((&now, &ahead), body): ((&Transform, &Transform), &RagdollBodyDef)| {
            body_velocity(now, ahead, body.mass.center, dt, self.def.speed_bound)
        };
        let velocities = before.iter().zip(&targets).zip(&self.def.ragdoll.bodies).map(velocity);
        scratch.velocities.clear();
        scratch.velocities.extend(velocities);
        (scratch.before, scratch.after) = (before, targets);
    }
}

/// Returns the sum of the laps of all tracks: a change shows that a seam was passed.
fn laps(animator: &Animator) -> i64 {
    animator.tracks().fold(0, |sum, track| sum.wrapping_add(track.playhead().lap()))
}
