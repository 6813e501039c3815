//! Integration tests: real files, hostile files, round trips.

mod append;
mod bvh;
mod data;
mod deepmimic;
#[cfg(feature = "fs")]
mod formats_table;
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
