//! Reads and writes files as plain data: glTF, worlds, ragdolls, motion capture, MJCF, Jolt ragdolls.
//!
//! ```
//! use sinew_formats::{ReadOptions, no_files, read_gltf, write_gltf};
//!
//! let mannequin = sinew::mannequin::mannequin();
//! let bytes = write_gltf(&mannequin.rig, &mannequin.clips)?; // or those of a file
//! let document = read_gltf(&bytes, ReadOptions::default(), &mut no_files)?;
//! assert_eq!(document.rig.skins.len(), 1);
//! println!("{} clips", document.clips.len());
//! # Ok::<(), sinew_formats::Error>(())
//! ```
//!
//! [`load_gltf`] reads a character from disk, [`load_motion`] reads clips of any format, and [`append_clip`] writes a
//! clip back into the same file.
//!
//! All functions take bytes, and a closure for external files; only the feature `fs` (on by default) accesses the file
//! system. Input is untrusted: the result is a value or an [`Error`] with a location, never a panic, and memory is
//! proportional to the input.
#![forbid(unsafe_code)]

pub mod bvh;
mod container;
pub mod deepmimic;
mod error;
pub mod events;
#[cfg(feature = "fbx")]
pub mod fbx;
#[cfg(feature = "fs")]
pub mod fs;
pub mod gltf;
pub mod jolt;
mod material;
pub mod mesh;
pub mod mjcf;
pub mod motion;
pub mod obj;
mod parts;
pub mod physics_gltf;
pub mod ragdoll;
mod triangles;
pub mod urdf;
pub mod usd;
pub mod world;

pub use bvh::{BvhDocument, BvhEnds, BvhOptions, BvhText, BvhWriteOptions, read_bvh, write_bvh};
pub use deepmimic::{DeepMimicCharacter, DeepMimicClip, read_deepmimic, read_deepmimic_character};
pub use error::{Error, ErrorKind, Result};
pub use events::{events_extras, read_events, write_events};
#[cfg(feature = "fbx")]
pub use fbx::{read_fbx, read_fbx_with};
#[cfg(feature = "fs")]
pub use fs::{
    events_path, load_gltf, load_mesh, load_motion, load_world, read_bytes, settings_path, write_all_atomic,
    write_atomic,
};
pub use gltf::{
    Container, Document, KhrFile, NewClip, ReadOptions, Resolver, Textures, append_clip, append_clips,
    no_files, read_gltf, write_gltf, write_khr, write_motion,
};
pub use jolt::{JoltMotor, JoltRagdoll, read_jolt_animation, read_jolt_ragdoll};
pub use mesh::TriangleMesh;
pub use mjcf::{MjcfModel, MjcfRagdoll, MjcfText, read_mjcf, read_model, write_mjcf};
pub use motion::{MotionFile, MotionFormat, MotionOptions, read_motion};
pub use obj::read_obj;
pub use physics_gltf::read_physics_gltf;
pub use ragdoll::settings::read_ragdoll_settings;
pub use ragdoll::{read_ragdoll, write_ragdoll};
pub use urdf::read_urdf;
pub use usd::{UsdInput, UsdText, write_usda};
pub use world::{read_world, write_world};
