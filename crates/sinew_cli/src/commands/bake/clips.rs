//! Clips of a bake, and their roles.

use crate::commands::clip_choice::find_clip;
use crate::failure::{Failure, Result};
use crate::input::files::CharacterFile;
use crate::input::motion::Motion;
use crate::input::onto::carry;
use sinew::anim::Clip;
use sinew::anim::retarget::RetargetOptions;
use sinew::formats::bvh::BvhRows;
use sinew::formats::{BvhOptions, MotionOptions};
use sinew::motions::looped_among;
use std::path::{Path, PathBuf};

/// The motions of a character.
pub struct Motions {
    /// All clips: the file's own, then those of other files.
    pub clips: Vec<Clip>,
    /// The clip that plays until the fall.
    pub looped: Option<usize>,
    /// Repairs made on reading the other files, one sentence each.
    pub notes: Vec<String>,
}

/// Default name of the baked clip, with a number if the file has that name already. Clips of this name are not played
/// as motions unless requested.
pub const CLIP_NAME: &str = "sinew";

impl Motions {
    /// Clips of the character's file and of `others`; `wanted` is the user's choice.
    pub fn gather(file: &CharacterFile, others: &[PathBuf], wanted: Option<&str>) -> Result<Self> {
        let mut clips = file.document.clips.clone();
        let mut notes = Vec::new();
        for path in others {
            clips.extend(read_clips(path, file, &mut notes)?);
        }
        let looped = match wanted {
            Some(name) => {
                Some(find_clip(&clips, name).map_err(|what| Failure::at(&file.name, what, "--clip"))?)
            }
            None => looped_among(&file.document.rig, &file.analysis, &clips),
        };
        Ok(Self { clips, looped, notes })
    }
}

/// The clips of another file, retargeted to this character: by joint names, else by roles.
fn read_clips(path: &Path, file: &CharacterFile, notes: &mut Vec<String>) -> Result<Vec<Clip>> {
    // Plays the rows that exist, even if a BVH header declares more or fewer.
    let bvh = BvhOptions { rows: BvhRows::AsPresent, ..BvhOptions::default() };
    let motion = Motion::load(path, &MotionOptions { bvh, ..MotionOptions::default() })?;
    let rows = motion.file.notes.iter().filter(|note| note.contains(" frames, has "));
    notes.extend(rows.map(|note| format!("{}: {note}", motion.name)));
    let carried = carry(&motion, &file.document.rig, Some(&file.analysis), &RetargetOptions::default())?;
    if carried.is_empty() {
        return Err(Failure::of_file(&motion.name, "no clip that moves a joint of the character"));
    }
    Ok(carried.into_iter().map(|one| one.clip).collect())
}
