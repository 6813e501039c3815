//! Shapes and poses for Parry: Rapier's collision library, which also measures the penetration of every engine.

use crate::engine::Unsupported;
use parry3d::math::{Pose, Rotation as ParryRotation, Vector};
use parry3d::shape::SharedShape;
use sinew::math::{Rotation, Transform, Vec3};
use sinew::physics::Shape;

/// Converts a point or direction to Parry's.
pub fn vector(v: Vec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

#[cfg(feature = "rapier")]
/// Converts a point or direction from Parry's.
pub fn from_vector(v: Vector) -> Vec3 {
    Vec3::new(v.x, v.y, v.z)
}

/// Converts a rotation.
pub fn rotation(q: Rotation) -> ParryRotation {
    ParryRotation::from_xyzw(q.x, q.y, q.z, q.w)
}

/// Converts a transform to a pose.
pub fn pose(t: Transform) -> Pose {
    Pose::from_parts(vector(t.translation), rotation(t.rotation))
}

#[cfg(feature = "rapier")]
/// Converts a pose to a transform.
pub fn from_pose(pose: &Pose) -> Transform {
    let q = pose.rotation;
    Transform::new(from_vector(pose.translation), Rotation::from_xyzw(q.x, q.y, q.z, q.w))
}

/// Returns vertices and triangles of a mesh or height field; `None` for other shapes.
pub fn triangles(shape: &Shape) -> Option<(Vec<Vec3>, Vec<[u32; 3]>)> {
    match shape {
        Shape::Mesh(mesh) => Some((mesh.vertices().to_vec(), mesh.triangles().collect())),
        Shape::HeightField(field) => {
            // Indexes corners by their positions on the grid, so that triangles share them.
            let def = field.def();
            let [dx, dz] = def.spacing;
            let at = |i: usize| {
                let (column, row) = (i % def.columns, i / def.columns);
                Vec3::new(column as f32 * dx, def.heights[i], row as f32 * dz)
            };
            let index = |corner: Vec3| {
                let [column, row] = [corner.x / dx, corner.z / dz].map(|lines| lines.round() as u32);
                row * def.columns as u32 + column
            };
            let vertices = (0..def.heights.len()).map(at).collect();
            Some((vertices, field.triangles().map(|corners| corners.map(index)).collect()))
        }
        _ => None,
    }
}

/// Converts a shape.
///
/// # Errors
/// If Parry lacks this kind of shape.
pub fn shape(shape: &Shape) -> Result<SharedShape, Unsupported> {
    Ok(match *shape {
        Shape::Box { half_extents: h } => SharedShape::cuboid(h.x, h.y, h.z),
        Shape::Sphere { radius } => SharedShape::ball(radius),
        Shape::Capsule { half_height, radius } => SharedShape::capsule_y(half_height, radius),
        Shape::TaperedCapsule { .. } => return Err(Unsupported::new("no tapered capsules")),
        Shape::Cylinder { half_height, radius } => SharedShape::cylinder(half_height, radius),
        Shape::Cone { half_height, radius } => SharedShape::cone(half_height, radius),
        Shape::Hull(ref hull) => {
            let corners: Vec<_> = hull.vertices().iter().copied().map(vector).collect();
            SharedShape::convex_hull(&corners).ok_or_else(|| Unsupported::new("a hull that Parry refuses"))?
        }
        Shape::HalfSpace => SharedShape::halfspace(Vector::Y),
        Shape::Mesh(_) | Shape::HeightField(_) => {
            let (vertices, triangles) = triangles(shape).expect("it has triangles");
            let vertices = vertices.into_iter().map(vector).collect();
            SharedShape::trimesh(vertices, triangles).expect("Parry accepts the mesh")
        }
    })
}
