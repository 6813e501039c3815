//! Files that lie beside the repository.

use sinew_anim::Rig;
use sinew_formats::{ReadOptions, load_gltf};
use std::path::PathBuf;

/// A rig of the shared data; `None`, with a line that says so, where the data are not there.
pub fn rig(name: &str) -> Option<Rig> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/rigs"));
    if !folder.is_dir() {
        println!("skipped: no ../shared/data");
        return None;
    }
    let document = load_gltf(folder.join(name), ReadOptions::default());
    Some(document.unwrap_or_else(|error| panic!("{name}: {error}")).rig)
}
