//! Ragdolls and skeletal animations of Jolt Physics in its text object format (`.tof`): metres, +Y up.
//!
//! ```
//! let error = sinew_formats::read_jolt_ragdoll(b"TOS 1.00\n").expect_err("an empty file");
//! assert!(error.to_string().contains("RagdollSettings"), "{error}");
//! ```

mod clip;
mod objects;
mod ragdoll;
mod shape;

pub use clip::read_jolt_animation;
pub use ragdoll::{JoltMotor, JoltRagdoll, read_jolt_ragdoll};

/// True if the bytes start like a text object file.
pub(crate) fn is_jolt(bytes: &[u8]) -> bool {
    bytes.starts_with(b"TOS ")
}
