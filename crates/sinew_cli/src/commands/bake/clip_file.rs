//! `-o OUT.(glb|vrm|bvh)`: the file for the clip.

use crate::failure::Result;
use crate::fall::Fall;
use crate::input::files::CharacterFile;
use crate::input::skeleton::{bones_only, lost_meshes, transform};
use sinew::formats::{BvhEnds, BvhWriteOptions, append_clip, write_bvh};
use sinew::math::Rotation;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Format of the clip's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClipFormat {
    /// A copy of the character's file with the clip added.
    Copy,
    /// The character's skeleton and the clip, with every frame.
    Bvh,
}

/// File to which the clip is written, and its format.
#[derive(Clone, Debug)]
pub struct ClipFile {
    path: PathBuf,
    /// Format of the file.
    pub format: ClipFormat,
}

impl ClipFile {
    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the file's bytes, and notes on what the format cannot represent, one sentence each.
    pub fn write(&self, file: &CharacterFile, fall: &Fall<'_>) -> Result<(Vec<u8>, Vec<String>)> {
        let written = match self.format {
            ClipFormat::Copy => append_clip(
                &file.document,
                &fall.baked.clip_for_file(&fall.input.character),
                fall.input.name,
                None,
            )
            .map(|bytes| (bytes, Vec::new())),
            ClipFormat::Bvh => skeleton(file, fall),
        };
        Ok(written.map_err(|error| error.with_file(&file.name))?)
    }
}

/// Bones in metres, with the rest pose as the offsets, and one row per frame.
fn skeleton(file: &CharacterFile, fall: &Fall<'_>) -> sinew::formats::Result<(Vec<u8>, Vec<String>)> {
    let rig = &file.document.rig;
    let (mut bones, mut clip, dropped) = bones_only(rig, &fall.baked.clip_for_file(&fall.input.character));
    let mut notes = Vec::new();
    lost_meshes(rig, &dropped, &mut notes);
    transform(&mut bones, &mut clip, Rotation::IDENTITY, file.analysis.unit_scale);
    let frame_time = 1.0 / f64::from(fall.input.fps);
    let options = BvhWriteOptions { frame_time, ends: BvhEnds::EveryChain, ..BvhWriteOptions::default() };
    let written = write_bvh(&bones, &clip, &options)?;
    notes.extend(written.notes);
    Ok((written.text.into_bytes(), notes))
}

impl FromStr for ClipFile {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let path = PathBuf::from(text);
        let extension =
            path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
        let format = match extension.as_deref() {
            Some("glb" | "vrm") => ClipFormat::Copy,
            Some("bvh") => ClipFormat::Bvh,
            _ => return Err("must end in .glb, .vrm or .bvh"),
        };
        Ok(Self { path, format })
    }
}
