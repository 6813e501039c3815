//! Motion without contacts and joints: throws, orbits, spinning bodies, forces, rotations.

pub(super) mod ballistics;
pub(super) mod forces;
pub(super) mod gimbal;
pub(super) mod orbits;
pub(super) mod orientation;
pub(super) mod tops;
pub(super) mod weightless;
