//! Aligns boxes with their ground: a tread is level, and as high as drawn.

use super::Scale;
use super::fit::cluster;
use super::sample::MeshPoint;
use crate::boxes::Obb;
use sinew_math::{Rotation, Vec3};

/// Least height of a unit normal on which one can stand (45°).
const GROUND: f32 = 0.7;
/// A top represents points whose normals are within this cosine (11°) of its own.
const FACING: f32 = 0.98;
/// Least number of points, least share of them in one plane, and least share of all points of a box on its top, for the
/// box to be rotated.
const LEAST: usize = 4;
const IN_PLANE: f32 = 0.6;
const MOSTLY_TOP: f32 = 0.3;
/// A box is turned if its top is farther from the plane than this cosine (0.1°).
const TURNED: f32 = 0.999_998_5;

/// A box whose top lies in the plane of its ground, its bottom unchanged.
pub(super) fn settled(block: Obb, points: &[MeshPoint], scale: Scale) -> Obb {
    let (axis, up) = top(&block);
    if up.y < GROUND {
        return block;
    }
    let facing = || points.iter().filter(|point| point.normal.dot(up) > FACING);
    let count = facing().count();
    if count < LEAST {
        return block;
    }
    let normals = cluster(facing().map(|point| (point.normal, 1.0)));
    let Some(&(normal, _)) = normals.first() else { return block };
    let mut heights: Vec<f32> = facing().map(|point| point.position.dot(normal)).collect();
    heights.sort_by(f32::total_cmp);
    let height = heights[count / 2];
    let in_plane = heights.iter().filter(|other| (**other - height).abs() < scale.unseen).count();
    let turns = up.dot(normal) < TURNED;
    let is_top = count as f32 >= MOSTLY_TOP * points.len() as f32;
    if (in_plane as f32) < IN_PLANE * count as f32 || (turns && !is_top) {
        return block;
    }
    let mut laid = block;
    if turns {
        laid.rotation = (Rotation::from_arc(up, normal) * block.rotation).normalize();
    }
    let raised = height - (laid.center.dot(normal) + laid.half_extents[axis]);
    // A top far from the plane represents more than that ground.
    if raised.abs() > 2.0 * scale.tolerance || laid.half_extents[axis] + 0.5 * raised < scale.thinnest {
        return block;
    }
    laid.half_extents[axis] += 0.5 * raised;
    laid.center += normal * (0.5 * raised);
    laid
}

/// The axis that is nearest to the vertical, and its upward direction.
fn top(block: &Obb) -> (usize, Vec3) {
    let mut best = (1, block.rotation * Vec3::Y);
    for axis in [1, 0, 2] {
        let direction = block.rotation * Vec3::AXES[axis];
        let up = if direction.y < 0.0 { -direction } else { direction };
        if up.y > best.1.y {
            best = (axis, up);
        }
    }
    best
}
