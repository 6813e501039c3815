//! Hull against any bounded convex shape, in the frame of the hull.

use super::axes::TIE_DIRECTION;
use super::manifold::{Manifold, SeparationCache};
use super::placed::{PlacedBox, PlacedCapsule};
use super::{features, hull_round, polytope};
use crate::convex::support::{Core, Posed};
use crate::hull::{BoxPolytope, Hull, Room};
use crate::shape::Shape;
use sinew_math::{Transform, Vec3};

/// Finds the contact of a hull and a shape of equal or higher [rank](super::rank).
pub(super) fn collide(
    hull: &Hull,
    pair_from_hull: &Transform,
    other: &Shape,
    pair_from_other: &Transform,
    margin: f32,
    cache: &mut SeparationCache,
    out: &mut Manifold,
) {
    let frame = pair_from_hull.inverse() * *pair_from_other;
    let tie = pair_from_hull.rotation.inverse() * TIE_DIRECTION;
    let polytope = hull.polytope();
    match *other {
        Shape::Hull(ref other) => {
            let mut room = Room::EMPTY;
            let other = other.polytope().seen_from(&frame, &mut room);
            polytope::collide(&polytope, &other, margin, tie, cache, out);
        }
        Shape::Box { half_extents } => {
            let other = BoxPolytope::new(&PlacedBox::new(half_extents, &frame));
            polytope::collide(&polytope, &other.polytope(), margin, tie, cache, out);
        }
        Shape::Capsule { half_height, radius } => {
            let pill = PlacedCapsule::new(half_height, radius, &frame);
            hull_round::against_capsule(&polytope, &pill.core, radius, margin, cache, out);
        }
        Shape::Sphere { radius } => {
            hull_round::against_sphere(&polytope, frame.translation, radius, margin, cache, out);
        }
        _ => {
            let core = Core::Hull(hull);
            let a = Posed::new(&core, &Transform::IDENTITY, Vec3::ZERO);
            if let Some(core) = Core::of(other) {
                features::collide(&a, &Posed::new(&core, &frame, Vec3::ZERO), margin, cache, out);
            }
        }
    }
    out.normal = pair_from_hull.rotation * out.normal;
    for point in &mut out.points[..out.count] {
        point.position = pair_from_hull.point(point.position);
    }
}
