//! Axes of a shape, from the skin that it represents.
//!
//! ```
//! use sinew_math::{Mat3, Vec3};
//! use sinew_ragdoll::fit::frame::with_y;
//!
//! // The same three axes, with y along an upper arm that points to the left.
//! let frame = with_y(Mat3::IDENTITY, Vec3::new(0.9, -0.1, 0.0));
//! assert_eq!(frame.y_axis, Vec3::X);
//! assert_eq!(frame.z_axis, Vec3::Z);
//! assert!((frame.determinant() - 1.0).abs() < 1e-6);
//! ```

use crate::build::bones::{Anatomy, Bones};
use crate::build::part::Part;
use crate::fit::patch::{Patch, bounds};
use crate::fit::rectangle::{least_rectangle, rectangle_area};
use crate::tuning::{ALONG_BONE, CLEARLY_SMALLER, ELONGATED, WORTH_TILTING};
use sinew_math::{Mat3, Vec2, Vec3, any_orthonormal, normalize_or};

/// Returns the unit vector along the flesh of a bone, pointing away from its joint.
///
/// The result is the direction to the next joints if the surface's long axis agrees with it, otherwise this axis. If
/// the surface has no long axis (a head), the result is the direction from the joint to the centre of the surface.
pub fn long_axis(bones: &Bones, bone: usize, patch: &Patch) -> Vec3 {
    let mut direction = bones.direction(bone, Some(patch.center));
    if bones.is_central(bone) {
        direction = normalize_or(Vec3::new(0.0, direction.y, direction.z), Vec3::Y);
    }
    let (variance, axes) = patch.covariance.eigen();
    let along = axes * Vec3::X;
    let along = if along.dot(direction) < 0.0 { -along } else { along };
    let elongated = variance.x > ELONGATED * variance.y;
    let agrees = along.dot(direction) > ALONG_BONE && bones.tail(bone).is_some();
    // The trunk is often wider than high; a capsule must then follow the direction to the next joint.
    if !elongated || agrees || bones.is_central(bone) { direction } else { along }
}

/// Returns the axes of a box around a bone's skin: columns, right-handed, in any order and sign.
pub fn box_frame(bones: &Bones, bone: usize, patch: &Patch) -> Mat3 {
    if bones.is_central(bone) {
        // The skin is symmetric in x, so x is one of the axes and only the rotation about x is unknown. The axis of a
        // human's trunk is vertical; that of a creature's trunk follows the spine.
        let upright = match bones.anatomy {
            Anatomy::Human => Vec3::Y,
            Anatomy::Creature => long_axis(bones, bone, patch),
        };
        return around(patch, Vec3::X, Some(upright));
    }
    if let Some(frame) = (bones.list[bone].part == Part::Foot).then(|| sole_frame(patch)).flatten() {
        return frame;
    }
    let preferred = around(patch, long_axis(bones, bone, patch), None);
    let (_, axes) = patch.covariance.eigen();
    let mut best = (preferred, CLEARLY_SMALLER * volume(patch, &preferred));
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        let frame = around(patch, axes * axis, None);
        let size = volume(patch, &frame);
        if size < best.1 {
            best = (frame, size);
        }
    }
    best.0
}

/// Returns axes whose vertical is exact if the foot is nearly level, because a box that is tilted by a few degrees
/// would rest on an edge.
fn sole_frame(patch: &Patch) -> Option<Mat3> {
    let (_, axes) = patch.covariance.eigen();
    let along = axes * Vec3::X;
    (along.y.abs() < 0.5).then(|| around(patch, Vec3::Y, None))
}

/// Returns `axis` and the directions of the sides of the smallest rectangle around the patch seen along `axis`.
/// `preferred` (perpendicular to the axis) replaces the rectangle's side unless the rectangle saves a quarter of the
/// area.
fn around(patch: &Patch, axis: Vec3, preferred: Option<Vec3>) -> Mat3 {
    let u = preferred.unwrap_or_else(|| any_orthonormal(axis));
    let v = axis.cross(u);
    let mut points: Vec<_> =
        patch.samples.iter().map(|s| Vec2::new(s.point.dot(u), s.point.dot(v))).collect();
    let side = least_rectangle(&mut points);
    let saves = rectangle_area(&points, side) < WORTH_TILTING * rectangle_area(&points, Vec2::X);
    let side = if preferred.is_none() || saves { side } else { Vec2::X };
    let first = u * side.x + v * side.y;
    Mat3::from_cols(axis, first, axis.cross(first))
}

fn volume(patch: &Patch, frame: &Mat3) -> f32 {
    let extent = |axis: Vec3| {
        let (lo, hi) = bounds(&patch.samples, |p| p.dot(axis));
        hi - lo
    };
    extent(frame.x_axis) * extent(frame.y_axis) * extent(frame.z_axis)
}

/// Returns the same axes, permuted and signed: y is nearest to `direction`, z points forward (+Z) as far as possible,
/// and the axes are right-handed.
pub fn with_y(frame: Mat3, direction: Vec3) -> Mat3 {
    let axes = [frame.x_axis, frame.y_axis, frame.z_axis];
    let nearest = |to: Vec3, axes: &[Vec3]| {
        (1..axes.len()).fold(0, |b, i| if axes[i].dot(to).abs() > axes[b].dot(to).abs() { i } else { b })
    };
    let signed = |axis: Vec3, to: Vec3| if axis.dot(to) < 0.0 { -axis } else { axis };
    let i = nearest(direction, &axes);
    let y = signed(axes[i], direction);
    let rest = [axes[(i + 1) % 3], axes[(i + 2) % 3]];
    // If y itself points forward, z points up.
    let forward = if y.z.abs() > 0.7 { Vec3::Y } else { Vec3::Z };
    let z = signed(rest[nearest(forward, &rest)], forward);
    Mat3::from_cols(y.cross(z), y, z)
}
