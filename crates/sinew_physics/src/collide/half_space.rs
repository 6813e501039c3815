//! Half-space against everything: heights over the plane.

use super::axes::tolerance;
use super::feature::{self, WHOLE, end, pair};
use super::placed::{Ball, Pill, PlacedBox, Plane};
use super::reduce::push_best;
use super::{Manifold, ManifoldPoint};
use crate::convex::feature::MOST_CORNERS;
use crate::convex::support::{Posed, Support};
use crate::hull::{Hull, MAX_VERTICES};
use sinew_math::{Transform, Vec3, min};

/// The four corners of the face that looks at the plane: the deepest corner is always one of them.
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

/// The corners of the face that looks at the plane from the deepest corner.
pub(super) fn against_hull(a: &Plane, b: &Hull, frame: &Transform, margin: f32, out: &mut Manifold) {
    out.normal = a.normal;
    let polytope = b.polytope();
    let tolerance = tolerance(f32::INFINITY, b.inner_radius());
    let down = frame.rotation.inverse() * -a.normal;
    let face = polytope.face_at_support(down, tolerance);
    let mut points = [ManifoldPoint::default(); MAX_VERTICES];
    let mut count = 0;
    for corner in polytope.topology.corners(face) {
        let place = frame.point(b.vertices()[corner]);
        let separation = a.height(place);
        if separation <= margin {
            let position = place - a.normal * (0.5 * separation);
            let feature = pair(WHOLE, feature::vertex(corner));
            points[count] = ManifoldPoint { position, separation, feature };
            count += 1;
        }
    }
    push_best(&points[..count], tolerance, out);
}

/// Both ends.
pub(super) fn against_capsule(a: &Plane, b: &Pill, margin: f32, out: &mut Manifold) {
    out.normal = a.normal;
    for (index, point) in b.core.ends.into_iter().enumerate() {
        push(a, point, b.radius, margin, end(index), out);
    }
    // A capsule without a middle is a ball: one point, so that it is not pushed twice.
    if out.count == 2 && b.core.ends[0] == b.core.ends[1] {
        out.count = 1;
    }
}

pub(super) fn against_sphere(a: &Plane, b: &Ball, margin: f32, out: &mut Manifold) {
    out.normal = a.normal;
    push(a, b.center, b.radius, margin, WHOLE, out);
}

/// What looks at the plane, the deepest four points of it.
pub(super) fn against_core<S: Support>(a: &Plane, b: &Posed<'_, S>, margin: f32, out: &mut Manifold) {
    let feature = b.feature(-a.normal);
    let (radius, mut points, mut count) = (b.solid.rounding(), [ManifoldPoint::default(); MOST_CORNERS], 0);
    for corner in feature.corners() {
        let separation = a.height(corner.point) - radius;
        if separation <= margin {
            let position = corner.point - a.normal * (radius + 0.5 * separation);
            points[count] = ManifoldPoint { position, separation, feature: pair(WHOLE, corner.name) };
            count += 1;
        }
    }
    out.normal = a.normal;
    push_best(&points[..count], min(0.0005, 0.01 * b.solid.thinnest()), out);
}

fn push(a: &Plane, center: Vec3, radius: f32, margin: f32, feature: u16, out: &mut Manifold) {
    let separation = a.height(center) - radius;
    if separation <= margin {
        out.push(center - a.normal * (radius + 0.5 * separation), separation, pair(WHOLE, feature));
    }
}
