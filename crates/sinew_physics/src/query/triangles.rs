//! Tests of a probe against a surface, triangle by triangle.

use super::candidates::FARTHEST;
use super::probe::Probe;
use crate::boxes::Aabb;
use crate::contact::proxies::thick;
use crate::convex::feature::{Corner, Feature};
use crate::convex::support::{Core, Posed, Support, narrow, wide};
use crate::convex::{Gap, ShapeHit, advance, apart_along, closeness, meet};
use crate::triangles::{Surface, Triangle, normal};
use sinew_math::{DVec3, Transform, Vec3, max, min};

/// Returns the gap from the surface to the probe: the gap of the deepest or nearest triangle within a distance. No way
/// out leads through the back of a triangle.
pub(super) fn gap_within(
    surface: &Surface<'_>,
    world_from_surface: &Transform,
    probe: &Probe,
    within: f32,
) -> Option<Gap> {
    let placed = Placed::new(world_from_surface, probe)?;
    let mut best: Option<Gap> = None;
    surface.overlapping(&placed.region(Vec3::ZERO).expand(min(within, FARTHEST)), |triangle| {
        let gap = placed.gap(&triangle, Vec3::ZERO);
        if best.is_none_or(|best| gap.distance < best.distance) {
            best = Some(gap);
        }
    });
    best
}

/// Returns the first touch of the probe with the outside of a triangle.
pub(super) fn cast(
    surface: &Surface<'_>,
    world_from_surface: &Transform,
    probe: &Probe,
    way: Vec3,
) -> Option<ShapeHit> {
    let placed = Placed::new(world_from_surface, probe)?;
    let close = closeness(probe.shape.bounding_radius(), way);
    let mut first: Option<ShapeHit> = None;
    surface.overlapping(&placed.region(way).expand(close), |triangle| {
        let outward = world_from_surface.rotation * triangle.normal;
        let from_behind = way.dot(outward) >= 0.0;
        if from_behind && placed.gap(&triangle, Vec3::ZERO).distance > 0.0 {
            return;
        }
        let hit = advance(way, close, |moved| Some(placed.gap(&triangle, moved).flipped()));
        if let Some(hit) = hit
            && first.is_none_or(|first| hit.fraction < first.fraction)
        {
            first = Some(hit);
        }
    });
    first
}

/// A probe, and the pose of a surface.
struct Placed<'a> {
    core: Core<'a>,
    probe: &'a Probe,
    world_from_surface: &'a Transform,
}

impl<'a> Placed<'a> {
    fn new(world_from_surface: &'a Transform, probe: &'a Probe) -> Option<Self> {
        let finite = world_from_surface.is_finite() && probe.world_from_shape.is_finite();
        let core = Core::of(&probe.shape).filter(|_| finite)?;
        Some(Self { core, probe, world_from_surface })
    }

    /// Returns the bounds of the probe in the surface's frame, swept by `way` (world).
    fn region(&self, way: Vec3) -> Aabb {
        let surface_from_probe = self.world_from_surface.inverse() * self.probe.world_from_shape;
        let (start, moved) =
            (self.probe.shape.aabb(&surface_from_probe), self.world_from_surface.rotation.inverse() * way);
        thick(&start.merge(&Aabb { min: start.min + moved, max: start.max + moved }))
    }

    /// Returns the gap from a triangle to the probe moved by `way`.
    fn gap(&self, triangle: &Triangle, way: Vec3) -> Gap {
        let origin = self.probe.world_from_shape.translation;
        let flat = Flat(triangle.corners);
        let triangle_at = Posed::new(&flat, self.world_from_surface, origin);
        let mut probe = Posed::new(&self.core, &self.probe.world_from_shape, origin);
        probe.center += wide(way);
        let gap = meet(&triangle_at, &probe);
        let outward = wide(self.world_from_surface.rotation * triangle.normal);
        if gap.distance > 0.0 || wide(gap.normal).dot(outward) >= 0.0 {
            return gap.placed(origin);
        }
        let (normal, depth) = (narrow(outward), -apart_along(&triangle_at, &probe, outward) as f32);
        let on_b = narrow(probe.support(-outward) - outward * f64::from(probe.solid.rounding()));
        Gap { distance: -depth, normal, on_a: on_b + normal * depth, on_b }.placed(origin)
    }
}

/// A triangle as a convex solid without thickness.
struct Flat([Vec3; 3]);

impl Support for Flat {
    fn support(&self, direction: DVec3) -> DVec3 {
        let [a, b, c] = self.0.map(wide);
        let further = |p: DVec3, q: DVec3| if q.dot(direction) > p.dot(direction) { q } else { p };
        further(further(a, b), c)
    }

    fn rounding(&self) -> f32 {
        0.0
    }

    fn reach(&self) -> f32 {
        let [a, b, c] = self.0.map(Vec3::length);
        max(a, max(b, c))
    }

    fn thinnest(&self) -> f32 {
        0.0
    }

    fn feature(&self, _: Vec3) -> Feature {
        let [a, b, c] = self.0;
        let corner = |(name, point): (u16, Vec3)| Corner { point, name, side: name };
        let corners = [(0, a), (1, b), (2, c)].map(corner);
        Feature::new(&corners, 0, normal(&self.0))
    }
}
