//! Physics of glTF files: a model that a world takes, or refused with a location.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_formats::read_physics_gltf;
use sinew_physics::{World, WorldDef};

fuzz_target!(|bytes: &[u8]| match read_physics_gltf(bytes) {
    Err(error) => assert!(!error.what.is_empty() && !error.where_.is_empty(), "{error}"),
    Ok(model) => drop(model.spawn(&mut World::new(WorldDef::default()))),
});
