//! Lying: state of a limp character, and when it lies still.

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
    /// Way out of shapes that it was deep in when it went limp.
    pub clearing: Clearing,
}

/// Time for which a limp character has been still, in steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Stillness {
    /// Steps since it went limp.
    pub steps: u32,
    /// Steps for which every body has been slow.
    pub calm_steps: u32,
    pub settled: bool,
    pub touched: bool,
    /// Nobody was on it when it last tried to get up.
    pub free: bool,
}

/// A limp character on its way out of a wall or the floor.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Clearing {
    /// Remaining displacement after the next step, world, metres.
    pub way: Vec3,
    /// Velocities of its bodies at the end of the way; empty without one.
    pub velocities: Vec<Velocity>,
}

/// Result of a step while lying.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Lain {
    /// The first of its bodies touched something.
    pub touched: bool,
    /// It has lain still for this many seconds.
    pub settled: Option<f32>,
}

impl Stillness {
    /// Updates whether the bodies touch something and lie still. `on_ground`: relative to the body under them.
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

    /// Something holds it: its time restarts once it is free.
    pub fn wait(&mut self, dt: f32) {
        let slack = (SLACKENS / dt) as u32 + 1;
        self.steps = u32::min(self.steps, slack);
        self.settled &= self.calm_steps > 0;
    }

    /// Share of the joint friction after so much time limp.
    pub fn slackness(&self, dt: f32) -> f32 {
        self.steps as f32 * dt / SLACKENS
    }
}

impl Physique {
    /// The ragdoll, if there is one.
    pub fn limp(&self) -> &Ragdoll {
        self.ragdoll.as_ref().expect("a limp character has bodies")
    }

    /// Applies a share of the friction to the joints: full friction at once would stop a hand within a step.
    pub fn slacken(&self, def: &CharacterDef, share: f32, world: &mut World) {
        for (child, id) in self.limp().own_joints() {
            let joint = &def.ragdoll.joints[child - 1];
            world.set_joint_friction(id, joint.friction_torque * min(share, 1.0));
        }
    }

    /// Lets joints without bodies come to rest gradually: toes, helpers, and translations of joints.
    pub fn let_linger(&mut self, figure: &Figure, seconds: f32, scratch: &mut Scratch) {
        let now: Pose = figure.pose.iter().copied().collect();
        let earlier: Pose = figure.earlier.pose.iter().copied().collect();
        let from = Motion { now: &now, other: &earlier, seconds };
        self.lingering.start(from, Motion { now: &now, other: &now, seconds }, LINGERS);
        scratch.resting = now;
    }

    /// The base pose, with the decaying rest of its motion a step later, in `scratch.pose`.
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

    /// Has the place of a limp character go with its pelvis, under which it comes to be, as high as its lowest body.
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

    /// Takes the pose from the bodies, except for joints without one. Bodies that have not moved since the last pose
    /// need no new one, which saves most of a fall.
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

/// True if every body is below the stillness speeds.
pub(crate) fn is_still(world: &World, bodies: &[BodyId]) -> bool {
    is_still_on(world, bodies, GroundMotion::default())
}

/// The same relative to the body under them.
fn is_still_on(world: &World, bodies: &[BodyId], ground: GroundMotion) -> bool {
    bodies.iter().all(|&body| {
        let velocity = world.velocity(body);
        let linear = velocity.linear - ground.at(world.center_of_mass(body));
        linear.length() < STILL_LINEAR && (velocity.angular - ground.angular()).length() < STILL_ANGULAR
    })
}

/// True if one of the bodies is deeper than [`SUNK`] in static shapes and being pushed out.
pub(crate) fn is_sunk(world: &World, bodies: &[BodyId]) -> bool {
    bodies.iter().any(|&body| world.penetration(body) > SUNK)
}

/// True if one of the bodies began to touch something else in the last step.
pub(crate) fn touches_world(world: &World, bodies: &[BodyId]) -> bool {
    let own = |body: &BodyId| bodies.contains(body);
    world.events().begin.iter().any(|(a, b)| own(a) != own(b))
}
