//! Capsule against ball: the point of the core closest to the centre of the ball. A ball against a ball is the case of
//! a capsule whose core is a point.

use super::feature::{WHOLE, pair};
use super::manifold::{Manifold, SeparationCache};
use super::placed::{PlacedCapsule, PlacedSphere, direction_or};
use sinew_math::any_orthonormal;

pub(super) fn collide(
    a: &PlacedCapsule,
    b: &PlacedSphere,
    margin: f32,
    parting: &mut SeparationCache,
    out: &mut Manifold,
) {
    let on_core = a.core.at(a.core.closest(b.center));
    let offset = b.center - on_core;
    let separation = offset.length() - a.radius - b.radius;
    if separation > margin {
        parting.gap = separation;
        return;
    }
    // The centre is on the core: all ways out across the core are equally short.
    out.normal = direction_or(offset, a.radius + b.radius, any_orthonormal(a.axis));
    let position = on_core + out.normal * (a.radius + 0.5 * separation);
    out.push(position, separation, pair(WHOLE, WHOLE));
}
