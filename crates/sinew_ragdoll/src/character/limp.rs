//! State of a limp character, and detection of its rest.

use super::CharacterDef;
use super::figure::{Figure, Scratch};
use super::ground::{self, GroundMotion};
use super::physique::Physique;
use crate::character::tuning::{
    LINGERS, PLACE_FOLLOWS, PLACE_RESTS, SLACKENS, STILL_ANGULAR, STILL_LINEAR, STILL_TIME, SUNK,
};
use crate::ragdoll::Ragdoll;
use sinew_anim::{Motion, Pose};
use sinew_math::{Transform, Vec3, min, trig};
use sinew_physics::{BodyId, Velocity, World};

/// A limp character.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Lying {
    pub stillness: Stillness,
    /// Displacement of the character out of shapes that it penetrated deeply.
    pub clearing: Clearing,
}

/// Time for which a limp character has been still, in steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Stillness {
    /// Steps since the character went limp.
    pub steps: u32,
    /// Steps for which every body has been slow.
    pub calm_steps: u32,
    pub settled: bool,
    pub touched: bool,
    /// True if nothing prevented the character's last attempt to get up.
    pub free: bool,
}

/// Displacement of a limp character out of a wall or the floor.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Clearing {
    /// Remaining displacement after the next step, world, metres.
    pub way: Vec3,
    /// Velocities that the bodies get at the end of the displacement; empty if there is no displacement.
    pub velocities: Vec<Velocity>,
}

/// Result of a step while lying.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Lain {
    /// True if a body touched another object for the first time since the character went limp.
    pub touched: bool,
    /// Time for which the character has lain still, seconds, in the step in which it settles; otherwise `None`.
    pub settled: Option<f32>,
}

impl Stillness {
    /// Checks whether the bodies touch another object and lie still. If `on_ground` is true, their speeds are measured
    /// relative to the body under them.
    pub fn look(&mut self, world: &World, own: &[BodyId], on_ground: bool) -> Lain {
        let mut lain = Lain::default();
        if !self.touched && touches_world(world, own) {
            (self.touched, lain.touched) = (true, true);
        }
        let ground = if on_ground { ground::motion_below(world, own) } else { GroundMotion::default() };
        let is_still = is_still_on(world, own, ground);
        self.calm_steps = if is_still { self.calm_steps + 1 } else { 0 };
        let mut calm = self.calm_steps as f32 * world.def().dt();
        if !self.settled && calm >= STILL_TIME && is_sunk(world, own) {
            (self.calm_steps, calm) = (0, 0.0);
        }
        if !self.settled && calm >= STILL_TIME {
            self.settled = true;
            lain.settled = Some(calm);
        }
        lain
    }

    /// Resets the time for which the character has lain, because it is held; the time counts again once it is free.
    pub fn wait(&mut self, dt: f32) {
        let slack = (SLACKENS / dt) as u32 + 1;
        self.steps = u32::min(self.steps, slack);
        self.settled &= self.calm_steps > 0;
    }

    /// Returns the share of the full joint friction that applies at this time after going limp; it may exceed 1.
    pub fn friction_share(&self, dt: f32) -> f32 {
        self.steps as f32 * dt / SLACKENS
    }
}

impl Physique {
    /// Returns the ragdoll; panics if there is none.
    pub fn limp(&self) -> &Ragdoll {
        self.ragdoll.as_ref().expect("a character in this state has a ragdoll")
    }

    /// Applies `share` of the full friction, at most all of it, to the joints. The full friction would stop a hand
    /// within a step.
    pub fn slacken(&self, def: &CharacterDef, share: f32, world: &mut World) {
        for (child, id) in self.limp().own_joints() {
            let joint = &def.ragdoll.joints[child - 1];
            world.set_joint_friction(id, joint.friction_torque * min(share, 1.0));
        }
    }

