//! Limits inertias to the range that the solver supports.

use crate::tuning::LARGEST_MOMENTS;
use sinew_math::{Vec3, clamp, max, max3, min};
use sinew_physics::Shape;

/// Returns the principal moments of a homogeneous shape of this mass about its centre, along the shape's axes, kg·m².
pub fn of_shape(shape: &Shape, mass: f32) -> Vec3 {
    let unit = shape.mass_properties(1.0);
    unit.inertia.diagonal * (mass / unit.mass)
}

/// Returns principal moments adjusted for a solver: the smallest is at least an eighth of the largest, and none exceeds
/// the sum of the other two, as for real bodies.
pub fn conditioned(principal: Vec3) -> Vec3 {
    let largest = max(principal.x, max(principal.y, principal.z));
    let i = max3(principal, Vec3::splat(largest / LARGEST_MOMENTS));
    let need = |a: f32, b: f32, c: f32| max(0.0, 0.5 * (c - a - b));
    // Each of the two smaller moments gets half of the deficit; at most one of the three conditions can fail.
    let (x, y, z) = (need(i.y, i.z, i.x), need(i.x, i.z, i.y), need(i.x, i.y, i.z));
    i + Vec3::new(y + z, x + z, x + y)
}

/// Returns `p`, clamped to nine tenths of a box that the shape contains.
pub fn inside(shape: &Shape, p: Vec3) -> Vec3 {
    let reach = match *shape {
        Shape::Box { half_extents } => half_extents,
        Shape::Sphere { radius } => Vec3::splat(0.57 * radius),
        Shape::Capsule { half_height, radius } => {
            Vec3::new(0.6 * radius, half_height + 0.4 * radius, 0.6 * radius)
        }
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
            let radius = min(radius_bottom, radius_top);
            Vec3::new(0.6 * radius, half_height + 0.4 * radius, 0.6 * radius)
        }
        Shape::Cylinder { half_height, radius } => Vec3::new(0.7 * radius, half_height, 0.7 * radius),
        // Cone: use the box between the base and half of the height, and its mirror image.
        Shape::Cone { half_height, radius } => {
            Vec3::new(0.35 * radius, 0.0, 0.35 * radius) + Vec3::Y * (0.5 * half_height)
        }
        Shape::HalfSpace | Shape::Mesh(_) | Shape::HeightField(_) => Vec3::ZERO,
        // Hull: use the cube in the largest ball inside the hull.
        Shape::Hull(ref hull) => Vec3::splat(0.57 * hull.inner_radius()),
    } * 0.9;
    Vec3::new(clamp(p.x, -reach.x, reach.x), clamp(p.y, -reach.y, reach.y), clamp(p.z, -reach.z, reach.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditioned_moments_keep_ratio_and_triangle() {
        let i = conditioned(Vec3::new(1.0, 0.01, 1.2));
        assert!(i.y >= 0.15 && i.x + i.y >= i.z - 1e-6 && i.y + i.z >= i.x);
    }
}
