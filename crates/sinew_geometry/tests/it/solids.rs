//! Hulls for tests.

use sinew_geometry::{Hull, Shape};
use sinew_math::{Random, Vec3};
use std::sync::Arc;

/// Returns the hull of points that span a solid.
pub fn hull_of(points: &[Vec3]) -> Arc<Hull> {
    Arc::new(Hull::new(points).expect("a solid"))
}

/// Returns the corners of a box around the origin.
pub fn corners(half: Vec3) -> Vec<Vec3> {
    let side = |bits: u32, k: u32| if bits >> k & 1 == 1 { 1.0 } else { -1.0 };
    (0..8).map(|bits| half * Vec3::new(side(bits, 0), side(bits, 1), side(bits, 2))).collect()
}

/// Returns the box of these half extents as a hull.
pub fn box_hull(half: Vec3) -> Shape {
    Shape::Hull(hull_of(&corners(half)))
}

/// Returns a hull of 5 to 40 points on a stretched ball of about the given radius.
pub fn pebble(radius: f32, random: &mut Random) -> Shape {
    let stretch = Vec3::new(1.0, random.range(0.5, 1.0), random.range(0.4, 1.0)) * radius;
    let count = 5 + random.index(36);
    loop {
        let points: Vec<Vec3> = (0..count).map(|_| random.direction() * stretch).collect();
        if let Ok(hull) = Hull::new(&points)
            && hull.inner_radius() > 0.1 * radius
        {
            return Shape::Hull(Arc::new(hull));
        }
    }
}
