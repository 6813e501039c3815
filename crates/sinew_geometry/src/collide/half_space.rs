//! Half-space against any convex shape: heights over the plane.

use super::axes::tolerance;
use super::feature::{self, WHOLE, end, pair};
use super::manifold::{Manifold, ManifoldPoint};
use super::placed::{PlacedBox, PlacedCapsule, PlacedSphere, Plane};
use super::reduce::push_best;
use crate::convex::feature::MOST_CORNERS;
use crate::convex::support::{Posed, Support, narrow, wide};
use crate::hull::{Hull, MAX_VERTICES};
use sinew_math::{Transform, Vec3, min};

/// Pushes the four corners of the face that faces the plane; the deepest corner of the box is always one of them.
pub(super) fn against_box(a: &Plane, b: &PlacedBox, margin: f32, out: &mut Manifold) {
    let (axis, side) = b.facing(-a.normal);
    out.normal = a.normal;
    for index in 0..8 {
        let on_face = (index >> axis & 1 == 1) == (side > 0.0);
        if on_face {
            push(a, b.vertex(index), 0.0, margin, feature::vertex(index), out);
        }
    }
}

/// Pushes the corners of the face that faces the plane, and the lowest corner if it is not one of them.
pub(super) fn against_hull(a: &Plane, b: &Hull, frame: &Transform, margin: f32, out: &mut Manifold) {
    let polytope = b.polytope();
    let down = frame.rotation.inverse() * -a.normal;
    let face = polytope.face_at_support(down, tolerance(f32::INFINITY, b.inner_radius()));
    let point = |corner: usize| under(a, frame.point(b.vertices()[corner]), 0.0, feature::vertex(corner));
    let (corners, lowest) = (polytope.topology.corners(face).map(point), point(polytope.support(down)));
    out.normal = a.normal;
    push_deepest::<MAX_VERTICES>(corners, lowest, ROUNDING * b.bounding_radius(), margin, out);
}

/// Pushes both ends of a capsule.
pub(super) fn against_capsule(a: &Plane, b: &PlacedCapsule, margin: f32, out: &mut Manifold) {
    out.normal = a.normal;
    for (index, point) in b.core.ends.into_iter().enumerate() {
        push(a, point, b.radius, margin, end(index), out);
    }
    // Both ends of a capsule of length 0 are the same point, which counts only once.
    if out.count == 2 && b.core.ends[0] == b.core.ends[1] {
        out.count = 1;
    }
}

pub(super) fn against_sphere(a: &Plane, b: &PlacedSphere, margin: f32, out: &mut Manifold) {
    out.normal = a.normal;
    push(a, b.center, b.radius, margin, WHOLE, out);
}

/// Pushes the corners of the feature that faces the plane, and the lowest point if it is below them.
pub(super) fn against_core<S: Support>(a: &Plane, b: &Posed<'_, S>, margin: f32, out: &mut Manifold) {
    const POINTS: usize = MOST_CORNERS + 1;
    let (feature, radius) = (b.feature(-a.normal), b.solid.rounding());
    let corners = feature.corners().iter().map(|corner| under(a, corner.point, radius, corner.name));
    let lowest = under(a, narrow(b.support(-wide(a.normal))), radius, WHOLE);
    out.normal = a.normal;
    push_deepest::<POINTS>(corners, lowest, ROUNDING * b.solid.reach(), margin, out);
}

/// Difference below which heights over the plane count as equal, as a share of the solid's reach. Heights have a
/// rounding error of a few times 6e-8 of the reach, and rounding must not change the points of a resting solid.
const ROUNDING: f32 = 1e-5;

/// Pushes at most four of the given corners that are within the margin. The `lowest` point of a tilted or round solid
/// may be below all corners; then it is a candidate too. `N` is the largest number of candidates.
fn push_deepest<const N: usize>(
    corners: impl Iterator<Item = ManifoldPoint>,
    lowest: ManifoldPoint,
    tolerance: f32,
    margin: f32,
    out: &mut Manifold,
) {
    let mut points = [ManifoldPoint::default(); N];
    let (mut count, mut nearest) = (0, f32::INFINITY);
    let mut keep = |point: ManifoldPoint| {
        if point.separation <= margin {
            points[count] = point;
            count += 1;
        }
    };
    for point in corners {
        nearest = min(point.separation, nearest);
        keep(point);
    }
    if lowest.separation < nearest - tolerance {
        keep(lowest);
    }
    push_best(&points[..count], tolerance, out);
}

/// Returns the contact point of the plane and a ball; use radius 0 for a corner.
fn under(a: &Plane, center: Vec3, radius: f32, feature: u16) -> ManifoldPoint {
    let separation = a.height(center) - radius;
    let position = center - a.normal * (radius + 0.5 * separation);
    ManifoldPoint { position, separation, feature: pair(WHOLE, feature) }
}

fn push(a: &Plane, center: Vec3, radius: f32, margin: f32, feature: u16, out: &mut Manifold) {
    let point = under(a, center, radius, feature);
    if point.separation <= margin {
        out.push(point.position, point.separation, point.feature);
    }
}
