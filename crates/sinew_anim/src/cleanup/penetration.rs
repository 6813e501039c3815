//! Bodies lifted out of the floor.

use super::smooth_above;
use crate::contact::{Foot, lowest};
use crate::ik::shift;
use crate::pose::local_to_model;
use crate::rig::{JointIdx, Rig};
use crate::take::Take;
use sinew_math::{Affine, Vec3, max, min};

/// What was in the floor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PenetrationReport {
    /// In how many frames.
    pub frames: usize,
    /// How deep at most, metres.
    pub deepest: f32,
    /// Most that the body was raised, metres: no less than `deepest`.
    pub raised: f32,
}

/// Raises the whole body, by its joint `pelvis`, where a sole or a joint is below `floor` (metres, in the space that
/// `root` maps the rig's to, y up), smoothly over `blend` seconds before and after.
///
/// # Panics
/// If the take is not one of the rig's.
pub fn remove_penetration(
    rig: &Rig,
    root: &Affine,
    pelvis: JointIdx,
    feet: &[Foot; 2],
    floor: f32,
    blend: f32,
    take: &mut Take,
) -> PenetrationReport {
    let mut model = Vec::new();
    let mut depth = Vec::new();
    for frame in 0..take.frames() {
        local_to_model(rig, take.pose(frame), root, &mut model);
        let soles = lowest(&feet.each_ref().map(|foot| foot.points(&model)));
        let low = model[pelvis..].iter().map(|joint| joint.translation.y).fold(soles, min);
        depth.push(max(floor - low, 0.0));
    }
    let lift = smooth_above(&depth, take.frames_in(blend));
    for (frame, &lift) in lift.iter().enumerate().filter(|(_, lift)| **lift > 0.0) {
        local_to_model(rig, take.pose(frame), root, &mut model);
        shift(rig, pelvis, Vec3::Y * lift, take.pose_mut(frame), &mut model);
    }
    PenetrationReport {
        frames: depth.iter().filter(|&&depth| depth > 1e-5).count(),
        deepest: depth.into_iter().fold(0.0, max),
        raised: lift.into_iter().fold(0.0, max),
    }
}
