//! Particles, cloth, blobs.

pub(super) mod blobs;
pub(super) mod cloths;
pub(super) mod single;
