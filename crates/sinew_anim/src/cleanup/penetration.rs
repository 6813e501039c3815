//! Lifts a body out of the floor.

use super::smooth_above;
use crate::clip::take::Take;
use crate::contact::lowest;
use crate::legs::Legs;
use crate::pose::local_to_model;
use crate::rig::{JointIdx, Rig};
use sinew_math::{Affine, Vec3, max, min};

/// Result of raising a body out of the floor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PenetrationReport {
    /// Number of frames in which the body was raised.
    pub frames: usize,
    /// Largest depth below the floor, metres.
    pub deepest: f32,
    /// Largest height by which the body was raised, metres; at least `deepest`.
    pub raised: f32,
}

/// Raises the whole body where a sole, or a joint below the pelvis, is below `floor` (metres, in the space of `root`, y
/// up), smoothly over `blend` seconds before and after.
///
/// # Panics
/// If the take does not fit the rig.
pub fn remove_penetration(
    rig: &Rig,
    root: &Affine,
    legs: &Legs,
    floor: f32,
    blend: f32,
    take: &mut Take,
) -> PenetrationReport {
    let body = below(rig, legs.pelvis);
    let mut model = Vec::new();
    let mut depth = Vec::new();
    for frame in 0..take.frames() {
        local_to_model(rig, take.pose(frame), root, &mut model);
        let soles = lowest(&legs.feet.each_ref().map(|foot| foot.points(&model)));
        let low = body.iter().map(|&joint| model[joint].translation.y).fold(soles, min);
        depth.push(max(floor - low, 0.0));
    }
    raise(rig, root, legs, &depth, blend, take)
}

/// Raises the whole body by at least `least` in each frame (metres, in the space of `root`, y up; 0 or more), smoothly
/// over `blend` seconds before and after.
///
/// # Panics
/// If the take does not fit the rig, or `least` does not have one entry per frame.
pub fn raise(
    rig: &Rig,
    root: &Affine,
    legs: &Legs,
    least: &[f32],
    blend: f32,
    take: &mut Take,
) -> PenetrationReport {
    assert_eq!(least.len(), take.frames(), "a number for each frame");
    let lift = smooth_above(least, take.frames_in(blend));
    let mut model = Vec::new();
    for (frame, &lift) in lift.iter().enumerate().filter(|(_, lift)| **lift > 0.0) {
        local_to_model(rig, take.pose(frame), root, &mut model);
        legs.carry(rig, Vec3::Y * lift, take.pose_mut(frame), &mut model);
    }
    PenetrationReport {
        frames: least.iter().filter(|&&depth| depth > 1e-5).count(),
        deepest: least.iter().copied().fold(0.0, max),
        raised: lift.into_iter().fold(0.0, max),
    }
}

/// Returns a joint and all its descendants.
fn below(rig: &Rig, top: JointIdx) -> Vec<JointIdx> {
    let mut hangs = vec![false; rig.joints.len()];
    hangs[top] = true;
    for (i, joint) in rig.joints.iter().enumerate() {
        hangs[i] |= joint.parent.is_some_and(|parent| hangs[parent]);
    }
    (0..hangs.len()).filter(|&i| hangs[i]).collect()
}
