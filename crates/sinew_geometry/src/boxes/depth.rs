//! Overlaps of boxes with oriented boxes, balls and capsules: depth and direction.

use super::fifteen::FifteenAxes;
use super::overlap::{Capsule, Overlap, Sphere};
use super::segment::{Segment, best_edge, best_face, gap};
use super::separation::{self, PARALLEL_SINE};
use super::{Aabb, Cuboid, Obb, Penetration, PlacedBox};
use sinew_math::{Vec3, max};

impl Overlap<Obb> for Aabb {
    fn overlaps(&self, other: &Obb) -> bool {
        FifteenAxes::of(&self.placed(), &other.placed()).overlap()
    }

    fn penetration(&self, other: &Obb) -> Option<Penetration> {
        separation::penetration(&self.placed(), &other.placed())
    }
}

impl Overlap<Aabb> for Obb {
    fn overlaps(&self, other: &Aabb) -> bool {
        FifteenAxes::of(&self.placed(), &other.placed()).overlap()
    }

    fn penetration(&self, other: &Aabb) -> Option<Penetration> {
        separation::penetration(&self.placed(), &other.placed())
    }
}

impl Overlap<Obb> for Obb {
    fn overlaps(&self, other: &Obb) -> bool {
        FifteenAxes::of(&self.placed(), &other.placed()).overlap()
    }

    fn penetration(&self, other: &Obb) -> Option<Penetration> {
        separation::penetration(&self.placed(), &other.placed())
    }
}

impl Overlap<PlacedBox> for PlacedBox {
    fn overlaps(&self, other: &PlacedBox) -> bool {
        FifteenAxes::of(self, other).overlap()
    }

    fn penetration(&self, other: &PlacedBox) -> Option<Penetration> {
        separation::penetration(self, other)
    }
}

impl<A: Cuboid> Overlap<Sphere> for A {
    fn overlaps(&self, other: &Sphere) -> bool {
        self.signed_distance(other.center) <= other.radius
    }

    fn penetration(&self, other: &Sphere) -> Option<Penetration> {
        let nearest = self.nearest_surface(other.center);
        (nearest.distance <= other.radius)
            .then_some(Penetration { depth: other.radius - nearest.distance, direction: nearest.normal })
    }
}

impl<A: Cuboid> Overlap<Capsule> for A {
    fn overlaps(&self, other: &Capsule) -> bool {
        let placed = self.placed();
        gap(placed.half, &core_in(&placed, other)).is_none_or(|gap| gap.distance <= other.radius)
    }

    fn penetration(&self, other: &Capsule) -> Option<Penetration> {
        let placed = self.placed();
        let core = core_in(&placed, other);
        let gap = gap(placed.half, &core);
        if gap.as_ref().is_some_and(|gap| gap.distance > other.radius) {
            return None;
        }
        let (distance, normal) = match gap {
            // Nearly coincident points define no direction.
            Some(gap) if gap.distance > NOISE * (placed.half.length() + gap.on_core.length()) => {
                (gap.distance, (gap.on_core - gap.on_box) / gap.distance)
            }
            _ => way_out_of_core(placed.half, &core),
        };
        Some(Penetration { depth: max(other.radius - distance, 0.0), direction: placed.vector(normal) })
    }
}

impl<B: Cuboid> Overlap<B> for Sphere {
    fn overlaps(&self, other: &B) -> bool {
        other.overlaps(self)
    }

    fn penetration(&self, other: &B) -> Option<Penetration> {
        other.penetration(self).map(Penetration::reversed)
    }
}

impl<B: Cuboid> Overlap<B> for Capsule {
    fn overlaps(&self, other: &B) -> bool {
        other.overlaps(self)
    }

    fn penetration(&self, other: &B) -> Option<Penetration> {
        other.penetration(self).map(Penetration::reversed)
    }
}

impl Penetration {
    fn reversed(self) -> Self {
        Self { depth: self.depth, direction: -self.direction }
    }
}

/// Distance of two points, relative to the size of the shapes, below which rounding dominates the direction between the
/// points.
const NOISE: f32 = 1e-4;

/// Returns a capsule's core in the box's frame.
fn core_in(placed: &PlacedBox, capsule: &Capsule) -> Segment {
    Segment { ends: capsule.ends.map(|p| placed.local_point(p)) }
}

/// Returns the direction in which the core leaves the box by the shortest way, and the signed distance along it.
fn way_out_of_core(half: Vec3, core: &Segment) -> (f32, Vec3) {
    let (distance, face) = best_face(half, core);
    match best_edge(half, core, PARALLEL_SINE) {
        Some((other, edge)) if other > distance => (other, edge.normal),
        _ => (distance, face.normal),
    }
}
