//! Integration tests: real files, hostile files, round trips.

mod append;
mod data;
#[cfg(feature = "fs")]
mod fs;
mod geometry;
mod hostile;
mod mjcf;
mod obj;
mod ragdoll;
mod rigs;
mod world;
mod write;
