//! Names that most programs need: `use bevy_sinew::prelude::*`. They do not collide with those of `bevy::prelude`.

#[cfg(feature = "mesh")]
pub use crate::MeshCollider;
#[cfg(feature = "characters")]
pub use crate::{BevyAnimation, CharacterBody, CharacterHandle, CharacterTold};
pub use crate::{
    BodyHandle, Collider, ConstantForce, Damping, Field, FieldDef, FieldKind, Friction, GravityScale,
    HitTold, Interpolation, Joint, JointHandle, JointKind, JointMotor, Layers, Locked, Mass, Mover, MoverDef,
    MoverState, Physics, PhysicsSystems, Restitution, RigidBody, Sensor, SensorEntered, SensorLeft, Shape,
    ShapeDef, SinewPlugin, TouchBegan, TouchEnded, Velocity, Walk,
};
#[cfg(feature = "gltf")]
pub use crate::{CharacterScene, SinewGltfPlugin};
pub use sinew_physics::{LockedAxes, Motor};
