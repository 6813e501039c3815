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

mod events;
mod filter;
mod finalize;
mod hits;
mod islands;
mod kept;
mod library;
mod meetings;
mod modifiers;
mod mover;
mod near;
mod pairs;
mod parted;
mod parts;
mod pool;
mod project;
mod proxies;
mod sensors;
mod sleep;
mod solver;
mod tasks;
mod touch;
mod update;

mod activity;
mod arena;
mod body;
mod contact;
mod contact_rule;
mod counts;
mod draw;
pub mod id;
pub mod joint;
mod kind;
mod material;
pub mod object;
pub mod particles;
pub mod query;
mod registered;
pub mod runner;
pub mod shape;
mod slices;
mod snapshot;
mod spatial;
mod surface;
mod work;

pub use sinew_geometry::{
    Aabb, DataKind, HeightField, HeightFieldDef, HeightFieldError, Hull, HullError, Mesh, MeshError, Obb,
    boxes, collide, convex, cook, hull, ray, triangles,
};
use sinew_geometry::{revolved, slabs, tree};

pub use body::Velocity;
pub use contact::Effect;
pub use contact_rule::{ContactModifier, ContactRule, ContactSide, FoundContact, OneWay};
pub use def::{BodyDef, BodyKind, Quality, SleepThresholds, Sleeping, WorldDef};
pub use draw::{DebugDraw, DrawKind};
pub use events::Events;
pub use field::{
    Buoyancy, Drag, Explosion, Fade, FieldDef, FieldKind, FieldPoint, Gusts, MutualGravity, Occlusion,
    PointGravity, Region, UniformGravity, Wind,
};
pub use filter::{PairFunction, PairSide};
pub use force::{ForceDef, ForceFrame, ForceId, Wrench};
pub use hits::Hit;
pub use id::{BodyId, FieldId, GroupId, JointId, MoverId, ObjectId, ShapeId};
pub use joint::Reaction;
pub use joint::def::{
    AxisMotion, Gains, JointCollision, JointDef, JointKind, JointState, Motor, SixDof, SoftZone, Softness,
    Spring, Strength,
};
pub use library::LoadError;
pub use material::{Combine, CombineRules, ContactMaterial, Material};
pub use mover::{Mover, MoverDef, MoverGround};
pub use object::{Corrections, Forces, PhysicsObject, Substep};
pub use query::{
    BodyHit, BodyKinds, BodyPenetration, BodySurface, ContainsPoint, Energy, Momentum, NearestTo,
    NearestToShape, OverlapWith, PenetrationOf, Probe, Query, QueryFilter, Question, Sensors, ShapeCast,
};
pub use runner::{Serial, TaskRunner, Threads};
pub use shape::{Filter, MassProperties, Sensing, Shape, ShapeDef};
pub use surface::{BodyContact, ContactPoint};
pub use update::Update;
pub use work::Work;
pub use world::World;
