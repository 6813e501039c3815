//! Integration tests with real files, malicious files and round trips.

mod append;
mod bvh;
mod data;
mod deepmimic;
mod draco;
mod events;
#[cfg(feature = "fbx")]
mod fbx;
#[cfg(feature = "fbx")]
mod fbx_file;
#[cfg(feature = "fs")]
mod formats_table;
#[cfg(feature = "fs")]
mod fs;
mod geometry;
mod hostile;
mod jolt;
mod mended;
mod meshopt;
mod meshopt_encoder;
mod mjcf;
mod motion;
mod obj;
mod ragdoll;
mod ragdoll_settings;
mod rigs;
mod springs;
mod world;
mod write;
