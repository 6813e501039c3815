//! A pose of an actor that tells the body from the motion.

use crate::clip::Clip;
use crate::clip::sample::{Wrap, sample};
use crate::pose::rest_pose;
use crate::rig::{LocalTransform, Rig};
use crate::roles::{NoSkin, RigAnalysis, Role, Side, analyze_skeleton};
use crate::tuning::CLEARLY_STANDING;
use sinew_math::{Vec3, direction};

/// Source of a reference pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reference {
    /// It was given: the rest pose that a file puts before its motion.
    Stated,
    /// The rig's rest pose.
    Rest,
    /// The clip, at that time (seconds): the rig's rest pose is none that a body can stand in.
    Clip(f32),
}

/// Frames of a clip that are looked at.
const LOOKS: usize = 24;

/// Analyses a skeleton without skin in the pose in which it stands best: the one stated (if any), else the rig's rest pose,
/// else the most upright frame of the clip. Many capture files have a rest pose that is no pose at all.
///
/// # Errors
/// [`NoSkin`] if no bone has a length.
///
/// # Panics
/// If `stated` is not as long as the rig has joints, and as [`sample`](crate::clip::sample::sample()).
pub fn stand(
    rig: &Rig,
    clip: &Clip,
    stated: Option<&[LocalTransform]>,
) -> Result<(RigAnalysis, Reference), NoSkin> {
    let mut best: Option<(f32, RigAnalysis, Reference)> = None;
    let times = (0..LOOKS).map(|k| clip.duration * k as f32 / LOOKS as f32);
    let poses = stated
        .map(|pose| (pose.to_vec(), Reference::Stated))
        .into_iter()
        .chain(core::iter::once((rest_pose(rig), Reference::Rest)))
        .chain(times.map(|time| {
            let mut pose = rest_pose(rig);
            sample(clip, rig, time, Wrap::Clamp, &mut pose);
            (pose, Reference::Clip(time))
        }));
    for (pose, reference) in poses {
        let analysis = analyze_skeleton(rig, &pose)?;
        let upright = uprightness(&analysis);
        if best.as_ref().is_none_or(|(most, ..)| upright > *most) {
            best = Some((upright, analysis, reference));
        }
        if upright > CLEARLY_STANDING {
            break;
        }
    }
    best.map(|(_, analysis, reference)| (analysis, reference)).ok_or(NoSkin)
}

/// Uprightness of a body: the least cosine of trunk, thighs and shanks with the vertical; −1 for what is no humanoid.
fn uprightness(analysis: &RigAnalysis) -> f32 {
    let place = |role: Role| analysis.joint_with(role).map(|joint| analysis.bind_model[joint].translation);
    let up = analysis.up_axis;
    let along = |low: Role, high: Role| -> Option<f32> {
        let way: Vec3 = place(high)? - place(low)?;
        Some(direction(way)?.dot(up))
    };
    let legs = [Side::Left, Side::Right].into_iter().flat_map(|side| {
        [(Role::LowerLeg(side), Role::UpperLeg(side)), (Role::Foot(side), Role::LowerLeg(side))]
    });
    let bones = core::iter::once((Role::Hips, Role::Head)).chain(legs);
    if !analysis.humanoid {
        return -1.0;
    }
    bones.map(|(low, high)| along(low, high).unwrap_or(-1.0)).fold(1.0, sinew_math::min)
}
