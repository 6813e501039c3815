//! Bounds of placed shapes.

use crate::boxes::{Aabb, HALF_SPACE_REACH};
use crate::shape::Shape;
use sinew_math::{Mat3, Transform, Vec3, abs3, max3, min3};

/// Returns the bounds of a transformed box, in the world.
fn turned(bounds: &Aabb, world_from_frame: &Transform) -> Aabb {
    let (m, half) = (world_from_frame.rotation.to_mat3(), bounds.half_extents());
    let reach = abs3(m.x_axis) * half.x + abs3(m.y_axis) * half.y + abs3(m.z_axis) * half.z;
    // Covers the rounding errors of the centre and the half extents.
    let rounding = 1e-6 * max3(abs3(bounds.min), abs3(bounds.max)).length();
    Aabb::reaching(world_from_frame.point(bounds.center()), reach).expand(rounding)
}

impl Shape {
    /// Returns the bounds of the placed shape, tight except for rounding. The bounds of a half-space extend to
    /// [`HALF_SPACE_REACH`] on every side, but those of a level half-space end at its plane. The bounds of a mesh or
    /// height field are not tight: they contain its local bounds, transformed.
    pub fn aabb(&self, world_from_shape: &Transform) -> Aabb {
        let (center, rotation) = (world_from_shape.translation, world_from_shape.rotation);
        match *self {
            Shape::Box { half_extents } => {
                let m = rotation.to_mat3();
                let reach = abs3(m.x_axis) * half_extents.x
                    + abs3(m.y_axis) * half_extents.y
                    + abs3(m.z_axis) * half_extents.z;
                Aabb::reaching(center, reach)
            }
            Shape::Sphere { radius } => Aabb::reaching(center, Vec3::splat(radius)),
            Shape::Capsule { half_height, radius } => {
                let core = abs3(rotation * Vec3::Y) * half_height;
                Aabb::reaching(center, core + Vec3::splat(radius))
            }
            Shape::Hull(ref hull) => {
                // Computed from the corners relative to the shape's origin, so that no digits are lost far from the
                // world's origin.
                let m = rotation.to_mat3();
                let (mut low, mut high) = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
                for &vertex in hull.vertices() {
                    let turned = m * vertex;
                    (low, high) = (min3(turned, low), max3(turned, high));
                }
                Aabb { min: center + low, max: center + high }
            }
            Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                let axis = rotation * Vec3::Y * half_height;
                let [low, high] = [(-axis, radius_bottom), (axis, radius_top)]
                    .map(|(end, radius)| Aabb::reaching(center + end, Vec3::splat(radius)));
                low.merge(&high)
            }
            Shape::Cylinder { half_height, radius } => {
                let m = rotation.to_mat3();
                Aabb::reaching(center, abs3(m.y_axis) * half_height + disk_reach(&m) * radius)
            }
            Shape::Cone { half_height, radius } => {
                let m = rotation.to_mat3();
                let axis = m.y_axis * half_height;
                let apex = Aabb::reaching(center + axis, Vec3::ZERO);
                apex.merge(&Aabb::reaching(center - axis, disk_reach(&m) * radius))
            }
            Shape::HalfSpace => {
                let mut bounds = Aabb::reaching(Vec3::ZERO, Vec3::splat(HALF_SPACE_REACH));
                if rotation * Vec3::Y == Vec3::Y {
                    bounds.max.y = center.y;
                }
                bounds
            }
            Shape::Mesh(ref mesh) => turned(&mesh.bounds(), world_from_shape),
            Shape::HeightField(ref field) => turned(&field.bounds(), world_from_shape),
        }
    }
}

/// Returns the extent along each world axis of a unit disk perpendicular to the y axis of `m`. Uses the sines of the
/// angles to y, because a cosine near 1 would lose half of the digits.
fn disk_reach(m: &Mat3) -> Vec3 {
    let reach = |x: f32, z: f32| (x * x + z * z).sqrt();
    Vec3::new(reach(m.x_axis.x, m.z_axis.x), reach(m.x_axis.y, m.z_axis.y), reach(m.x_axis.z, m.z_axis.z))
}
