//! Narrow phase: the contact manifold of two placed shapes.
//!
//! Pairs of shapes have separate files, each written for one order of the pair; [`collide`] sorts the pair and flips
//! the result if needed. Positions are computed relative to one of the shapes, so that a contact far from the world's
//! origin is as precise as one near the origin.

mod arcs;
mod axes;
mod box_box;
mod box_capsule;
mod box_sphere;
mod capsule_capsule;
mod capsule_sphere;
mod clip;
mod clip_features;
pub(crate) mod feature;
pub(crate) mod features;
mod half_space;
mod hull_pairs;
mod hull_round;
mod line;
mod manifold;
pub(crate) mod placed;
pub(crate) mod polytope;
mod reduce;
mod round_sphere;
mod seam;
mod triangles;

use crate::convex::support::{Core, Posed};
use crate::shape::Shape;
pub use feature::edge_directions;
pub use manifold::{MAX_POINTS, Manifold, ManifoldPoint, SeparationCache};
use placed::{PlacedBox, PlacedCapsule, PlacedSphere, Plane};
pub use seam::Faces;
use sinew_math::{Transform, Vec3};
pub use triangles::{
    Ground, Half, MAX_PARTS, Motion, Patch, Scratch, collide_surface, is_hidden, is_on_face, name_as_face,
    name_as_hidden,
};

/// Fills `out` with the contact of two placed shapes: the normal points from `a` to `b`, and every point has a
/// separation of at most `margin` (metres, ≥ 0). There are no points if the shapes are further apart, if both are
/// half-spaces, one is a mesh or height field (see [`collide_all`]), or a number is not finite. The previous content of
/// `out` is discarded.
///
/// Swapping the shapes changes the result only by rounding: it gives the opposite normal, the same points, and features
/// with their halves exchanged.
pub fn collide(
    a: &Shape,
    world_from_a: &Transform,
    b: &Shape,
    world_from_b: &Transform,
    margin: f32,
    out: &mut Manifold,
) {
    collide_again((a, world_from_a), (b, world_from_b), margin, &mut SeparationCache::default(), out);
}

/// Upper bound of the rounding error of a gap, as a share of the distance between the two frames.
const ROUNDING: f32 = 4e-6;

/// Like [`collide`], with a cache that the caller keeps for the pair between calls. A new pair starts with the default
/// cache.
pub fn collide_again(
    (a, world_from_a): (&Shape, &Transform),
    (b, world_from_b): (&Shape, &Transform),
    margin: f32,
    cache: &mut SeparationCache,
    out: &mut Manifold,
) {
    *out = Manifold::default();
    cache.gap = f32::NEG_INFINITY;
    if !(world_from_a.is_finite() && world_from_b.is_finite()) {
        return;
    }
    let balls = [a, b].map(as_ball);
    let (a, b) = (balls[0].as_ref().unwrap_or(a), balls[1].as_ref().unwrap_or(b));
    if rank(a) <= rank(b) {
        collide_ranked((a, world_from_a), (b, world_from_b), margin, cache, out);
    } else {
        collide_ranked((b, world_from_b), (a, world_from_a), margin, cache, out);
        out.flip();
    }
    cache.gap -= ROUNDING * (world_from_b.translation - world_from_a.translation).length();
}

/// Calls `visit` with each manifold of two placed shapes; arguments and results are as in [`collide`]. A mesh or height
/// field and a convex shape may have several manifolds, each with its own normal. Two surfaces, or a surface and a
/// half-space, have none.
pub fn collide_all(
    a: &Shape,
    world_from_a: &Transform,
    b: &Shape,
    world_from_b: &Transform,
    margin: f32,
    visit: impl FnMut(&Manifold),
) {
    if a.surface().is_none() && b.surface().is_none() {
        let mut manifold = Manifold::default();
        collide(a, world_from_a, b, world_from_b, margin, &mut manifold);
        let found = (manifold.count > 0).then_some(manifold);
        found.iter().for_each(visit);
        return;
    }
    let mut patch = Patch::default();
    let still = Motion { margin, ..Motion::default() };
    collide_pair((a, world_from_a), (b, world_from_b), &still, None, &mut Scratch::default(), &mut patch);
    patch.manifolds().iter().for_each(visit);
}

