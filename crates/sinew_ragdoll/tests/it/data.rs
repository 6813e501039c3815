//! Shared test data beside the repository.

use sinew_anim::Rig;
use sinew_formats::{Document, ReadOptions, load_gltf};
use std::path::Path;

const RIGS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/rigs");

/// Returns true if the shared data are present, for tests that also use rigs of the repository.
pub fn is_there() -> bool {
    Path::new(RIGS).is_dir()
}

/// Returns a rig of the shared data, for tests with `needs_data`.
pub fn rig(name: &str) -> Rig {
    document(name).rig
}

/// Returns a file of the shared rigs, for tests with `needs_data`.
pub fn document(name: &str) -> Document {
    let document = load_gltf(Path::new(RIGS).join(name), ReadOptions::default());
    document.unwrap_or_else(|error| panic!("{name}: {error}"))
}
