//! Boxes, axis-aligned and oriented: points, overlaps, rays, bounds and fits, without a world.
//!
//! Lengths are metres, all positions are in one common space (the world's, or any other). Boxes are closed sets: what
//! touches overlaps, a point on the surface is contained. Sides may be 0: such a box is a rectangle, a segment or a point.
//!
//! # Precision
//! Everything is computed relative to a box's centre, so that the error is a few `f32` roundings (6e-8) of the sizes and
//! distances at hand. What is lost far from the origin is lost in the positions themselves: 1 km away they are 0.06 mm
//! apart, 100 km away 8 mm.

use sinew_math::Vec3;

mod aabb;
pub mod batch;
mod cuboid;
mod obb;
mod overlap;
pub(crate) mod placed;
mod point;
pub(crate) mod segment;
pub(crate) mod separation;
mod world;

pub use aabb::{Aabb, HALF_SPACE_REACH};
pub use cuboid::Cuboid;
pub use obb::Obb;
pub use overlap::{Capsule, Overlap, Sphere};
pub use placed::PlacedBox;
pub use point::{Penetration, SurfacePoint};

/// # Panics
/// If one is negative or not finite.
fn expect_half_extents(half: Vec3) {
    assert!(
        half.is_finite() && half.cmpge(Vec3::ZERO).all(),
        "half extents of a box are finite and not negative"
    );
}
