//! Shapes without a world: masses, distances, contacts and casts, with the same bits on every machine.
//!
//! The crate has no bodies, materials or steps, only functions of shapes and frames. Lengths are metres, angles
//! radians, axes right-handed; a frame is a [`Transform`](sinew_math::Transform), and numbers are `f32` unless noted.
//!
//! ```
//! use sinew_geometry::collide::{Manifold, collide};
//! use sinew_geometry::{Obb, Shape, boxes::Overlap, convex};
//! use sinew_math::{Rotation, Transform, Vec3};
//!
//! // Do two boxes overlap, and what is the shortest way out?
//! let a = Obb::new(Vec3::ZERO, Rotation::IDENTITY, Vec3::new(1.0, 0.5, 0.5));
//! let b = Obb::new(Vec3::new(0.0, 0.9, 0.0), Rotation::from_axis_angle(Vec3::Y, 0.5), Vec3::splat(0.5));
//! let way = a.penetration(&b).expect("the boxes overlap");
//! assert!((way.depth - 0.1).abs() < 1e-6 && way.direction == Vec3::Y);
//!
//! // Where do they touch? A face on a face: four points, their normal from A to B.
//! let [slab, cube] = [a, b].map(|obb| Shape::Box { half_extents: obb.half_extents });
//! let mut manifold = Manifold::default();
//! collide(&slab, &a.to_transform(), &cube, &b.to_transform(), 0.02, &mut manifold);
//! assert_eq!((manifold.count, manifold.normal), (4, Vec3::Y));
//! assert!(manifold.points().iter().all(|point| (point.separation + 0.1).abs() < 1e-6));
//!
//! // How far is a ball from a capsule, and what does the capsule weigh as steel?
//! let capsule = Shape::Capsule { half_height: 0.5, radius: 0.2 };
//! let ball = Shape::Sphere { radius: 0.1 };
//! let beside = Transform::from_translation(Vec3::X);
//! let gap = convex::gap(&capsule, &Transform::IDENTITY, &ball, &beside).expect("both have an end");
//! assert!((gap.distance - 0.7).abs() < 1e-6);
//! assert!((capsule.mass_properties(7850.0).mass - 1249.5).abs() < 0.1);
//! ```
//!
//! # Modules
//! | module | contents |
//! |---|---|
//! | [`Shape`] | the kinds of solids and surfaces; volume, [mass properties](Shape::mass_properties), bounds, distances of points |
//! | [`boxes`] | [`Aabb`] and [`Obb`]: points, overlaps, depths, rays, fits, frustum culling |
//! | [`boxes::batch`] | the same for thousands of boxes or points, eight at a time |
//! | [`collide`] | contact [manifolds](collide::Manifold) of any two shapes, with feature ids that last from step to step |
//! | [`convex`] | [gap](convex::gap), overlap and [cast](convex::cast_shape) of any two convex shapes: GJK and EPA in `f64` |
//! | [`ray`] | rays against every shape, exactly |
//! | [`hull`] | convex [hulls](Hull) of points: quickhull on a grid, exact decisions |
//! | [`triangles`] | one-sided triangle [meshes](Mesh) and [height fields](HeightField) |
//! | [`tree`] | bounding-volume trees with eight boxes in a node: overlaps, rays and sweeps, nearest |
//! | [`cook`](cook::cook) | conversion of a triangle mesh to a few oriented boxes |
//! | [`submerged`] | the part of a shape below a plane |
//! | [`revolved`], [`slabs`] | solids of revolution; lines through boxes, one or eight at a time |
//!
//! # Measurements
//! Overlap of two boxes, in milliseconds for 4,096 pairs in the cache and for 10,000 pairs from memory, with AVX2, next
//! to the separating axis test of `parry3d` 0.31 (`obb_tests` and `obb_tests_streamed` of `docs/benchmarks.md`):
//!
//! | | Sinew | `parry3d` | |
//! |---|---:|---:|---:|
//! | in the cache | 0.029 | 1.00 | 35× |
//! | from memory | 0.123 | 3.42 | 28× |
//!
//! Manifolds of 4,096 random pairs without a cache, in nanoseconds per pair, one thread (`cargo run --release --bin
//! manifolds` in `bench/kernels`). Hulls and cylinders are slower than Parry's:
//!
//! | | Sinew | `parry3d` | |
//! |---|---|---|---|
//! | box and box | 288 | 656 | 2.3× |
//! | box and ball | 28 | 79 | 2.8× |
//! | box and capsule | 108 | 1,148 | 11× |
//! | capsule and capsule | 77 | 85 | 1.1× |
//! | ball and cylinder | 45 | 70 | 1.6× |
//! | ball and hull | 1,256 | 1,141 | 0.9× |
//! | box and hull | 3,994 | 3,005 | 0.8× |
//! | box and cylinder | 7,030 | 4,711 | 0.7× |
//! | capsule and hull | 4,089 | 1,448 | 0.35× |
//! | hull and hull | 8,296 | 2,437 | 0.3× |
//!
//! # Same bits
//! Every result has the same bits on every target, at every optimisation level and with any SIMD width, alone or in a
//! batch. NaN and infinities never cause a panic; each function documents its result for them.
#![forbid(unsafe_code)]

mod bounds;
pub mod boxes;
pub mod collide;
pub mod convex;
pub mod cook;
mod data;
mod def_error;
mod distance;
pub mod hull;
mod mass;
pub mod ray;
pub mod revolved;
#[cfg(feature = "serde")]
mod serial;
mod shape;
pub mod slabs;
pub mod submerged;
pub mod tree;
pub mod triangles;

pub use boxes::{Aabb, Obb};
pub use data::DataKind;
pub use def_error::DefError;
pub use hull::{Hull, HullError};
pub use shape::{MassProperties, Shape};
pub use triangles::{HeightField, HeightFieldDef, HeightFieldError, Mesh, MeshError};
