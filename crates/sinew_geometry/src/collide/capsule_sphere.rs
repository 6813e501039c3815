//! Capsule against ball: the point of the core closest to the centre of the ball. For two balls, the first is a capsule
//! whose core is a point.

use super::feature::{WHOLE, pair};
use super::manifold::{Manifold, SeparationCache};
use super::placed::{PlacedCapsule, PlacedSphere, direction_or};
use sinew_math::any_orthonormal;

pub(super) fn collide(
    a: &PlacedCapsule,
    b: &PlacedSphere,
    margin: f32,
    cache: &mut SeparationCache,
    out: &mut Manifold,
) {
    let on_core = a.core.at(a.core.closest(b.center));
    let offset = b.center - on_core;
    let separation = offset.length() - a.radius - b.radius;
    if separation > margin {
        cache.gap = separation;
        return;
    }
    // If the centre is on the core, all ways out perpendicular to the core are equally short, and one is chosen.
    out.normal = direction_or(offset, a.radius + b.radius, any_orthonormal(a.axis));
    let position = on_core + out.normal * (a.radius + 0.5 * separation);
    out.push(position, separation, pair(WHOLE, WHOLE));
}
