//! Points in and around boxes.

use super::PlacedBox;
use sinew_math::{Vec3, abs3, max3};

/// Point of a box's surface that is closest to another point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Point on the surface, metres.
    pub point: Vec3,
    /// Unit, out of the box: from the surface to an outside point, through the nearest face for an inside one.
    pub normal: Vec3,
    /// Distance from the surface to the point along the normal, metres: negative inside.
    pub distance: f32,
}

/// Penetration depth in a box, and the shortest way out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penetration {
    /// Metres, ≥ 0; 0 if they only touch.
    pub depth: f32,
    /// Unit, from the queried box to the other shape: moved by `direction * depth`, the other one only touches. If
    /// several ways are equally short, always the same one.
    pub direction: Vec3,
}

impl PlacedBox {
    /// `|d·aₖ| ≤ hₖ` with `d = p − c`, each product summed as `(d.x a.x + d.y a.y) + d.z a.z`.
    pub(super) fn holds(&self, p: Vec3) -> bool {
        let q = self.local_point(p);
        q.x.abs() <= self.half.x && q.y.abs() <= self.half.y && q.z.abs() <= self.half.z
    }

    /// Outside: the point clamped to the box is closest (Ericson, "Real-Time Collision Detection", 2005, §5.1.3), and
    /// the normal points from there. Inside: through the nearest face; the lowest axis among equals.
    pub(super) fn nearest_surface(&self, p: Vec3) -> SurfacePoint {
        let (distance, normal) = box_distance(self.half, self.local_point(p));
        let normal = self.vector(normal);
        SurfacePoint { point: p - normal * distance, normal, distance }
    }
}

/// Signed distance to the box of the given half extents around the origin, and the outward normal.
pub(crate) fn box_distance(half: Vec3, p: Vec3) -> (f32, Vec3) {
    distance_beyond(abs3(p) - half, p)
}

/// Signed distance to a box and its outward normal, from the excess beyond the nearer face along each axis, and a
/// vector whose signs select the faces.
pub(crate) fn distance_beyond(beyond: Vec3, p: Vec3) -> (f32, Vec3) {
    let outside = max3(beyond, Vec3::ZERO);
    let distance = outside.length();
    if distance > 0.0 {
        let toward =
            Vec3::new(with_sign(outside.x, p.x), with_sign(outside.y, p.y), with_sign(outside.z, p.z));
        // Squares of tiny distances underflow: measure them again at a larger scale.
        return if distance > 1e-12 { (distance, toward / distance) } else { (0.0, face_normal(beyond, p)) };
    }
    let axis = nearest_face(beyond);
    (beyond[axis], face_normal(beyond, p))
}

/// The axis of the face that is nearest from inside; the lowest among equals.
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

/// `magnitude` with the sign of `x`.
fn with_sign(magnitude: f32, x: f32) -> f32 {
    if x < 0.0 { -magnitude } else { magnitude }
}