    /// Starts to decay the motion of joints without bodies (toes, helpers, translations of joints). `seconds` is the
    /// time between the present pose and the one before.
    pub fn let_linger(&mut self, figure: &Figure, seconds: f32, scratch: &mut Scratch) {
        let now: Pose = figure.pose.iter().copied().collect();
        let earlier: Pose = figure.earlier.pose.iter().copied().collect();
        let from = Motion { now: &now, other: &earlier, seconds };
        self.lingering.start(from, Motion { now: &now, other: &now, seconds }, LINGERS);
        scratch.resting = now;
    }

    /// Computes in `scratch.pose` the base pose plus the decaying motion of joints without bodies, `seconds` later.
    fn come_to_rest(&mut self, seconds: f32, scratch: &mut Scratch) {
        let base = self.physical.base();
        scratch.pose.clear();
        if self.lingering.is_over() {
            scratch.pose.extend_from_slice(base);
            return;
        }
        let resting = &mut scratch.resting;
        if resting.len() != base.len() {
            *resting = Pose::new(base.len());
        }
        base.iter().enumerate().for_each(|(joint, local)| resting.set(joint, local));
        self.lingering.apply(seconds, resting);
        scratch.pose.extend(resting.iter());
    }

    /// Moves the transform of a limp character with its pelvis. The transform also approaches the point that is below
    /// the pelvis at the height of the lowest body.
    pub fn take_along(&self, place: &mut Transform, world: &World, scratch: &mut Scratch) {
        let Some(&pelvis) = self.own().first() else { return };
        let dt = world.def().dt();
        let lowest = self.own().iter().map(|&body| world.bounds(body).min.y).fold(f32::INFINITY, min);
        let under = world.transform(pelvis).translation;
        let under = Vec3::new(under.x, lowest, under.z);
        let carried = world.velocity(pelvis).linear * Vec3::new(dt, 0.0, dt);
        let left = under - place.translation - carried;
        let way = carried - left * trig::exp_m1(-PLACE_FOLLOWS * dt);
        if way.is_finite() && way.length() > PLACE_RESTS {
            place.translation += way;
            scratch.posed.clear();
        }
    }

    /// Computes the pose from the bodies, except for joints without a body. Keeps the last pose if no body has moved
    /// since, which saves most of the time while a character lies.
    pub fn pose(&mut self, def: &CharacterDef, figure: &mut Figure, world: &World, scratch: &mut Scratch) {
        self.poses(def, world, scratch);
        if self.lingering.is_over() && scratch.posed == scratch.after {
            return;
        }
        scratch.posed.clear();
        if self.lingering.is_over() {
            scratch.posed.extend_from_slice(&scratch.after);
        }
        self.come_to_rest(world.def().dt(), scratch);
        let (place, pose) = (figure.place, &mut figure.pose);
        self.physical.pose_over(def.mapping(), &def.rig, &scratch.pose, place, &scratch.after, pose);
    }
}

/// Returns true if every body is slower than [`STILL_LINEAR`] and [`STILL_ANGULAR`].
pub(crate) fn is_still(world: &World, bodies: &[BodyId]) -> bool {
    is_still_on(world, bodies, GroundMotion::default())
}

/// Returns true if every body is slower than [`STILL_LINEAR`] and [`STILL_ANGULAR`] relative to the ground `ground`.
fn is_still_on(world: &World, bodies: &[BodyId], ground: GroundMotion) -> bool {
    bodies.iter().all(|&body| {
        let velocity = world.velocity(body);
        let linear = velocity.linear - ground.at(world.center_of_mass(body));
        linear.length() < STILL_LINEAR && (velocity.angular - ground.angular()).length() < STILL_ANGULAR
    })
}

/// Returns true if one of the bodies is deeper than [`SUNK`] in static bodies, so that contacts still push it out.
pub(crate) fn is_sunk(world: &World, bodies: &[BodyId]) -> bool {
    bodies.iter().any(|&body| world.penetration(body) > SUNK)
}

/// Returns true if one of the bodies began to touch another object in the last step.
pub(crate) fn touches_world(world: &World, bodies: &[BodyId]) -> bool {
    let own = |body: &BodyId| bodies.contains(body);
    world.events().begin.iter().any(|(a, b)| own(a) != own(b))
}
