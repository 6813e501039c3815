//! Files that are not part of the repository, where they are present.

use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The folder of test data beside the workspace, or a note on why the test does nothing.
pub fn shared_data() -> Option<PathBuf> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
    if folder.is_dir() {
        return Some(folder.to_path_buf());
    }
    // Not println, which the harness swallows where a test passes.
    let test = std::thread::current().name().unwrap_or("a test").to_owned();
    let _ = writeln!(std::io::stderr(), "{test} skipped: no ../shared/data");
    None
}

/// Every file below `folder` with one of these extensions, in a fixed order.
pub fn files(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().and_then(|e| e.to_str()).is_some_and(|e| extensions.contains(&e)) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Extensions of glTF and its relatives.
pub const GLTF: [&str; 4] = ["glb", "gltf", "vrm", "vrma"];
