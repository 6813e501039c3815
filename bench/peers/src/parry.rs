//! Shapes and poses as Parry wants them: Rapier collides with it, and for every engine it judges penetration.

use parry3d::math::{Pose, Rotation as ParryRotation, Vector};
use parry3d::shape::SharedShape;
use sinew::math::{Rotation, Transform, Vec3};
use sinew::physics::Shape;

/// The same point or direction.
pub fn vector(v: Vec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

/// The same point or direction.
pub fn from_vector(v: Vector) -> Vec3 {
    Vec3::new(v.x, v.y, v.z)
}

/// The same rotation.
pub fn rotation(q: Rotation) -> ParryRotation {
    ParryRotation::from_xyzw(q.x, q.y, q.z, q.w)
}

/// The same motion.
pub fn pose(t: Transform) -> Pose {
    Pose::from_parts(vector(t.translation), rotation(t.rotation))
}

/// The same motion.
pub fn from_pose(pose: &Pose) -> Transform {
    let q = pose.rotation;
    Transform::new(from_vector(pose.translation), Rotation::from_xyzw(q.x, q.y, q.z, q.w))
}

/// The same shape.
pub fn shape(shape: &Shape) -> SharedShape {
    match *shape {
        Shape::Box { half_extents: h } => SharedShape::cuboid(h.x, h.y, h.z),
        Shape::Sphere { radius } => SharedShape::ball(radius),
        Shape::Capsule { half_height, radius } => SharedShape::capsule_y(half_height, radius),
        Shape::HalfSpace => SharedShape::halfspace(Vector::Y),
    }
}
