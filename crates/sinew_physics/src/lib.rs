//! The world: bodies, shapes, joints, particles and springs, in one deterministic step.
//!
//! SI units, radians, +Y up, right-handed, `f32`. Read [`step`](crate::step) first: it is the physics, in order.
#![forbid(unsafe_code)]

pub mod aabb;
pub mod collide;
pub mod def;
mod distance;
pub mod id;
mod mass;
pub mod ray;
pub mod shape;

pub use def::{BodyDef, BodyKind, JointCollision, JointDef, JointKind, WorldDef};
pub use id::{BodyId, JointId};
pub use shape::{Filter, MassProperties, Material, Shape, ShapeDef};
