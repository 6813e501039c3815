//! Turns a head or an eye toward a target, within limits.

use super::turn;
use crate::rig::{JointIdx, LocalTransform, Rig};
use sinew_math::{Affine, Rotation, Vec3, any_orthonormal, clamp, direction, max};

/// A joint that looks at a target, and its limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookAt {
    /// The joint that turns about its origin.
    pub joint: JointIdx,
    /// Looking direction, in the joint's own axes, any length.
    pub forward: Vec3,
    /// Yaw axis: up in the axes of the space, any length.
    pub up: Vec3,
    /// Target position in the space of `model`, in its unit.
    pub target: Vec3,
    /// Largest yaw from the pose, radians, 0..=π.
    pub max_yaw: f32,
    /// Largest pitch from the pose, radians, 0..=π. Yaw and pitch together are limited by an ellipse.
    pub max_pitch: f32,
    /// Weight of the goal, 0..=1: the share of the rotation that is applied. For a look by several joints (chest, neck,
    /// head), give each a weight.
    pub weight: f32,
}

/// Result of [`look_at`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Angle by which the joint turned, radians.
    pub turned: f32,
    /// Remaining angle to the target, radians.
    pub left: f32,
}

/// Turns a joint toward a target. `local` and `model` have one entry per joint; both are updated. A target at the joint
/// itself, a target that is not finite, and a zero `forward` have no effect.
///
/// # Panics
/// If a slice does not have one entry per joint of the rig, or the joint is not in the rig.
pub fn look_at(rig: &Rig, look: &LookAt, local: &mut [LocalTransform], model: &mut [Affine]) -> Look {
    assert_eq!(
        (local.len(), model.len()),
        (rig.joints.len(), rig.joints.len()),
        "the poses must be of one rig"
    );
    let place = &model[look.joint];
    let (forward, wanted) =
        (direction(place.vector(look.forward)), direction(look.target - place.translation));
    let Some((forward, wanted)) = forward.zip(wanted) else { return Look { turned: 0.0, left: 0.0 } };
    let whole = Rotation::from_arc(forward, wanted).to_scaled_axis();
    let side = direction(look.up.cross(forward)).unwrap_or_else(|| any_orthonormal(forward));
    let share = |angle: f32, most: f32| if angle.abs() > 0.0 { angle.abs() / max(most, 1e-6) } else { 0.0 };
    let (yaw, pitch) =
        (share(whole.dot(forward.cross(side)), look.max_yaw), share(whole.dot(side), look.max_pitch));
    let allowed = whole / max((yaw * yaw + pitch * pitch).sqrt(), 1.0);
    let taken = allowed * clamp(look.weight, 0.0, 1.0);
    let turned = Rotation::from_scaled_axis(taken);
    turn(rig, look.joint, turned, local, model);
    let left = Rotation::from_arc(turned * forward, wanted).to_scaled_axis().length();
    Look { turned: taken.length(), left }
}
