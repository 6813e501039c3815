//! Overlap of boxes with boxes, balls and capsules: the trait, and its implementation for axis-aligned boxes.

use super::aabb::Aabb;
use super::point::Penetration;
use sinew_math::Vec3;

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre, metres.
    pub center: Vec3,
    /// Radius, metres, ≥ 0; a ball of radius 0 is a point.
    pub radius: f32,
}

impl Sphere {
    /// Creates a ball from its centre and radius.
    ///
    /// # Panics
    /// If a number is not finite or the radius is negative.
    pub fn new(center: Vec3, radius: f32) -> Self {
        assert!(center.is_finite(), "the centre of a ball must be finite");
        expect_radius(radius);
        Self { center, radius }
    }
}

/// A capsule: all points within a radius of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Ends of the segment, metres; they may coincide.
    pub ends: [Vec3; 2],
    /// Radius, metres, ≥ 0; a capsule of radius 0 is a segment.
    pub radius: f32,
}

impl Capsule {
    /// Creates a capsule from the ends of its segment and its radius.
    ///
    /// # Panics
    /// If a number is not finite or the radius is negative.
    pub fn new(ends: [Vec3; 2], radius: f32) -> Self {
        assert!(ends[0].is_finite() && ends[1].is_finite(), "the ends of a capsule must be finite");
        expect_radius(radius);
        Self { ends, radius }
    }
}

fn expect_radius(radius: f32) {
    assert!((0.0..f32::INFINITY).contains(&radius), "a radius must be finite and not negative");
}

/// Overlap of two convex shapes, at least one of which is a box. Shapes that touch overlap, and so do shapes of which
/// one contains the other. Swapped arguments give the same result except for rounding, with the opposite direction.
pub trait Overlap<Other> {
    /// True if the shapes have a point in common.
    fn overlaps(&self, other: &Other) -> bool;

    /// Returns the shortest displacement of `other` after which the shapes only touch, as a direction and a depth.
    /// Returns `Some` exactly if [`overlaps`](Self::overlaps) is true.
    fn penetration(&self, other: &Other) -> Option<Penetration>;
}

/// Compares the boxes' intervals along each axis, without rounding.
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
