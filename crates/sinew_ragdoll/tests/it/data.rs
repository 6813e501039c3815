//! Files that lie beside the repository.

use sinew_anim::Rig;
use sinew_formats::{Document, ReadOptions, load_gltf};
use std::io::Write as _;
use std::path::PathBuf;

/// A rig of the shared data; `None`, with a line that says so, where the data are not there.
pub fn rig(name: &str) -> Option<Rig> {
    document(name).map(|document| document.rig)
}

/// A file of the shared rigs, likewise.
pub fn document(name: &str) -> Option<Document> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/rigs"));
    if !folder.is_dir() {
        // Not println, which the harness swallows where a test passes.
        let test = std::thread::current().name().unwrap_or("a test").to_owned();
        let _ = writeln!(std::io::stderr(), "{test} skipped: no ../shared/data");
        return None;
    }
    let document = load_gltf(folder.join(name), ReadOptions::default());
    Some(document.unwrap_or_else(|error| panic!("{name}: {error}")))
}
