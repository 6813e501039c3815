//! Joints of the mannequin: names, parents, and positions in the bind pose.
//!
//! Metres, +Y up, facing +Z, left is +X. Every joint's rest rotation is the identity, so a local rotation is the
//! rotation from the bind pose about the world's axes. Segment lengths are those of de Leva 1996 (J. Biomechanics 29)
//! for a man of 1.741 m, joint heights rounded for 1.75 m.

use crate::anim::{Joint, JointIdx, LocalTransform, Rig, Skin};
use crate::math::{Affine, Rotation, Vec3, trig};

/// A joint of the mannequin. The number is its index in the rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub(super) enum Bone {
    Root,
    Hips,
    Spine,
    Chest,
    Neck,
    Head,
    LeftShoulder,
    LeftUpperArm,
    LeftLowerArm,
    LeftHand,
    LeftUpperLeg,
    LeftLowerLeg,
    LeftFoot,
    LeftToes,
    RightShoulder,
    RightUpperArm,
    RightLowerArm,
    RightHand,
    RightUpperLeg,
    RightLowerLeg,
    RightFoot,
    RightToes,
}

use Bone::*;

/// Name (VRM 1 bone names except for the root) and parent, in index order.
const JOINTS: [(Bone, &str, Option<Bone>); Bone::COUNT] = [
    (Root, "mannequin", None),
    (Hips, "hips", Some(Root)),
    (Spine, "spine", Some(Hips)),
    (Chest, "chest", Some(Spine)),
    (Neck, "neck", Some(Chest)),
    (Head, "head", Some(Neck)),
    (LeftShoulder, "leftShoulder", Some(Chest)),
    (LeftUpperArm, "leftUpperArm", Some(LeftShoulder)),
    (LeftLowerArm, "leftLowerArm", Some(LeftUpperArm)),
    (LeftHand, "leftHand", Some(LeftLowerArm)),
    (LeftUpperLeg, "leftUpperLeg", Some(Hips)),
    (LeftLowerLeg, "leftLowerLeg", Some(LeftUpperLeg)),
    (LeftFoot, "leftFoot", Some(LeftLowerLeg)),
    (LeftToes, "leftToes", Some(LeftFoot)),
    (RightShoulder, "rightShoulder", Some(Chest)),
    (RightUpperArm, "rightUpperArm", Some(RightShoulder)),
    (RightLowerArm, "rightLowerArm", Some(RightUpperArm)),
    (RightHand, "rightHand", Some(RightLowerArm)),
    (RightUpperLeg, "rightUpperLeg", Some(Hips)),
    (RightLowerLeg, "rightLowerLeg", Some(RightUpperLeg)),
    (RightFoot, "rightFoot", Some(RightLowerLeg)),
    (RightToes, "rightToes", Some(RightFoot)),
];

impl Bone {
    pub(super) const COUNT: usize = 22;
    /// Index offset of right-side joints from their left counterparts in the order above.
    const MIRROR_STEP: usize = 8;

    pub(super) fn index(self) -> JointIdx {
        self as JointIdx
    }

    /// Returns the joint at an index of the rig.
    pub(super) fn from_index(index: JointIdx) -> Self {
        JOINTS[index].0
    }

    /// Returns the same joint on the other side, or `self` on the midline.
    pub(super) fn mirrored(self) -> Self {
        let index = self.index();
        match index {
            0..6 => self,
            6..14 => JOINTS[index + Self::MIRROR_STEP].0,
            _ => JOINTS[index - Self::MIRROR_STEP].0,
        }
    }

    pub(super) fn parent(self) -> Option<Self> {
        JOINTS[self.index()].2
    }

    /// Iterates over all joints, parents first.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        JOINTS.iter().map(|&(bone, ..)| bone)
    }

    /// Returns this joint on the given side; `self` is the left joint.
    pub(super) fn on(self, side: Side) -> Self {
        if side == Side::Left { self } else { self.mirrored() }
    }
}

/// Side of the body; left is +X.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
}

impl Side {
    pub(super) const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// +1 on the left, −1 on the right.
    pub(super) fn sign(self) -> f32 {
        if self == Self::Left { 1.0 } else { -1.0 }
    }