/// Fills `out` with the contacts of two placed shapes, one of which must be a surface; normals point from `a` to `b`.
/// `ground` returns the visible normals where other shapes continue the surface: see [`Ground`].
pub fn collide_pair(
    (a, world_from_a): (&Shape, &Transform),
    (b, world_from_b): (&Shape, &Transform),
    motion: &Motion,
    ground: Option<&Ground<'_>>,
    scratch: &mut Scratch,
    out: &mut Patch,
) {
    match (a.surface(), b.surface()) {
        (Some(surface), None) => {
            collide_surface(&surface, world_from_a, b, world_from_b, motion, ground, scratch, out);
        }
        (None, Some(surface)) => {
            collide_surface(&surface, world_from_b, a, world_from_a, motion, ground, scratch, out);
            out.flip();
        }
        _ => out.clear(),
    }
}

/// Converts a capsule of length 0 to a ball, which touches at one point.
fn as_ball(shape: &Shape) -> Option<Shape> {
    match *shape {
        Shape::Capsule { half_height: 0.0, radius } => Some(Shape::Sphere { radius }),
        _ => None,
    }
}

/// Returns the rank of a shape. [`collide`] sorts the shapes of a pair by rank; file names such as `box_sphere` have
/// the same order.
fn rank(shape: &Shape) -> u32 {
    match shape {
        Shape::HalfSpace => 0,
        Shape::Hull(_) => 1,
        Shape::Box { .. } => 2,
        Shape::Capsule { .. } => 3,
        Shape::Cone { .. } => 4,
        Shape::Cylinder { .. } => 5,
        Shape::TaperedCapsule { .. } => 6,
        Shape::Sphere { .. } => 7,
        Shape::Mesh(_) | Shape::HeightField(_) => 8,
    }
}

/// Finds the contact of a half-space and any solid.
fn collide_half_space(a: &Plane, b: &Shape, wb: &Transform, margin: f32, out: &mut Manifold) {
    match *b {
        Shape::Box { half_extents } => {
            half_space::against_box(a, &PlacedBox::new(half_extents, wb), margin, out);
        }
        Shape::Capsule { half_height, radius } => {
            half_space::against_capsule(a, &PlacedCapsule::new(half_height, radius, wb), margin, out);
        }
        Shape::Sphere { radius } => {
            half_space::against_sphere(a, &PlacedSphere::new(radius, wb), margin, out);
        }
        Shape::Hull(ref hull) => half_space::against_hull(a, hull, wb, margin, out),
        ref other => {
            if let Some(core) = Core::of(other) {
                half_space::against_core(a, &Posed::new(&core, wb, Vec3::ZERO), margin, out);
            }
        }
    }
}

