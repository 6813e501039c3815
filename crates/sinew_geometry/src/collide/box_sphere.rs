//! Box against ball: the point of the box closest to the centre of the ball.

use super::feature::{WHOLE, pair};
use super::manifold::{Manifold, SeparationCache};
use super::placed::{PlacedBox, PlacedSphere};
use crate::boxes::box_distance;

pub(super) fn collide(
    a: &PlacedBox,
    b: &PlacedSphere,
    margin: f32,
    cache: &mut SeparationCache,
    out: &mut Manifold,
) {
    let (distance, normal) = box_distance(a.half, a.local_point(b.center));
    let separation = distance - b.radius;
    if separation > margin {
        cache.gap = separation;
        return;
    }
    out.normal = a.vector(normal);
    // One id for all features of the box, so that the contact of a ball rolling over an edge persists.
    out.push(b.center - out.normal * (b.radius + 0.5 * separation), separation, pair(WHOLE, WHOLE));
}
