//! Nearest surface points and penetration depths of points in boxes.

use super::PlacedBox;
use sinew_math::{Vec3, abs3, max3};

/// Point of a box's surface that is closest to another point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Point on the surface, metres.
    pub point: Vec3,
    /// Outward unit normal. For a query point outside, it points from the surface to that point; for a point inside, it
    /// is the normal of the nearest face.
    pub normal: Vec3,
    /// Distance from the surface to the query point along the normal, metres; negative inside.
    pub distance: f32,
}

/// Penetration of two shapes: its depth, and the direction of the shortest way out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penetration {
    /// Depth, metres, ≥ 0; 0 if the shapes only touch.
    pub depth: f32,
    /// Unit vector from the queried box to the other shape: after a displacement by `direction * depth`, the other
    /// shape only touches. If several ways are equally short, the choice is deterministic.
    pub direction: Vec3,
}

impl PlacedBox {
    /// True if `|d·aₖ| ≤ hₖ` with `d = p − c`, each product summed as `(d.x a.x + d.y a.y) + d.z a.z`.
    pub(super) fn holds(&self, p: Vec3) -> bool {
        let q = self.local_point(p);
        q.x.abs() <= self.half.x && q.y.abs() <= self.half.y && q.z.abs() <= self.half.z
    }

    /// Returns the nearest surface point. If `p` is outside, this is `p` clamped to the box (Ericson, "Real-Time
    /// Collision Detection", 2005, §5.1.3), and the normal points from there to `p`. If `p` is inside, the nearest face
    /// gives the point and the normal; among equally near faces, the face of the lowest axis.
    pub(super) fn nearest_surface(&self, p: Vec3) -> SurfacePoint {
        let (distance, normal) = box_distance(self.half, self.local_point(p));
        let normal = self.vector(normal);
        SurfacePoint { point: p - normal * distance, normal, distance }
    }
}

/// Returns the signed distance of `p` to the box with these half extents around the origin, and the outward normal at
/// the closest point of the surface.
pub(crate) fn box_distance(half: Vec3, p: Vec3) -> (f32, Vec3) {
    distance_beyond(abs3(p) - half, p)
}

/// Returns the signed distance to a box, and the outward normal at the closest point of its surface. `beyond` is the
/// distance beyond the nearer face along each axis, negative inside; the signs of `p` select the nearer faces.
pub(crate) fn distance_beyond(beyond: Vec3, p: Vec3) -> (f32, Vec3) {
    let outside = max3(beyond, Vec3::ZERO);
    let distance = outside.length();
    if distance > 0.0 {
        let toward =
            Vec3::new(with_sign(outside.x, p.x), with_sign(outside.y, p.y), with_sign(outside.z, p.z));
        // Squares of tiny distances underflow, so the face normal is used.
        return if distance > 1e-12 { (distance, toward / distance) } else { (0.0, face_normal(beyond, p)) };
    }
    let axis = nearest_face(beyond);
    (beyond[axis], face_normal(beyond, p))
}

/// Axis of the face nearest to a point inside, from the distances `beyond` the faces; the lowest axis among equals.
fn nearest_face(beyond: Vec3) -> usize {
    let mut axis = 0;
    for k in 1..3 {
        if beyond[k] > beyond[axis] {
            axis = k;
        }
    }
    axis
}

fn face_normal(beyond: Vec3, p: Vec3) -> Vec3 {
    let axis = nearest_face(beyond);
    let mut normal = Vec3::ZERO;
    normal[axis] = with_sign(1.0, p[axis]);
    normal
}

/// Returns `magnitude` with the sign of `x`.
fn with_sign(magnitude: f32, x: f32) -> f32 {
    if x < 0.0 { -magnitude } else { magnitude }
}
