//! Makes shapes thinner.

use crate::fit::stretched;
use sinew_math::Vec3;
use sinew_physics::Shape;

/// Returns a shape with its cross-section scaled by `factor`; its length along y does not change.
pub(super) fn thinner(shape: &Shape, factor: f32) -> Shape {
    match shape {
        Shape::Box { half_extents: h } => {
            Shape::Box { half_extents: Vec3::new(h.x * factor, h.y, h.z * factor) }
        }
        Shape::Capsule { half_height, radius } => {
            let thin = radius * factor;
            Shape::Capsule { half_height: half_height + (radius - thin), radius: thin }
        }
        Shape::Sphere { radius } => Shape::Sphere { radius: radius * factor },
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
            let [low, high] = [radius_bottom * factor, radius_top * factor];
            // Both ends keep their positions.
            let half_height = half_height + 0.5 * (radius_bottom - low + radius_top - high);
            Shape::TaperedCapsule { half_height, radius_bottom: low, radius_top: high }
        }
        Shape::Cylinder { half_height, radius } => {
            Shape::Cylinder { half_height: *half_height, radius: radius * factor }
        }
        Shape::Cone { half_height, radius } => {
            Shape::Cone { half_height: *half_height, radius: radius * factor }
        }
        Shape::Hull(hull) => stretched(hull, Vec3::new(factor, 1.0, factor)).unwrap_or_else(|| shape.clone()),
        // No fit has one of these shapes.
        Shape::HalfSpace | Shape::Mesh(_) | Shape::HeightField(_) => shape.clone(),
    }
}
