//! Files that lie beside the repository.

use sinew_anim::Rig;
use sinew_formats::{Document, ReadOptions, load_gltf};
use std::path::Path;

const RIGS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/rigs");

/// True where the shared data are present: for tests that also have rigs of their own.
pub fn is_there() -> bool {
    Path::new(RIGS).is_dir()
}

/// A rig of the shared data, for tests with `needs_data`.
pub fn rig(name: &str) -> Rig {
    document(name).rig
}

/// A file of the shared rigs, likewise.
pub fn document(name: &str) -> Document {
    let document = load_gltf(Path::new(RIGS).join(name), ReadOptions::default());
    document.unwrap_or_else(|error| panic!("{name}: {error}"))
}
