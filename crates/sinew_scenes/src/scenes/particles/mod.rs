//! Particles, cloth, blobs.

pub(super) mod bearing;
pub(super) mod blobs;
pub(super) mod cloths;
pub(super) mod folded;
pub(super) mod rope_bridge;
pub(super) mod sheets;
pub(super) mod single;
