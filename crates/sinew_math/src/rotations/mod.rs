//! Rotations, and every other way to write one.

pub(crate) mod euler;
pub(crate) mod orthonormal;
pub(crate) mod quaternion;
pub(crate) mod rotation;
