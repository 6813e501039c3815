//! The world: bodies, shapes, joints, particles and springs, in one deterministic step.
//!
//! ```
//! use sinew_math::Vec3;
//! use sinew_physics::{BodyDef, Shape, World, WorldDef};
//!
//! let mut world = World::new(WorldDef::default());
//! world.add_body(&BodyDef::fixed(Shape::HalfSpace));
//! let ball = world.add_body(&BodyDef::dynamic(Shape::sphere(0.5)).at(Vec3::Y * 3.0)); // metres
//! (0..120).for_each(|_| world.step()); // 1/60 s each
//! assert!((world.transform(ball).translation.y - 0.5).abs() < 0.001, "it lies on the ground");
//! ```
//!
//! All calls are methods of [`World`]: bodies from a [`BodyDef`], joints from a [`JointDef`],
//! [queries](World::query), [events](World::events), [snapshots](World::save).
//!
//! SI units, radians, +Y up, right-handed, `f32`. Shapes are those of [`sinew_geometry`]. Read `step/mod.rs` first: it
//! runs the stages of a step in order.
#![deny(unsafe_code)] // `slices` alone allows it

pub mod field;
pub mod id;
pub mod joint;
pub mod particles;
pub mod query;
pub mod runner;
pub mod stage;
pub mod user_object;

mod activity;
mod arena;
mod body;
mod contact;
mod context;
mod draw;
mod island;
mod mover;
mod pool;
mod registered;
mod slices;
mod solver;
mod spatial;
mod step;
mod world;

pub use sinew_geometry::{
    Aabb, DataKind, DefError, HeightField, HeightFieldDef, HeightFieldError, Hull, HullError, MassProperties,
    Mesh, MeshError, Obb, Shape, boxes, collide, convex, cook, hull, ray, triangles,
};
use sinew_geometry::{revolved, slabs, tree};

pub use body::contact_rule::{ContactModifier, ContactRule, ContactSide, FoundContact, OneWay, Yields};
pub use body::def::{BodyDef, BodyKind, Quality, SleepThresholds, Sleeping, WorldDef};
pub use body::external_work::Work;
pub use body::force::{ForceDef, ForceFrame, ForceId, Wrench};
pub use body::library::LoadError;
pub use body::material::{Combine, CombineRules, ContactMaterial, Material};
pub use body::owner::Owner;
pub use body::shape::{Filter, Sensing, ShapeDef};
pub use body::{Velocity, def, shape};
pub use contact::Effect;
pub use contact::events::{Events, Push};
pub use contact::filter::{PairFunction, PairSide};
pub use contact::hits::Hit;
pub use draw::{DebugDraw, DrawKind};
pub use field::{
    Buoyancy, Drag, Explosion, Fade, FieldDef, FieldKind, FieldPoint, Gusts, MutualGravity, Occlusion,
    PointGravity, Region, UniformGravity, Wind,
};
pub use id::{BodyId, FieldId, GroupId, JointId, MoverId, ObjectId, ShapeId};
pub use joint::def::{
    AxisMotion, Gains, JointCollision, JointDef, JointKind, JointState, Motor, SixDof, SoftZone, Softness,
    Spring, Strength,
};
pub use mover::{Mover, MoverDef, MoverGround};
pub use query::{
    BodyHit, BodyKinds, BodyPenetration, BodySurface, ContainsPoint, Energy, Momentum, NearestTo,
    NearestToShape, OverlapWith, PenetrationOf, Probe, Query, QueryFilter, QueryKind, Sensors, ShapeCast,
};
pub use runner::{Serial, TaskRunner, Threads};
pub use user_object::{Corrections, Forces, PhysicsObject, Substep};
pub use world::{
    BodyContact, BodyRef, ContactPoint, LockedAxes, MassUpdate, Reaction, Snapshot, Update, World,
};
