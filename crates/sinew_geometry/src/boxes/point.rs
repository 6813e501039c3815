//! Points in and around boxes.

use super::PlacedBox;
use crate::distance::box_distance;
use sinew_math::Vec3;

/// Point of a box's surface that is closest to another point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// On the surface, metres.
    pub point: Vec3,
    /// Unit, out of the box: from the surface to a point outside, through the nearest face from inside.
    pub normal: Vec3,
    /// From the surface to the point along the normal, metres: negative inside.
    pub distance: f32,
}

/// Depth of something in a box, and its shortest way out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penetration {
    /// Metres, ≥ 0; 0 for what only touches.
    pub depth: f32,
    /// Unit, from the one that is asked to the other: moved by `direction * depth`, the other one only touches it. Where
    /// several ways are as short, one of them, always the same.
    pub direction: Vec3,
}

impl PlacedBox {
    /// `|d·aₖ| ≤ hₖ` with `d = p − c`, each product summed as `(d.x a.x + d.y a.y) + d.z a.z`.
    pub(super) fn holds(&self, p: Vec3) -> bool {
        let q = self.local_point(p);
        q.x.abs() <= self.half.x && q.y.abs() <= self.half.y && q.z.abs() <= self.half.z
    }

    /// Outside: the point clamped to the box is closest (Ericson, "Real-Time Collision Detection", 2005, §5.1.3), and the
    /// normal points from there. Inside: the way through the nearest face; the lowest axis among equals.
    pub(super) fn nearest_surface(&self, p: Vec3) -> SurfacePoint {
        let (distance, normal) = box_distance(self.half, self.local_point(p));
        let normal = self.vector(normal);
        SurfacePoint { point: p - normal * distance, normal, distance }
    }
}
