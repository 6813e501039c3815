//! Sizes of shapes and depths of overlaps.

use super::exam::Exam;
use crate::filter::depth_of;
use crate::fit::stretched;
use sinew_math::{Transform, Vec3, max};
use sinew_physics::Shape;

/// Returns the full sizes of the box around a shape, along the shape's axes, metres.
pub(super) fn full_size(shape: &Shape) -> Vec3 {
    let aabb = shape.aabb(&Transform::IDENTITY);
    aabb.max - aabb.min
}

/// Returns the longest side of the box around a shape, metres.
pub(super) fn longest(shape: &Shape) -> f32 {
    let size = full_size(shape);
    max(size.x, max(size.y, size.z))
}

/// Returns the depth by which body `a`, moved to another pose, overlaps body `b`, metres; 0 if they do not overlap.
pub(super) fn depth_at(exam: &Exam<'_>, (a, place): (usize, Transform), b: usize) -> f32 {
    let (one, other) = (&exam.def.bodies[a], &exam.def.bodies[b]);
    depth_of((&one.shape, &place), (&other.shape, &other.character_from_body))
}

/// Returns the depth by which two bodies overlap in the bind pose, metres; 0 if they do not.
pub(super) fn depth(exam: &Exam<'_>, a: usize, b: usize) -> f32 {
    depth_at(exam, (a, exam.def.bodies[a].character_from_body), b)
}

/// Scales a shape by `factor`. Surfaces, which no ragdoll has, are unchanged.
pub fn scaled(shape: &Shape, factor: f32) -> Shape {
    match *shape {
        Shape::Box { half_extents } => Shape::Box { half_extents: half_extents * factor },
        Shape::Sphere { radius } => Shape::Sphere { radius: radius * factor },
        Shape::Capsule { half_height, radius } => {
            Shape::Capsule { half_height: half_height * factor, radius: radius * factor }
        }
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => Shape::TaperedCapsule {
            half_height: half_height * factor,
            radius_bottom: radius_bottom * factor,
            radius_top: radius_top * factor,
        },
        Shape::Cylinder { half_height, radius } => {
            Shape::Cylinder { half_height: half_height * factor, radius: radius * factor }
        }
        Shape::Cone { half_height, radius } => {
            Shape::Cone { half_height: half_height * factor, radius: radius * factor }
        }
        Shape::Hull(ref hull) => stretched(hull, Vec3::splat(factor)).unwrap_or_else(|| shape.clone()),
        Shape::HalfSpace | Shape::Mesh(_) | Shape::HeightField(_) => shape.clone(),
    }
}
