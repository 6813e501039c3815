//! Chooses an actor's reference pose.

use crate::clip::Clip;
use crate::clip::sample::{Wrap, sample};
use crate::pose::rest_pose;
use crate::rig::{LocalTransform, Rig};
use crate::roles::{NoSkin, RigAnalysis, Role, Side, analyze_skeleton};
use crate::tuning::{CLEARLY_STANDING, STANDS_IN_CLIP};
use sinew_math::{Vec3, direction};

/// Source of a reference pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reference {
    /// A given pose: the rest pose before the motion in a file.
    Stated,
    /// The rest pose of the rig.
    Rest,
    /// The clip at this time (seconds), because the rig's rest pose is not a standing pose.
    Clip(f32),
}

/// Number of frames that are examined in a clip.
const LOOKS: usize = 24;

/// Analyses a skeleton without skin in its best standing pose: the stated one (if any), else the rig's rest pose, else
/// the most upright frame of the clip. The rest pose of many capture files does not stand, or stands along another
/// axis than the clip; then a frame of the clip is used.
///
/// # Errors
/// [`NoSkin`] if no bone has a length.
///
/// # Panics
/// If `stated` does not have one entry per joint of the rig, and as [`sample`](crate::clip::sample::sample()).
pub fn stand(
    rig: &Rig,
    clip: &Clip,
    stated: Option<&[LocalTransform]>,
) -> Result<(RigAnalysis, Reference), NoSkin> {
    let at_rest = stated
        .map(|pose| (pose.to_vec(), Reference::Stated))
        .into_iter()
        .chain([(rest_pose(rig), Reference::Rest)]);
    let in_clip = (0..LOOKS).map(|k| {
        let time = clip.duration * k as f32 / LOOKS as f32;
        let mut pose = rest_pose(rig);
        sample(clip, rig, time, Wrap::Clamp, &mut pose);
        (pose, Reference::Clip(time))
    });
    let moves_along = up_in_clip(rig, in_clip.clone().map(|(pose, _)| pose));
    let mut best: Option<(f32, RigAnalysis, Reference)> = None;
    for (pose, reference) in at_rest.chain(in_clip) {
        let analysis = analyze_skeleton(rig, &pose)?;
        // Poses that stand along another axis than the clip's come last.
        let is_other = moves_along.is_some_and(|up| up.dot(analysis.up_axis) < 0.5);
        let upright = if is_other { f32::NEG_INFINITY } else { uprightness(&analysis) };
        if best.as_ref().is_none_or(|(most, ..)| upright > *most) {
            best = Some((upright, analysis, reference));
        }
        if upright > CLEARLY_STANDING {
            break;
        }
    }
    best.map(|(_, analysis, reference)| (analysis, reference)).ok_or(NoSkin)
}

/// Returns the up axis of most of the standing poses; `None` if none stands.
fn up_in_clip(rig: &Rig, poses: impl Iterator<Item = Vec<LocalTransform>>) -> Option<Vec3> {
    let mut standing: Vec<Vec3> = Vec::new();
    for pose in poses {
        let analysis = analyze_skeleton(rig, &pose).ok()?;
        if uprightness(&analysis) > STANDS_IN_CLIP {
            standing.push(analysis.up_axis);
        }
    }
    let alike = |up: &&Vec3| standing.iter().filter(|other| up.dot(**other) > 0.9).count();
    standing.iter().max_by_key(alike).filter(|up| 2 * alike(up) > LOOKS).copied()
}

/// Uprightness: the smallest cosine of trunk, thighs and shanks with the vertical; −1 for other bodies.
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
