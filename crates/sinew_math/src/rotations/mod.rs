//! Rotations as quaternions, Euler angles and matrices.

pub(crate) mod euler;
pub(crate) mod orthonormal;
pub(crate) mod quaternion;
pub(crate) mod rotation;
