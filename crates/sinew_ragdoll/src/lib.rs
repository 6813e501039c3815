//! From a rig to a ragdoll, and back to a clip. The only crate that knows physics **and** animation.
#![forbid(unsafe_code)]

pub mod def;

pub use def::{RagdollBodyDef, RagdollDef, RagdollJointDef};
