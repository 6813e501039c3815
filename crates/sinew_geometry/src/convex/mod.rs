//! Queries of pairs of placed shapes, without a world: distance, depth, and casts.
//!
//! The queries work for every pair of bounded convex shapes, and for a half-space and a bounded convex shape. A solid
//! is a core with a radius. GJK finds the gap of separated cores, EPA the depth of overlapping cores. Both use `f64`,
//! so that results for shapes of 1 mm and 100 m are as precise as for shapes of equal size.
//!
//! ```
//! use sinew_math::{Rotation, Transform, Vec3};
//! use sinew_geometry::Shape;
//! use sinew_geometry::convex::{cast_shape, gap};
//!
//! let barrel = Shape::Cylinder { half_height: 0.5, radius: 0.3 };
//! let ball = Shape::Sphere { radius: 0.1 };
//! let above = Transform::from_translation(Vec3::new(0.0, 1.0, 0.0));
//! let between = gap(&barrel, &Transform::IDENTITY, &ball, &above).expect("both have an end");
//! assert!((between.distance - 0.4).abs() < 1e-6);
//!
//! let hit = cast_shape(&ball, &above, Vec3::new(0.0, -0.8, 0.0), &barrel, &Transform::IDENTITY);
//! assert!((hit.expect("the ball hits the lid").fraction - 0.5).abs() < 1e-6);
//! ```

mod cast;
mod epa;
pub mod feature;
mod gjk;
mod pair;
pub mod support;

pub use cast::{ShapeHit, cast_shape};
pub use cast::{advance, closeness};
pub use pair::{Gap, gap, overlaps};
pub use pair::{apart_along, meet};
