//! Boxes and hulls around skin.

use super::patch::{Patch, bounds};
use super::{Fit, LEAST_HALF, SHRINK, clip_at_joints, measured};
use crate::build::bones::Bones;
use crate::build::part::Part;
use crate::fit::frame::{box_frame, with_y};
use crate::tuning::TOWARD_CORNERS;
use sinew_math::{Rotation, Transform, Vec3, clamp, max3, min3};
use sinew_physics::{Hull, Shape};
use std::sync::Arc;

const ASKEW: Vec3 = Vec3::new(1e-4, 6e-5, 3e-5);

pub(super) fn fit_box(bones: &Bones, bone: usize, patch: &Patch) -> Fit {
    let mut direction = bones.direction(bone, Some(patch.center));
    if bones.list[bone].part == Part::Foot {
        // A foot is long from heel to toes, although its bone slopes down to them.
        direction.y = 0.0;
    }
    let axes = with_y(box_frame(bones, bone, patch), direction);
    // Use the whole length of props, because the last hundredth of a sword is its point.
    let shares = if bones.list[bone].is_prop { [0.0, 1.0] } else { [0.01, 0.99] };
    let extent = |axis: Vec3| patch.quantiles(shares, |p| (p - patch.center).dot(axis));
    let ([x_lo, x_hi], [z_lo, z_hi]) = (extent(axes.x_axis), extent(axes.z_axis));
    let [y_lo, y_hi] = extent(axes.y_axis);
    let (y_lo, y_hi) = clip_at_joints(bones, bone, patch.center, axes.y_axis, y_lo, y_hi);
    let lo = Vec3::new(x_lo, y_lo, z_lo);
    let hi = Vec3::new(x_hi, y_hi, z_hi);
    let half_extents = max3((hi - lo) * (0.5 * SHRINK), Vec3::splat(LEAST_HALF));
    let middle = patch.center + axes * ((lo + hi) * 0.5);
    let frame = Transform::new(middle, Rotation::from_mat3(&axes));
    measured(Shape::Box { half_extents }, frame, patch)
}

/// Returns the hull of the outermost points along 26 directions (the faces, edges and corners of the part's box),
/// clipped to the box so that it ends at the joints like the box. `None` if the points have no hull.
pub(super) fn fit_hull(cuboid: &Fit, patch: &Patch) -> Option<Fit> {
    let Shape::Box { half_extents: half } = cuboid.shape else { return None };
    hull_of(cuboid, patch, |point| max3(min3(point, half), -half))
}

/// Like [`fit_hull`], but not clipped to the box; `within` first moves each point of the skin, in character space.
pub(super) fn fit_whole_hull(cuboid: &Fit, patch: &Patch, within: impl Fn(Vec3) -> Vec3) -> Option<Fit> {
    let frame = cuboid.character_from_body;
    hull_of(cuboid, patch, |point| frame.inverse_point(within(frame.point(point))))
}

/// Moves a point of the skin beyond one of the bone's joints along the bone to the end of its part.
pub(super) fn within_joints(
    bones: &Bones,
    bone: usize,
    patch: &Patch,
    cuboid: &Fit,
) -> impl Fn(Vec3) -> Vec3 {
    let axis = cuboid.character_from_body.rotation * Vec3::Y;
    let center = patch.center;
    let (lo, hi) = bounds(&patch.samples, |point| (point - center).dot(axis));
    let (lo, hi) = clip_at_joints(bones, bone, center, axis, lo, hi);
    move |point| {
        let along = (point - center).dot(axis);
        point + axis * (clamp(along, lo, hi) - along)
    }
}

fn hull_of(cuboid: &Fit, patch: &Patch, within: impl Fn(Vec3) -> Vec3) -> Option<Fit> {
    let Shape::Box { half_extents: half } = cuboid.shape else { return None };
    let frame = cuboid.character_from_body;
    let local: Vec<_> = patch.samples.iter().map(|s| within(frame.inverse_point(s.point))).collect();
    let mut points = Vec::with_capacity(26);
    for direction in directions() {
        let toward = direction + ASKEW;
        let out = |point: Vec3| {
            let share = point / half;
            share.dot(toward) + TOWARD_CORNERS * share.dot(share)
        };
        let outermost = local.iter().copied().reduce(|a, b| if out(b) > out(a) { b } else { a });
        points.extend(outermost.map(|p| p * SHRINK));
    }
    // The body's origin is the centre of its shape.
    let center = Hull::new(&points).ok()?.center();
    points.iter_mut().for_each(|point| *point -= center);
    let hull = Hull::new(&points).ok()?;
    let frame = Transform::new(frame.point(center), frame.rotation);
    Some(measured(Shape::Hull(Arc::new(hull)), frame, patch))
}

/// Returns the directions toward the faces, edges and corners of a cube.
fn directions() -> impl Iterator<Item = Vec3> {
    let side = |k: i32| (k - 1) as f32;
    (0..27).map(move |k| Vec3::new(side(k % 3), side(k / 3 % 3), side(k / 9))).filter(|d| *d != Vec3::ZERO)
}