    /// Mirrors a left-side vector to this side.
    pub(super) fn vector(self, left: Vec3) -> Vec3 {
        Vec3::new(left.x * self.sign(), left.y, left.z)
    }
}

/// Distance from the shoulder joint to the elbow, metres (de Leva 1996).
pub(super) const UPPER_ARM: f32 = 0.2817;
/// Distance from the elbow to the wrist, metres (de Leva 1996).
pub(super) const FOREARM: f32 = 0.2689;
/// Angle by which the arms of the A-pose hang below the horizontal, radians (40°).
pub(super) const ARM_DROP: f32 = 0.698_131_7;
/// Bend of the elbow in the bind pose, radians (8°): defines the bending direction for rig analysers.
pub(super) const ELBOW_REST: f32 = 0.139_626_3;
/// Height of the hips joint above the hip joints, metres.
pub(super) const HIPS_ABOVE_HIP: f32 = 0.03;
/// Height of the ankle above the sole, metres.
pub(super) const ANKLE_HEIGHT: f32 = 0.08;

/// The three axes of the left arm's bind pose: along the upper arm, along the forearm, and out of the palm.
pub(super) struct ArmAxes {
    pub(super) upper: Vec3,
    pub(super) fore: Vec3,
    pub(super) palm: Vec3,
}

/// Returns the left arm in the A-pose. With hanging arms the palms face the thighs, thumbs point forward, elbows bend
/// forward.
pub(super) fn left_arm_axes() -> ArmAxes {
    let (sin, cos) = trig::sin_cos(ARM_DROP);
    let upper = Vec3::new(cos, -sin, 0.0);
    let (bend_sin, bend_cos) = trig::sin_cos(ELBOW_REST);
    ArmAxes { upper, fore: upper * bend_cos + Vec3::Z * bend_sin, palm: Vec3::new(-sin, -cos, 0.0) }
}

/// Bind position of a joint, metres.
pub(super) fn bind_position(bone: Bone) -> Vec3 {
    let shoulder = Vec3::new(0.178, 1.415, -0.012);
    match bone {
        Root => Vec3::ZERO,
        Hips => Vec3::new(0.0, 0.92 + HIPS_ABOVE_HIP, 0.0),
        Spine => Vec3::new(0.0, 1.045, -0.005),
        Chest => Vec3::new(0.0, 1.18, -0.012),
        Neck => Vec3::new(0.0, 1.465, -0.018),
        Head => Vec3::new(0.0, 1.56, -0.002),
        LeftShoulder => Vec3::new(0.035, 1.42, -0.005),
        LeftUpperArm => shoulder,
        LeftLowerArm => shoulder + left_arm_axes().upper * UPPER_ARM,
        LeftHand => bind_position(LeftLowerArm) + left_arm_axes().fore * FOREARM,
        LeftUpperLeg => Vec3::new(0.09, 0.92, 0.0),
        LeftLowerLeg => Vec3::new(0.09, 0.49, 0.01),
        LeftFoot => Vec3::new(0.09, ANKLE_HEIGHT, -0.01),
        LeftToes => Vec3::new(0.09, 0.024, 0.125),
        right => Side::Right.vector(bind_position(right.mirrored())),
    }
}

/// Bind position relative to the parent.
pub(super) fn bind_offset(bone: Bone) -> Vec3 {
    let origin = bone.parent().map_or(Vec3::ZERO, bind_position);
    bind_position(bone) - origin
}

/// Returns the rig's joints and its one skin, without a mesh. Skin slot = joint index − 1: the root moves no vertex.
pub(super) fn skeleton() -> Rig {
    let joints = JOINTS
        .iter()
        .map(|&(bone, name, parent)| Joint {
            name: name.to_owned(),
            parent: parent.map(Bone::index),
            rest: LocalTransform {
                translation: bind_offset(bone),
                rotation: Rotation::IDENTITY,
                scale: Vec3::ONE,
            },
            source: bone.index(),
        })
        .collect();
    let bones = || Bone::all().skip(1);
    let skin = Skin {
        name: "mannequin".to_owned(),
        joints: bones().map(Bone::index).collect(),
        inverse_bind: bones()
            .map(|bone| Affine { translation: -bind_position(bone), ..Affine::IDENTITY })
            .collect(),
    };
    Rig { joints, skins: vec![skin], ..Rig::default() }
}
