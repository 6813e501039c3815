//! Rotations in all representations.

pub(crate) mod euler;
pub(crate) mod orthonormal;
pub(crate) mod quaternion;
pub(crate) mod rotation;
