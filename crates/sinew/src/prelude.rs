//! The names that most programs need: `use sinew::prelude::*`.

pub use sinew_anim::{Clip, Rig, analyze};
pub use sinew_math::{Range, Rotation, SwingTwistLimit, Transform, Vec3};
pub use sinew_physics::{
    BodyDef, BodyId, BodyKind, JointDef, JointId, JointKind, Material, Shape, ShapeDef, Velocity, World,
    WorldDef,
};
#[cfg(feature = "ragdoll")]
pub use sinew_ragdoll::{BuildOptions, Character, CharacterDef, Ragdoll, RagdollDef, build};
