//! Candidate shapes of a query: the interface between queries and trees.

use crate::boxes::Aabb;
use crate::contact::proxies::{Owner, thick};
use crate::tree::Sweep;
use crate::world::World;
use core::ops::ControlFlow;
use sinew_math::{Vec3, abs3, max, max3, min, min3};

/// Region in which shapes may answer a query.
#[derive(Clone, Copy, Debug)]
pub enum Reach {
    /// Shapes whose bounds meet a box.
    Box(Aabb),
    /// Shapes whose bounds overlap a box swept by a vector, metres.
    Swept(Aabb, Vec3),
    /// Shapes whose bounds are within a distance of a point, metres.
    Near(Vec3, f32),
}

/// Rank beyond which answers do not count; a break ends the search.
pub(super) type Limit = ControlFlow<(), f32>;

/// Largest distance from the origin at which shapes are found, metres: squares of larger numbers overflow.
pub(super) const FARTHEST: f32 = 1e18;

/// Smallest fraction to which a sweep is shortened.
const SHORTEST: f32 = 1e-30;

/// Passes every shape within reach, and possibly others, to `visit`, in any order, until `visit` breaks.
pub(super) fn candidates(world: &World, reach: &Reach, mut visit: impl FnMut(Owner) -> Limit) {
    let proxies = &world.broad.proxies;
    let mut broken = false;
    // Returns the remaining limit of a search along a line or around a point; below 0 after the end.
    let mut search = |owner: Owner| {
        if !broken && let ControlFlow::Continue(limit) = visit(owner) {
            return limit;
        }
        broken = true;
        -1.0
    };
    match *reach {
        Reach::Box(bounds) => {
            let within = |v: Vec3| max3(min3(v, Vec3::splat(FARTHEST)), Vec3::splat(-FARTHEST));
            let bounds = thick(&Aabb { min: within(bounds.min), max: within(bounds.max) });
            let _ = proxies.overlapping(&bounds, |owner| visit(owner).map_continue(|_| ()));
        }
        Reach::Swept(bounds, direction) => {
            let Some(sweep) = sweep(&bounds, direction) else { return };
            proxies.along(&sweep, |owner| {
                let limit = search(owner);
                if limit < 0.0 { limit } else { what_is_left(&sweep, limit) }
            });
        }
        Reach::Near(point, within) => {
            let within = min(within, FARTHEST);
            if largest(point) > FARTHEST {
                return;
            }
            // Shapes that contain the point are ranked by depth, at distance 0.
            proxies.nearest(point, within, |owner| max(min(search(owner), within), 0.0));
        }
    }
}

/// Returns the sweep of a moving box, for the trees; `None` if the box is too far away.
pub(super) fn sweep(bounds: &Aabb, direction: Vec3) -> Option<Sweep> {
    let (origin, half_extents) = (bounds.center(), bounds.half_extents());
    let limit = min(FARTHEST / largest(direction), 1.0);
    let is_near = largest(origin) <= FARTHEST && largest(half_extents) <= FARTHEST;
    is_near.then_some(Sweep { origin, direction, half_extents, limit })
}

/// Returns the fraction at which the tree search may stop, given that answers beyond `limit` do not count.
pub(super) fn what_is_left(sweep: &Sweep, limit: f32) -> f32 {
    // For hits at the start of a very long sweep the fractions underflow, but those of their bounds may not.
    min(max(limit, SHORTEST), sweep.limit)
}

/// Largest of the components' magnitudes.
fn largest(v: Vec3) -> f32 {
    let Vec3 { x, y, z } = abs3(v);
    max(x, max(y, z))
}
