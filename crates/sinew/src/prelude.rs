//! The names that most programs need: `use sinew::prelude::*`.

pub use sinew_anim::{Clip, Rig, analyze};
pub use sinew_math::{Range, Rotation, SwingTwistLimit, Transform, Vec3};
pub use sinew_physics::{
    BodyDef, BodyId, BodyKind, Corrections, Forces, GroupId, JointDef, JointId, JointKind, Material,
    ObjectId, PhysicsObject, Shape, ShapeDef, Velocity, World, WorldDef,
};
#[cfg(feature = "ragdoll")]
pub use sinew_ragdoll::{BuildOptions, Character, CharacterDef, Ragdoll, RagdollDef, build};
