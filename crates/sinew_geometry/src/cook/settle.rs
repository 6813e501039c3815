//! Aligns the tops of boxes with the walkable ground that they represent: treads stay level and keep their height.

use super::Scale;
use super::fit::cluster;
use super::sample::MeshPoint;
use crate::boxes::Obb;
use sinew_math::{Rotation, Vec3};

/// Least vertical component of the unit normal of walkable ground (45°).
const GROUND: f32 = 0.7;
/// Least cosine (11°) between a point's normal and the top's normal for the top to represent the point.
const FACING: f32 = 0.98;
/// A box is rotated only if it has this number of points on its top, this share of them in one plane, and this share of
/// all its points on its top.
const LEAST: usize = 4;
const IN_PLANE: f32 = 0.6;
const MOSTLY_TOP: f32 = 0.3;
/// Cosine (0.1°) between the top and the plane below which the box is rotated.
const TURNED: f32 = 0.999_998_5;

/// Returns the box with its top in the plane of its ground and its bottom unchanged.
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
    // If the top is far from the plane, the box represents more than this ground, so it stays as it is.
    if raised.abs() > 2.0 * scale.tolerance || laid.half_extents[axis] + 0.5 * raised < scale.thinnest {
        return block;
    }
    laid.half_extents[axis] += 0.5 * raised;
    laid.center += normal * (0.5 * raised);
    laid
}

/// Returns the axis of the box nearest to the vertical, and its upward direction.
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
