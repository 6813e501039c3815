//! Inverse kinematics: rotates joints so that a hand, a foot or the eyes reach a goal.
//!
//! The functions work on two slices of one pose, as long as the rig has joints: **local** (each joint relative to
//! its parent, file units) and **model** (each joint in the space). Both must correspond
//! ([`local_to_model`](crate::local_to_model)) and still correspond afterwards. Targets, directions and heights
//! are in the space and unit of the model slice. Angles are radians. No function allocates.

mod foot;
mod look_at;
mod two_bone;

pub use foot::{FootGround, FootPlacement, PlacedFeet, PlacedFoot, hold_feet, place_feet};
pub use look_at::{Look, LookAt, look_at};
pub use two_bone::{Pole, TwoBone, TwoBoneGoal, TwoBoneSolution, solve_two_bone, two_bone_ik};

use crate::rig::{JointIdx, LocalTransform, Rig};
use sinew_math::{Affine, Rotation, Vec3, inverse3};

/// Returns the map that the local transform of a joint is relative to.
fn parent_model(rig: &Rig, joint: JointIdx, local: &[LocalTransform], model: &[Affine]) -> Affine {
    // For a root, the space itself: the difference of the root's two transforms.
    rig.joints[joint].parent.map_or_else(|| model[joint] * local[joint].to_affine().inverse(), |p| model[p])
}

/// Updates the model pose from `joint` on; parents come first, so one pass suffices.
fn update_from(rig: &Rig, joint: JointIdx, parent: &Affine, local: &[LocalTransform], model: &mut [Affine]) {
    model[joint] = *parent * local[joint].to_affine();
    for i in joint + 1..model.len() {
        if let Some(p) = rig.joints[i].parent {
            model[i] = model[p] * local[i].to_affine();
        }
    }
}

/// Sets a joint's rotation to `wanted` in model space; its descendants move with it.
pub(crate) fn set_rotation(
    rig: &Rig,
    joint: JointIdx,
    wanted: Rotation,
    local: &mut [LocalTransform],
    model: &mut [Affine],
) {
    let parent = parent_model(rig, joint, local, model);
    local[joint].rotation = (parent.to_rigid().rotation.inverse() * wanted).normalize();
    update_from(rig, joint, &parent, local, model);
}

/// Rotates a joint about its origin, in model axes; its descendants move with it.
fn turn(rig: &Rig, joint: JointIdx, turn: Rotation, local: &mut [LocalTransform], model: &mut [Affine]) {
    let rotation = model[joint].to_rigid().rotation;
    set_rotation(rig, joint, turn * rotation, local, model);
}

/// Moves a joint, in model axes; its descendants move with it.
pub(crate) fn shift(
    rig: &Rig,
    joint: JointIdx,
    by: Vec3,
    local: &mut [LocalTransform],
    model: &mut [Affine],
) {
    let parent = parent_model(rig, joint, local, model);
    let step = inverse3(&parent.linear) * by;
    if step.is_finite() {
        local[joint].translation += step;
        update_from(rig, joint, &parent, local, model);
    }
}
