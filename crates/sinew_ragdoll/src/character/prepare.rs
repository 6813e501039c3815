//! Drives a lying body to the start of the nearest get-up clip.
//!
//! Muscles drive the limbs. The trunk is rolled over by a non-physical torque: a pin that only rotates, bounded in
//! torque and time; [`Drives::pin_effort`](crate::Drives::pin_effort) reports this torque.

use super::CharacterDef;
use super::figure::Scratch;
use super::get_up::Choice;
use super::limp::Stillness;
use super::physique::Physique;
use crate::character::tuning::{PREPARES_HALF_LIFE, ROLL_HERTZ, ROLL_STRENGTH, TIME_TO_PULL, TIME_TO_ROLL};
use crate::drive::{DriveMode, Muscle, Pin};
use sinew_math::Rotation;
use sinew_physics::{Velocity, World};

/// A body that is driven to the start of a clip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Preparing {
    pub stillness: Stillness,
    /// Index of the get-up clip in [`Moves::get_ups`](super::moves::Moves::get_ups).
    pub get_up: u32,
    /// Index of the start in [`GetUp::starts`](super::moves::GetUp::starts).
    pub start: u32,
    /// Remaining seconds.
    pub seconds: f32,
}

/// Largest rotation of the trunk from the start of its clip, radians, and largest mean distance of the joints, as a
/// share of body height, at which a body gets up without being driven to the start.
const AT_ONCE: [f32; 2] = [0.85, 0.16];
/// Largest rotation and distance, in the same units, at which a body that was driven counts as at the start.
const NEAR_ENOUGH: [f32; 2] = [0.7, 0.14];
/// Muscle that drives the limbs.
const PULL: Muscle = Muscle { hertz: 2.0, damping_ratio: 1.0, strength: 0.6 };

impl Preparing {
    /// Starts to drive a body toward the chosen start of a clip; `rolls` is true if the trunk must be rolled over.
    pub fn toward(def: &CharacterDef, choice: &Choice<'_>, rolls: bool, stillness: Stillness) -> Self {
        let index = |at: Option<usize>| at.unwrap_or_default() as u32;
        let get_ups = &def.moves().get_ups;
        Self {
            stillness,
            get_up: index(get_ups.iter().position(|get_up| core::ptr::eq(get_up, choice.get_up))),
            start: index(choice.get_up.starts.iter().position(|start| core::ptr::eq(start, choice.start))),
            seconds: if rolls { TIME_TO_ROLL } else { TIME_TO_PULL },
        }
    }
}

impl Choice<'_> {
    /// Returns true if a body whose pelvis has this rotation may get up without being driven.
    pub fn is_near(&self, def: &CharacterDef, pelvis: Rotation) -> bool {
        self.is_like(def, pelvis, AT_ONCE)
    }

    /// Returns true if a body that was driven is near enough to the start of the clip.
    pub fn is_reached(&self, def: &CharacterDef, pelvis: Rotation) -> bool {
        self.is_like(def, pelvis, NEAR_ENOUGH)
    }

    /// Returns true if the trunk must be rolled over.
    pub fn rolls(&self, pelvis: Rotation) -> bool {
        self.trunk_off(pelvis) > AT_ONCE[0]
    }

    fn is_like(&self, def: &CharacterDef, pelvis: Rotation, [trunk, joints]: [f32; 2]) -> bool {
        let joints_off = self.pose_similarity.distance / def.ragdoll.height;
        self.trunk_off(pelvis) < trunk && joints_off < joints
    }

    /// Returns the angle between the pelvis and the pelvis of the clip, radians.
    fn trunk_off(&self, pelvis: Rotation) -> f32 {
        (self.pose_similarity.motion.rotation * self.start.stance.pelvis).angle_to(pelvis)
    }
}

/// Sets the drives that move a body to the start of a clip; `rolls` is true if the trunk must be rolled over.
pub(super) fn set_drives(def: &CharacterDef, rolls: bool, physique: &mut Physique, world: &World) {
    physique.drives.set_all(DriveMode::Powered(PULL), PREPARES_HALF_LIFE);
    if !rolls {
        return;
    }
    let gravity = world.def().gravity.length();
    let max_torque = ROLL_STRENGTH * def.ragdoll.total_mass * gravity * def.ragdoll.height;
    let pin = Pin { hertz: ROLL_HERTZ, damping_ratio: 1.0, max_force: 0.0, max_torque };
    for body in def.moves().landmarks.trunk_bodies() {
        physique.drives.set(body, DriveMode::Pinned(PULL, pin), PREPARES_HALF_LIFE);
    }
}

/// Drives the bodies toward the start of the clip, at their current position, for the next step.
pub(super) fn draw(
    def: &CharacterDef,
    choice: &Choice<'_>,
    physique: &mut Physique,
    scratch: &mut Scratch,
    world: &mut World,
) {
    let (targets, place) = (&mut scratch.before, choice.pose_similarity.motion);
    targets.clear();
    targets.extend(choice.start.bodies.iter().map(|&body| place * body));
    scratch.velocities.clear();
    scratch.velocities.resize(targets.len(), Velocity::default());
    physique.drive(def, targets, &scratch.velocities, world);
}