/// Like [`collide`], for `rank(a) <= rank(b)`.
fn collide_ranked(
    (a, wa): (&Shape, &Transform),
    (b, wb): (&Shape, &Transform),
    margin: f32,
    cache: &mut SeparationCache,
    out: &mut Manifold,
) {
    // B is never the half-space, whose origin may be far away.
    let origin = wb.translation;
    let (wa, wb) =
        (Transform::new(wa.translation - origin, wa.rotation), Transform::new(Vec3::ZERO, wb.rotation));
    match (a, b) {
        (Shape::HalfSpace, other) => {
            let plane = Plane::new(&wa);
            cache.gap = plane.height(Vec3::ZERO) - other.bounding_radius();
            collide_half_space(&plane, other, &wb, margin, out);
        }
        (Shape::Hull(hull), _) => hull_pairs::collide(hull, &wa, b, &wb, margin, cache, out),
        (&Shape::Box { half_extents: half_a }, &Shape::Box { half_extents: half_b }) => {
            let (a, b) = (PlacedBox::new(half_a, &wa), PlacedBox::new(half_b, &wb));
            box_box::collide(&a, &b, margin, cache, out);
        }
        (&Shape::Box { half_extents }, &Shape::Capsule { half_height, radius }) => {
            let pill = PlacedCapsule::new(half_height, radius, &wb);
            box_capsule::collide(&PlacedBox::new(half_extents, &wa), &pill, margin, cache, out);
        }
        (&Shape::Box { half_extents }, &Shape::Sphere { radius }) => {
            box_sphere::collide(
                &PlacedBox::new(half_extents, &wa),
                &PlacedSphere::new(radius, &wb),
                margin,
                cache,
                out,
            );
        }
        (
            &Shape::Capsule { half_height: height_a, radius: radius_a },
            &Shape::Capsule { half_height: height_b, radius: radius_b },
        ) => {
            let (a, b) =
                (PlacedCapsule::new(height_a, radius_a, &wa), PlacedCapsule::new(height_b, radius_b, &wb));
            capsule_capsule::collide(&a, &b, margin, cache, out);
        }
        (&Shape::Capsule { half_height, radius }, &Shape::Sphere { radius: radius_b }) => {
            let pill = PlacedCapsule::new(half_height, radius, &wa);
            capsule_sphere::collide(&pill, &PlacedSphere::new(radius_b, &wb), margin, cache, out);
        }
        (&Shape::Sphere { radius }, &Shape::Sphere { radius: radius_b }) => {
            // A ball is a capsule of length 0.
            let pill = PlacedCapsule::new(0.0, radius, &wa);
            capsule_sphere::collide(&pill, &PlacedSphere::new(radius_b, &wb), margin, cache, out);
        }
        (round, &Shape::Sphere { radius }) => {
            round_sphere::collide(round, &wa, &PlacedSphere::new(radius, &wb), margin, out);
        }
        // `collide` sorts the pair into this order; two half-spaces have no contact.
        (a, b) => {
            if let (Some(a), Some(b)) = (Core::of(a), Core::of(b)) {
                let (a, b) = (Posed::new(&a, &wa, Vec3::ZERO), Posed::new(&b, &wb, Vec3::ZERO));
                features::collide(&a, &b, margin, cache, out);
            }
        }
    }
    out.finish(origin);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boxes::separation::AxisOf;
    use crate::hull::Hull;
    use sinew_math::{Random, Rotation};
    use std::sync::Arc;

    fn solid(random: &mut Random) -> Shape {
        let mut side = || random.range(0.1, 0.5);
        let half_extents = Vec3::new(side(), side(), side());
        if random.index(2) == 0 {
            return Shape::Box { half_extents };
        }
        let points: Vec<Vec3> = (0..16).map(|_| random.in_cube() * half_extents).collect();
        Shape::Hull(Arc::new(Hull::new(&points).expect("points in general position")))
    }

    /// Moves random pairs past each other, with the cache of the last call and with random axes in the cache.
    #[test]
    fn cached_axes_do_not_change_results() {
        let mut random = Random::new(71);
        let (mut same, mut separated, mut touching) = (0, 0, 0);
        for _ in 0..400 {
            let (a, b) = (solid(&mut random), solid(&mut random));
            let mut frame = Transform::new(random.direction(), random.rotation());
            let (drift, turn) = (random.in_cube() * 0.05, random.in_cube() * 0.05);
            let mut cache = SeparationCache::default();
            for _ in 0..20 {
                let before = cache.axis;
                let mut found = Manifold::default();
                collide_again((&a, &Transform::IDENTITY), (&b, &frame), 0.02, &mut cache, &mut found);
                let any = |random: &mut Random| random.index(70);
                let axis = Some(match random.index(3) {
                    0 => AxisOf::FaceA(any(&mut random)),
                    1 => AxisOf::FaceB(any(&mut random)),
                    _ => AxisOf::Edges(any(&mut random), any(&mut random)),
                });
                let mut wild = SeparationCache { axis, gap: 1.0 };
                let mut again = Manifold::default();
                collide_again((&a, &Transform::IDENTITY), (&b, &frame), 0.02, &mut wild, &mut again);
                let mut fresh = Manifold::default();
                collide(&a, &Transform::IDENTITY, &b, &frame, 0.02, &mut fresh);
                assert_eq!((found, again), (fresh, fresh));
                separated += u32::from(cache.axis.is_some());
                same += u32::from(cache.axis.is_some() && before == cache.axis);
                touching += u32::from(fresh.count > 0);
                frame = Transform::new(
                    frame.translation + drift,
                    Rotation::from_scaled_axis(turn) * frame.rotation,
                );
            }
        }
        assert!(
            separated > 1_000 && touching > 1_000 && same * 10 > separated * 7,
            "{same} equal, {separated} separated, {touching} touching pairs"
        );
    }
}
