//! Files next to a character's file, as evidence for its unit.

use sinew::anim::analyze;
use sinew::formats::{ReadOptions, Textures, load_gltf};
use std::path::{Path, PathBuf};

/// Largest number of files read, and their largest size, bytes.
const MOST: usize = 6;
const LARGEST: u64 = 16 << 20;

/// Returns the units, metres, of neighbouring files of the same kind whose unit is unambiguous; the first few by
/// name. Ignores unreadable files.
pub fn units_beside(path: &Path) -> Vec<f32> {
    let folder = match path.parent() {
        Some(folder) if folder.as_os_str().is_empty() => Path::new("."),
        Some(folder) => folder,
        None => return Vec::new(),
    };
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let extension = path.extension();
    let is_kin = |other: &PathBuf| {
        other.extension() == extension
            && other.file_name() != path.file_name()
            && other.metadata().is_ok_and(|data| data.is_file() && data.len() <= LARGEST)
    };
    let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).filter(is_kin).collect();
    files.sort();
    files.truncate(MOST);
    files.iter().filter_map(|file| unit_of(file)).collect()
}

fn unit_of(file: &Path) -> Option<f32> {
    let document = load_gltf(file, ReadOptions { textures: Textures::Skip }).ok()?;
    let analysis = analyze(&document.rig).ok()?;
    analysis.unit_guess.filter(|guess| guess.is_only).map(|_| analysis.unit_scale)
}
