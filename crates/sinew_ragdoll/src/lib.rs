//! From a rig to a ragdoll, and back to a clip. The only crate that knows physics **and** animation.
#![forbid(unsafe_code)]

pub mod build;
pub mod def;
pub mod filter;
pub mod fit;
pub mod limits;
pub mod masses;

pub use build::{BuildError, BuildOptions, BuildReport, build};
pub use def::{RagdollBodyDef, RagdollDef, RagdollJointDef};
pub use fit::ShapeChoice;
pub use masses::de_leva::Sex;
