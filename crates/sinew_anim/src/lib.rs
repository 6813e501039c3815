//! Animation as plain data and stateless jobs: rig, clips, poses, roles.
//!
//! Nothing here knows physics, files or a renderer. Rotations are [`sinew_math::Rotation`], times are seconds, lengths
//! are **file units** until [`roles`](crate::roles) has told how many metres one is.
#![forbid(unsafe_code)]

pub mod clip;
pub mod rig;

pub use clip::{Channel, Clip, Interpolation, Property};
pub use rig::{Joint, JointIdx, LocalTransform, Mesh, Primitive, Rig, Skin, Texture};
