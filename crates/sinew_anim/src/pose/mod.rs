//! Poses as slices: local to model space, velocities from two poses, blends.
//!
//! A pose is one [`LocalTransform`] per joint of a rig, a model pose one [`Affine`] per joint. Buffers belong to the
//! caller and keep their memory from frame to frame.

mod add;
mod blend;
#[cfg(test)]
mod levels;
mod model;
mod parts;
mod quaternions;
mod soa;
mod symmetric4;

pub use blend::{BlendLayer, BlendOptions, Blender, Mask, RotationMean};
pub use model::{ModelPose, Skeleton};
pub(crate) use quaternions::Quaternions;
pub use soa::Pose;
pub(crate) use soa::{ROTATION, ROWS, SCALE, TRANSLATION};

use crate::rig::{LocalTransform, Rig};
use sinew_math::{Affine, Rotation, Vec3, clamp};

/// Returns the rest pose of the file: the nodes' own transforms.
pub fn rest_pose(rig: &Rig) -> Vec<LocalTransform> {
    rig.joints.iter().map(|joint| joint.rest).collect()
}

/// Computes the model-space transform of every joint: `root` times the chain of local transforms down to the joint.
///
/// `root` maps the file's scene to the caller's space; use the identity for the file's own space. `model` is cleared
/// and filled, one entry per joint.
///
/// # Panics
/// If `local` does not have one entry per joint of the rig.
pub fn local_to_model(rig: &Rig, local: &[LocalTransform], root: &Affine, model: &mut Vec<Affine>) {
    assert_eq!(local.len(), rig.joints.len(), "a pose has one local transform per joint");
    model.clear();
    for (joint, own) in rig.joints.iter().zip(local) {
        let parent = joint.parent.map_or(*root, |p| model[p]);
        model.push(parent * own.to_affine());
    }
}

/// Velocity of a joint's frame, model axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointVelocity {
    /// Velocity of the joint's origin, the pose's unit of length per second.
    pub linear: Vec3,
    /// Angular velocity, radians per second.
    pub angular: Vec3,
}

/// Computes the mean velocity of every joint's rigid frame between two model poses `dt` seconds apart; zero if `dt` is
/// not positive. Exact for motion at constant velocity that rotates less than half a turn in `dt`. Both poses have one
/// entry per joint, in one space and unit; `out` is cleared and filled with as many.
///
/// # Panics
/// If the poses differ in length.
pub fn joint_velocities(before: &[Affine], after: &[Affine], dt: f32, out: &mut Vec<JointVelocity>) {
    assert_eq!(before.len(), after.len(), "the poses must be of one rig");
    out.clear();
    out.extend(before.iter().zip(after).map(|(a, b)| {
        if dt.is_nan() || dt <= 0.0 {
            return JointVelocity::default();
        }
        let (a, b) = (a.to_rigid(), b.to_rigid());
        JointVelocity {
            linear: (b.translation - a.translation) / dt,
            angular: a.rotation.angular_velocity_to(b.rotation, dt),
        }
    }));
}

/// A pose and its weight in a blend.
#[derive(Clone, Copy, Debug)]
pub struct WeightedPose<'a> {
    /// One local transform per joint.
    pub pose: &'a [LocalTransform],
    /// Weight, ≥ 0; weights need not add up to 1. Negative and NaN count as 0.
    pub weight: f32,
}

/// Writes the weighted mean of any number of poses to `out`; the order of the layers does not matter beyond rounding.
/// All poses, `rest` and `out` have one local transform per joint of one rig, file units. [`Blender`] computes the same
/// for eight joints at a time, in a canonical order, to the bit.
///
/// Rotations are summed on the hemisphere of the **rest pose** and normalised once. Pairwise spherical blends would
/// depend on the order, and alignment to the first layer on the choice of that layer. If the weights sum to zero, or a
/// joint's rotations cancel, the result is the rest pose.
///
/// # Panics
/// If a pose, `rest` or `out` differ in length.
pub fn blend(rest: &[LocalTransform], layers: &[WeightedPose<'_>], out: &mut [LocalTransform]) {
    assert_eq!(rest.len(), out.len(), "a pose has one local transform per joint");
    assert!(layers.iter().all(|layer| layer.pose.len() == out.len()), "all poses are of one rig");
    let share = |layer: &WeightedPose<'_>| if layer.weight > 0.0 { layer.weight } else { 0.0 };
    let total: f32 = layers.iter().map(share).sum();
    if total <= 0.0 {
        out.copy_from_slice(rest);
        return;
    }
    for (i, target) in out.iter_mut().enumerate() {
        let mut translation = Vec3::ZERO;
        let mut scale = Vec3::ZERO;
        let mut sum = Rotation::from_xyzw(0.0, 0.0, 0.0, 0.0);
        for layer in layers {
            let (local, w) = (&layer.pose[i], share(layer) / total);
            let q = local.rotation.toward(rest[i].rotation);
            translation += local.translation * w;
            scale += local.scale * w;
            sum = Rotation::from_xyzw(sum.x + q.x * w, sum.y + q.y * w, sum.z + q.z * w, sum.w + q.w * w);
        }
        let cancelled = sum.dot(sum) < 1e-8;
        let rotation = if cancelled { rest[i].rotation } else { sum.normalize() };
        *target = LocalTransform { translation, rotation, scale };
    }
}

/// Blends two poses: `from` at `t` = 0, `to` at `t` = 1, `t` limited to 0..=1. The slices have the lengths that
/// [`blend`] requires. With [`smoothstep`] of the time for `t`, the blend suits poses less than about 120° apart;
/// [`Transition::Crossfade`](crate::Transition::Crossfade) handles any others.
///
/// # Panics
/// If the slices differ in length.
pub fn crossfade(
    rest: &[LocalTransform],
    from: &[LocalTransform],
    to: &[LocalTransform],
    t: f32,
    out: &mut [LocalTransform],
) {
    let t = clamp(t, 0.0, 1.0);
    blend(rest, &[WeightedPose { pose: from, weight: 1.0 - t }, WeightedPose { pose: to, weight: t }], out);
}

/// Ease in and out: `3x² − 2x³`, `x` limited to 0..=1; its slope is 0 at both ends.
pub fn smoothstep(x: f32) -> f32 {
    let x = clamp(x, 0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
