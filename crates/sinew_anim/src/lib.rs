//! Animation as plain data and stateless jobs: rig, clips, poses, roles, captured motion.
//!
//! Nothing here knows physics, files or a renderer. Rotations are [`sinew_math::Rotation`], times are seconds, lengths
//! are **file units** until [`roles`] has told how many metres one is.
#![forbid(unsafe_code)]

pub mod cleanup;
pub mod clip;
pub mod contact;
pub mod ik;
pub mod learned_limits;
pub mod legs;
pub mod pose;
pub mod retarget;
pub mod rig;
pub mod roles;
pub mod sample;
pub mod skinning;
pub mod take;

pub use clip::{Channel, Clip, Interpolation, Property};
pub use contact::FootContact;
pub use pose::{
    JointVelocity, WeightedPose, blend, crossfade, joint_velocities, local_to_model, rest_pose, smoothstep,
};
pub use rig::{Joint, JointIdx, LocalTransform, Mesh, Primitive, Rig, Skin, Texture};
pub use roles::{KeptBone, NoSkin, RigAnalysis, Role, RoleGuess, Side, analyze, analyze_skeleton};
pub use sample::{SampleCache, Wrap, sample, sample_cached};
pub use skinning::{skin_palette, skin_vertices};
pub use take::Take;
