//! Signed distance from a point to a shape, used for containment and for collision of particles.

use crate::boxes::{SurfacePoint, box_distance};
use crate::revolved::{TaperedCapsule, TruncatedCone};
use crate::shape::Shape;
use sinew_math::{Transform, Vec3, clamp, normalize_or};

impl Shape {
    /// Returns the distance from the surface to `point` (world), metres, negative inside, and the unit outward normal
    /// (world) at the closest point of the surface. The distance is exact for every shape, except for rounding. Meshes
    /// and height fields are surfaces, which may be open: the distance is negative if the point is behind the closest
    /// triangle, however far. If several surface points are equally close (to the centre of a box, or to the axis of a
    /// capsule), the choice is deterministic.
    pub fn signed_distance(&self, world_from_shape: &Transform, point: Vec3) -> (f32, Vec3) {
        let (distance, normal) = self.local_distance(world_from_shape.inverse_point(point));
        (distance, world_from_shape.rotation * normal)
    }

    /// Returns the point of the surface closest to `point` (world), by [`signed_distance`](Self::signed_distance).
    /// Meshes and height fields have no inside: the distance is then 0 or more, and the normal points to `point`.
    pub fn nearest_surface(&self, world_from_shape: &Transform, point: Vec3) -> SurfacePoint {
        let (distance, normal) = self.signed_distance(world_from_shape, point);
        let behind = distance < 0.0 && self.surface().is_some();
        let (distance, normal) = if behind { (-distance, -normal) } else { (distance, normal) };
        SurfacePoint { point: point - normal * distance, normal, distance }
    }

    /// Like [`signed_distance`](Self::signed_distance), in the shape's own frame.
    pub fn local_distance(&self, p: Vec3) -> (f32, Vec3) {
        match *self {
            Shape::Box { half_extents } => box_distance(half_extents, p),
            Shape::Sphere { radius } => (p.length() - radius, normalize_or(p, Vec3::Y)),
            Shape::Capsule { half_height, radius } => {
                let from_core = p - Vec3::new(0.0, clamp(p.y, -half_height, half_height), 0.0);
                (from_core.length() - radius, normalize_or(from_core, Vec3::X))
            }
            Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                TaperedCapsule::new(half_height, radius_bottom, radius_top).distance(p)
            }
            Shape::Cylinder { half_height, radius } => {
                TruncatedCone::cylinder(half_height, radius).distance(p)
            }
            Shape::Cone { half_height, radius } => TruncatedCone::cone(half_height, radius).distance(p),
            Shape::HalfSpace => (p.y, Vec3::Y),
            Shape::Mesh(_) | Shape::HeightField(_) => {
                let closest = self.surface().and_then(|surface| surface.closest(p, f32::MAX.sqrt()));
                closest.map_or((f32::INFINITY, Vec3::Y), |closest| closest.signed(p))
            }
            Shape::Hull(ref hull) => hull.distance(p),
        }
    }
}

/// Distance behind a surface, in excess of the ball's radius, at which the ball counts as on the other side, metres.
const BEHIND: f32 = 0.01;

impl Shape {
    /// Like [`local_distance`](Self::local_distance), for the centre `p` of a ball with this radius. If `p` is more
    /// than the radius and 1 cm behind a mesh or height field, the ball counts as on the other side, and the distance
    /// is positive. A mesh or height field further away than `reach` (metres) gives `reach`.
    pub fn ball_distance(&self, p: Vec3, radius: f32, reach: f32) -> (f32, Vec3) {
        let Some(surface) = self.surface() else { return self.local_distance(p) };
        let Some(closest) = surface.closest(p, reach) else { return (reach, Vec3::Y) };
        let (distance, normal) = closest.signed(p);
        if distance < -(radius + BEHIND) { (-distance, -normal) } else { (distance, normal) }
    }
}
