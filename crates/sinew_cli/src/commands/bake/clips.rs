//! Clips of a bake, and the use of each.

use crate::commands::clip_choice::find_clip;
use crate::failure::{Failure, Result};
use crate::input::files::CharacterFile;
use crate::input::motion::Motion;
use crate::input::onto::carry;
use sinew::anim::Clip;
use sinew::anim::retarget::RetargetOptions;
use sinew::formats::MotionOptions;
use std::path::{Path, PathBuf};

/// The motions of a character.
pub struct Motions {
    /// All clips: those of its own file, then those of others.
    pub clips: Vec<Clip>,
    /// The clip that plays until the fall.
    pub looped: Option<usize>,
}

/// Name of a clip that is baked, where the user does not say it; with a number where the file has that already. None of them is
/// played until the next fall unless it is asked for.
pub const CLIP_NAME: &str = "sinew";

/// Names of clips that get a body up, without case, blanks, `-` and `_`: none to play until the fall.
const GET_UP_NAMES: [&str; 3] = ["getup", "standup", "gettingup"];

impl Motions {
    /// From the character's file and from `others`; `wanted` is the user's choice of a clip.
    pub fn gather(file: &CharacterFile, others: &[PathBuf], wanted: Option<&str>) -> Result<Self> {
        let mut clips = file.document.clips.clone();
        for path in others {
            clips.extend(read_clips(path, file)?);
        }
        let plain: Vec<String> = clips.iter().map(|clip| plain(&clip.name)).collect();
        let is_get_up = |index: &usize| GET_UP_NAMES.iter().any(|name| plain[*index].contains(name));
        let is_baked = |index: &usize| {
            let number = plain[*index].strip_prefix(CLIP_NAME);
            number.is_some_and(|number| number.chars().all(|c| c.is_ascii_digit()))
        };
        let looped = match wanted {
            Some(name) => {
                Some(find_clip(&clips, name).map_err(|what| Failure::at(&file.name, what, "--clip"))?)
            }
            None => {
                let called = |word: &str| plain.iter().position(|name| name.contains(word));
                let first = (0..clips.len()).find(|index| !is_get_up(index) && !is_baked(index));
                called("walk").or_else(|| called("idle")).or(first)
            }
        };
        Ok(Self { clips, looped })
    }
}

fn plain(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, ' ' | '_' | '-')).flat_map(char::to_lowercase).collect()
}

/// The clips of another file, on this character: by the names of joints, else by roles.
fn read_clips(path: &Path, file: &CharacterFile) -> Result<Vec<Clip>> {
    let motion = Motion::load(path, &MotionOptions::default())?;
    let carried = carry(&motion, &file.document.rig, Some(&file.analysis), &RetargetOptions::default())?;
    if carried.is_empty() {
        return Err(Failure::of_file(&motion.name, "no clip that moves a joint of the character"));
    }
    Ok(carried.into_iter().map(|one| one.clip).collect())
}
