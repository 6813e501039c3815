//! The world: bodies, shapes, joints, particles and springs, in one deterministic step.
//!
//! SI units, radians, +Y up, right-handed, `f32`. Read [`step`] first: it is the physics, in order.
#![deny(unsafe_code)] // `slices` alone allows it

pub mod def;
pub mod field;
mod force;
pub mod stage;
pub mod step;
mod world;

pub mod collide;
pub mod cook;
mod finalize;
mod islands;
mod library;
mod pairs;
mod parted;
mod project;
mod sensors;
mod sleep;
mod solver;
mod tasks;
mod touch;
pub mod triangles;
mod update;

mod arena;
mod body;
pub mod boxes;
mod contact;
mod distance;
mod draw;
pub mod id;
pub mod joint;
mod mass;
pub mod object;
pub mod particles;
mod query;
pub mod ray;
pub mod runner;
pub mod shape;
mod slices;
mod snapshot;
mod spatial;

pub use body::Velocity;
pub use boxes::{Aabb, Obb};
pub use def::{BodyDef, BodyKind, Sleeping, WorldDef};
pub use draw::{DebugDraw, DrawKind};
pub use field::{
    Buoyancy, Drag, Explosion, Fade, FieldDef, FieldKind, FieldPoint, Gusts, MutualGravity, Occlusion,
    PointGravity, Region, UniformGravity, Wind,
};
pub use force::{ForceDef, ForceFrame, ForceId, Wrench};
pub use id::{BodyId, FieldId, GroupId, JointId, ObjectId};
pub use joint::Reaction;
pub use joint::def::{
    AxisMotion, Gains, JointCollision, JointDef, JointKind, JointState, Motor, SixDof, SoftZone, Softness,
    Spring, Strength,
};
pub use library::{DataKind, LoadError};
pub use object::{Corrections, Forces, PhysicsObject, Substep};
pub use query::{BodyHit, Energy, Momentum};
pub use runner::{Serial, TaskRunner, Threads};
pub use shape::{Filter, MassProperties, Material, Sensing, Shape, ShapeDef};
pub use touch::Events;
pub use triangles::{HeightField, HeightFieldDef, HeightFieldError, Mesh, MeshError};
pub use update::Update;
pub use world::World;
