//! Convex hulls: made from clouds of points, against brute force in `f64`, in worlds and in bytes. A hundredth of the random
//! cases unless `SINEW_FULL` is set, as `cargo xtask ci --full` does.

mod bytes;
mod clouds;
mod mass;
mod pairs;
mod stacks;

use sinew_math::{Random, Vec3};
use sinew_physics::{Hull, Shape};
use std::sync::Arc;

/// Of `all` cases those that are run.
fn cases(all: u32) -> u32 {
    if std::env::var_os("SINEW_FULL").is_some() { all } else { all / 100 }
}

fn hull_of(points: &[Vec3]) -> Arc<Hull> {
    Arc::new(Hull::new(points).expect("a solid"))
}

fn corners(half: Vec3) -> Vec<Vec3> {
    let side = |bits: u32, k: u32| if bits >> k & 1 == 1 { 1.0 } else { -1.0 };
    (0..8).map(|bits| half * Vec3::new(side(bits, 0), side(bits, 1), side(bits, 2))).collect()
}

/// The box of these half extents as a hull.
fn box_hull(half: Vec3) -> Shape {
    Shape::Hull(hull_of(&corners(half)))
}

/// A hull of 5 to 40 points on a stretched ball of about the given radius.
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
