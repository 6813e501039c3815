//! Boxes against boxes, balls and capsules: whether they overlap, how deep, and in which direction.

use super::fifteen::FifteenAxes;
use super::segment::{Segment, best_edge, best_face, gap};
use super::separation::{self, PARALLEL_SINE};
use super::{Aabb, Cuboid, Obb, Penetration, PlacedBox};
use sinew_math::{Vec3, max};

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Metres.
    pub center: Vec3,
    /// Metres, ≥ 0; of radius 0 it is a point.
    pub radius: f32,
}

impl Sphere {
    /// From its parts.
    ///
    /// # Panics
    /// If a number is not finite or the radius is negative.
    pub fn new(center: Vec3, radius: f32) -> Self {
        assert!(center.is_finite(), "a ball stands somewhere");
        expect_radius(radius);
        Self { center, radius }
    }
}

/// All points within a radius of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Ends of the segment, metres; they may coincide.
    pub ends: [Vec3; 2],
    /// Metres, ≥ 0; of radius 0 it is a segment.
    pub radius: f32,
}

impl Capsule {
    /// From its parts.
    ///
    /// # Panics
    /// If a number is not finite or the radius is negative.
    pub fn new(ends: [Vec3; 2], radius: f32) -> Self {
        assert!(ends[0].is_finite() && ends[1].is_finite(), "a capsule's ends are somewhere");
        expect_radius(radius);
        Self { ends, radius }
    }
}

fn expect_radius(radius: f32) {
    assert!((0.0..f32::INFINITY).contains(&radius), "a radius is finite and not negative");
}

/// Overlap of two convex things of which at least one is a box. What touches overlaps; so does what contains the other.
/// The order does not matter but for rounding: the other one gives the opposite direction.
pub trait Overlap<Other> {
    /// True if they have a point in common.
    fn overlaps(&self, other: &Other) -> bool;

    /// Way that `other` has to move so that they only touch, with its depth: the shortest of all such ways.
    /// `Some` exactly where [`overlaps`](Self::overlaps) is true.
    fn penetration(&self, other: &Other) -> Option<Penetration>;
}

/// By intervals, exactly.
impl Overlap<Aabb> for Aabb {
    #[inline]
    fn overlaps(&self, other: &Aabb) -> bool {
        self.min.x <= other.max.x
            && other.min.x <= self.max.x
            && self.min.y <= other.max.y
            && other.min.y <= self.max.y
            && self.min.z <= other.max.z
            && other.min.z <= self.max.z
    }

    fn penetration(&self, other: &Aabb) -> Option<Penetration> {
        if !self.overlaps(other) {
            return None;
        }
        let mut least = Penetration { depth: f32::INFINITY, direction: Vec3::X };
        for axis in 0..3 {
            let mut up = Vec3::ZERO;
            up[axis] = 1.0;
            let ways = [(self.max[axis] - other.min[axis], up), (other.max[axis] - self.min[axis], -up)];
            for (depth, direction) in ways {
                if depth < least.depth {
                    least = Penetration { depth, direction };
                }
            }
        }
        Some(least)
    }
}

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
            // Between points that all but coincide there is no direction.
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

/// Share of the lengths at hand below which a direction between two points is taken as rounding.
const NOISE: f32 = 1e-4;
/// A capsule's core in the box's frame.
fn core_in(placed: &PlacedBox, capsule: &Capsule) -> Segment {
    Segment { ends: capsule.ends.map(|p| placed.local_point(p)) }
}

/// Signed distance along the direction in which the core is the least deep in the box, and that direction.
fn way_out_of_core(half: Vec3, core: &Segment) -> (f32, Vec3) {
    let (distance, face) = best_face(half, core);
    match best_edge(half, core, PARALLEL_SINE) {
        Some((other, edge)) if other > distance => (other, edge.normal),
        _ => (distance, face.normal),
    }
}
