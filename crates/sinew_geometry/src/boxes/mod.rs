//! Boxes, axis-aligned and oriented: queries of points, overlaps and rays, bounds and fits, without a world.
//!
//! Lengths are metres; all positions are in one common space. Boxes are closed sets: touching boxes overlap, and a box
//! contains the points on its surface. Sides may be 0: such a box is a rectangle, a segment or a point.
//!
//! ```
//! use sinew_math::{Rotation, Vec3};
//! use sinew_geometry::boxes::{Aabb, Cuboid, Obb, Overlap, Sphere};
//!
//! let plank = Obb::new(Vec3::Y, Rotation::from_axis_angle(Vec3::Z, 0.5), Vec3::new(2.0, 0.1, 0.5));
//! let way = plank.point_penetration(Vec3::Y).expect("the point is inside");
//! assert!((way.depth - 0.1).abs() < 1e-6);
//! assert!(plank.overlaps(&Sphere::new(Vec3::new(0.0, 2.0, 0.0), 0.9)));
//! assert!(plank.bounds().volume() > 5.0 * plank.volume());
//! assert!(Aabb::around(Vec3::ZERO, Vec3::splat(0.5)).penetration(&plank).is_none());
//! ```
//!
//! # Contents
//! The trait [`Cuboid`] has the queries of one box: points, rays, volume and mass. The trait [`Overlap`] tests pairs.
//! `fit.rs` fits boxes around points; `frustum.rs` culls and picks.
//!
//! # Separating axes
//! The separating axis test is implemented several times, because each implementation is the fastest for its query:
//! - `fifteen.rs` only decides whether two boxes overlap, without square roots, for one pair or for eight at a time;
//! - `separation.rs` finds the best axis of one pair, for manifolds and depths, and skips edges by an estimate; the
//!   manifold code tests the cached axis first and stops at the first axis that separates;
//! - `batch/separation.rs` finds the best axis of eight pairs with SIMD: without early exit, in the frame of A, which
//!   is cheaper to set up than axes in the world;
//! - `collide/polytope.rs` is for hulls: two hulls may have thousands of pairs of edges, and arcs on the Gauss map
//!   (Gregorius, GDC 2013) select those that are faces of the Minkowski difference.
//!
//! Tests compare all of them with brute force in `f64`.
//!
//! # Formulas
//! - A point `p` in a box with centre `c`, axes `aₖ` and half extents `hₖ`: `qₖ = (p − c)·aₖ`, inside if all `|qₖ| ≤
//!   hₖ`; the closest point clamps `q` to `±h` (Ericson, "Real-Time Collision Detection", 2005, §5.1.3).
//! - Two boxes: 15 separating axes, three faces of each and nine crossed edges (Gottschalk, Lin & Manocha, "OBBTree",
//!   SIGGRAPH 1996); overlap without square roots (Ericson 2005, §4.4.1), depth by the least overlap along one of them.
//! - A ball: the signed distance of its centre minus the radius. A capsule: the distance of its core to the box; if the
//!   core has entered the box, the least overlap along three faces and three crossed edges.
//! - Rays: slabs (Kay & Kajiya, SIGGRAPH 1986).
//!
//! # Precision
//! All results are computed relative to a box's centre, so that the error is a few `f32` roundings (6e-8) of the sizes
//! and distances. Precision far from the origin is limited by the positions themselves: 0.06 mm at 1 km, 8 mm at 100
//! km.
//!
//! Separated boxes closer than 5e-7 of their sizes and distance count as touching. Edges within 0.1° of parallel define
//! no reliable direction: boxes separated only along such a direction, by up to 0.2 % of their sizes and distance,
//! count as touching, and their depth is overestimated by up to the same amount. Points, balls and capsules are
//! compared without tolerance.

use sinew_math::Vec3;

mod aabb;
pub mod batch;
mod cuboid;
mod depth;
mod fifteen;
mod fit;
mod frustum;
mod obb;
mod overlap;
pub(crate) mod placed;
mod point;
pub(crate) mod segment;
pub(crate) mod separation;

pub use aabb::{Aabb, HALF_SPACE_REACH};
pub use cuboid::Cuboid;
pub use frustum::{Frustum, Visibility, pick};
pub use obb::Obb;
pub use overlap::{Capsule, Overlap, Sphere};
pub use placed::PlacedBox;
pub use point::{Penetration, SurfacePoint};
pub(crate) use point::{box_distance, distance_beyond};
pub use separation::AxisOf;

/// Checks the half extents of a box.
///
/// # Panics
/// If a half extent is negative or not finite.
fn expect_half_extents(half: Vec3) {
    assert!(
        half.is_finite() && half.cmpge(Vec3::ZERO).all(),
        "the half extents of a box must be finite and not negative"
    );
}
