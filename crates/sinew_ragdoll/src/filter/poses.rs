//! Poses in which the filter tests bodies: random ones within the joint limits, and the character's clips.
//!
//! ```
//! use sinew_math::{Range, Rotation, Transform, Vec3};
//! use sinew_physics::{JointKind, Shape};
//! use sinew_ragdoll::RagdollJointDef;
//! use sinew_ragdoll::filter::poses::within_limits;
//! use sinew_ragdoll::fit::patch::Selection;
//! use sinew_ragdoll::fit::Fit;
//! use sinew_ragdoll::limits::JointPlan;
//!
//! // Thigh and shank, each 40 cm long, with a knee between them.
//! let fit = |y: f32| Fit {
//!     shape: Shape::capsule(0.15, 0.05),
//!     character_from_body: Transform::from_translation(Vec3::Y * y),
//!     error: 0.0,
//!     area: 0.0,
//!     selection: Selection::Nothing,
//! };
//! let end = |y: f32| Transform::new(Vec3::Y * y, Rotation::IDENTITY);
//! let kind = JointKind::Hinge { limit: Some(Range { lo: 0.0, hi: 2.4 }) };
//! let def = RagdollJointDef {
//!     parent: 0,
//!     child: 1,
//!     frame_parent: end(-0.2),
//!     frame_child: end(0.2),
//!     kind,
//!     friction_torque: 0.0,
//! };
//! let poses = within_limits(&[fit(0.7), fit(0.3)], &[JointPlan { def, widened: 0.0 }]);
//! for pose in &poses {
//!     assert!((pose[1].point(Vec3::Y * 0.2) - Vec3::Y * 0.5).length() < 1e-5, "the knee stays where it is");
//! }
//! ```

use crate::build::bones::Bones;
use crate::fit::Fit;
use crate::fit::surface::BindPose;
use crate::limits::JointPlan;
use crate::limits::sample::random_turn;
use sinew_anim::{Rig, Take, local_to_model};
use sinew_math::{Affine, Random, Transform, Vec3};

/// Number of poses within the limits: enough to distinguish a share of a tenth from zero.
const WITHIN_LIMITS: usize = 96;
/// Largest number of clip frames tested, with the same number from each clip.
const OF_CLIPS: usize = 256;
const SEED: u64 = 0x00F1_17E4;

/// Poses of all bodies in character space, metres, one transform per body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Poses {
    /// Poses with random joint rotations within the limits, the first body in its bind pose.
    pub within_limits: Vec<Vec<Transform>>,
    /// Poses of the character's clips.
    pub of_clips: Vec<Vec<Transform>>,
}

/// Number of clip frames that are tested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frames {
    /// All frames.
    All,
    /// At most 256 frames, the same number from each take.
    Some,
}

/// Returns poses within the limits of `plans`, the same for every build of a rig.
pub fn within_limits(fits: &[Fit], plans: &[JointPlan]) -> Vec<Vec<Transform>> {
    let mut random = Random::new(SEED);
    let bind: Vec<_> = fits.iter().map(|fit| fit.character_from_body).collect();
    let turned = |random: &mut Random| {
        let mut pose = bind.clone();
        // Parents precede their children.
        for JointPlan { def: joint, .. } in plans {
            let turn = Transform::new(Vec3::ZERO, random_turn(joint.kind, random, 1.0));
            let parent = pose[joint.parent];
            pose[joint.child] = parent * joint.frame_parent * turn * joint.frame_child.inverse();
        }
        pose
    };
    (0..WITHIN_LIMITS).map(|_| turned(&mut random)).collect()
}

/// Returns poses of frames of `takes`, without poses that are not finite.
///
/// # Panics
/// If a take does not belong to the rig.
pub fn of_clips(
    rig: &Rig,
    takes: &[Take],
    bones: &Bones,
    bind: BindPose<'_>,
    fits: &[Fit],
    frames: Frames,
) -> Vec<Vec<Transform>> {
    let (most, each) = match frames {
        Frames::All => (takes.len(), usize::MAX),
        Frames::Some => (OF_CLIPS, (OF_CLIPS / usize::max(takes.len(), 1)).max(1)),
    };
    let character = bind.character_from_file();
    let rigid = |model: &[Affine], body: usize| (character * model[bones.list[body].joint]).to_rigid();
    // A body keeps its offset from its bone in the bind pose.
    let bone_from_body: Vec<_> = (0..fits.len())
        .map(|body| rigid(bind.model, body).inverse() * fits[body].character_from_body)
        .collect();
    let mut poses = Vec::new();
    let mut model = Vec::new();
    for take in takes.iter().take(most) {
        assert_eq!(take.joints, rig.joints.len(), "the takes must belong to this rig");
        let frames = take.frames();
        let looks = usize::min(each, frames);
        for look in 0..looks {
            local_to_model(rig, take.pose(look * frames / looks), &Affine::IDENTITY, &mut model);
            let body = |body: usize| rigid(&model, body) * bone_from_body[body];
            let pose: Vec<_> = (0..fits.len()).map(body).collect();
            // Clips may scale a bone to zero; such a body overlaps nothing.
            if pose.iter().all(|body| body.is_finite()) {
                poses.push(pose);
            }
        }
    }
    poses
}
