//! Reading and writing what commands work on.

use crate::failure::{Failure, Result};
use sinew::anim::{RigAnalysis, analyze};
use sinew::formats::{Document, ReadOptions, Textures, load_gltf, write_all_atomic};
use std::path::{Path, PathBuf};

/// A character file: what it holds, and what its joints are.
pub struct CharacterFile {
    /// As the user named it.
    pub name: String,
    /// Its rig, clips and JSON.
    pub document: Document,
    /// What its joints are.
    pub analysis: RigAnalysis,
}

impl CharacterFile {
    /// Reads a file that has to hold a skinned character.
    pub fn load(path: &Path, textures: Textures) -> Result<Self> {
        let document = load_gltf(path, ReadOptions { textures })?;
        let name = path.display().to_string();
        match analyze(&document.rig) {
            Ok(analysis) => Ok(Self { name, document, analysis }),
            Err(no_skin) => Err(Failure::of_file(name, no_skin)),
        }
    }
}

/// Files that are written together: all of them, or none.
#[derive(Debug, Default)]
pub struct Outputs {
    files: Vec<(PathBuf, Vec<u8>)>,
}

impl Outputs {
    /// One more file, of these bytes.
    pub fn add(&mut self, path: &Path, bytes: Vec<u8>) {
        self.files.push((path.to_path_buf(), bytes));
    }

    /// Writes them. Each is there as a whole or not at all; none appears before all are on the disk.
    pub fn write(&self) -> Result<()> {
        Ok(write_all_atomic(&self.files)?)
    }
}
