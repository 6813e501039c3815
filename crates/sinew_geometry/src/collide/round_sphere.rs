//! Cone, cylinder and tapered capsule against ball: the point of the surface closest to the centre of the ball.

use super::feature::{WHOLE, pair};
use super::manifold::Manifold;
use super::placed::PlacedSphere;
use crate::shape::Shape;
use sinew_math::Transform;

pub(super) fn collide(a: &Shape, frame: &Transform, b: &PlacedSphere, margin: f32, out: &mut Manifold) {
    let (distance, normal) = a.signed_distance(frame, b.center);
    let separation = distance - b.radius;
    if separation > margin {
        return;
    }
    out.normal = normal;
    // One id for all features, so that the contact of a ball rolling over a rim persists.
    out.push(b.center - normal * (b.radius + 0.5 * separation), separation, pair(WHOLE, WHOLE));
}
