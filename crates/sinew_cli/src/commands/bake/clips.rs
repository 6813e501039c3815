//! Clips of a bake, and the use of each.

use crate::commands::clip_choice::find_clip;
use crate::failure::{Failure, Result};
use crate::input::files::CharacterFile;
use crate::input::motion::Motion;
use crate::input::onto::carry;
use crate::report::footsteps::footsteps;
use sinew::anim::retarget::RetargetOptions;
use sinew::anim::{Clip, Interpolation};
use sinew::formats::bvh::BvhRows;
use sinew::formats::{BvhOptions, MotionOptions};
use sinew::math::max;
use std::path::{Path, PathBuf};

/// The motions of a character.
pub struct Motions {
    /// All clips: those of its own file, then those of others.
    pub clips: Vec<Clip>,
    /// The clip that plays until the fall.
    pub looped: Option<usize>,
    /// Repairs made while the other files were read, a sentence each.
    pub notes: Vec<String>,
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
        let mut notes = Vec::new();
        for path in others {
            clips.extend(read_clips(path, file, &mut notes)?);
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
                let walks =
                    (0..clips.len()).filter(|&index| plain[index].contains("walk") && !is_baked(&index));
                walk(&clips, walks, file).or_else(|| called("idle")).or(first)
            }
        };
        Ok(Self { clips, looped, notes })
    }
}

/// Least way of a joint's key from the first that is a motion: of a rotation's components or in file units of a translation, as a share of
/// the largest.
const MOVES: f32 = 0.01;

/// The walk among clips that are called so: one that moves, and of several the first in which both feet take turns.
fn walk(clips: &[Clip], called: impl Iterator<Item = usize>, file: &CharacterFile) -> Option<usize> {
    let moving: Vec<usize> = called.filter(|&index| moves(&clips[index])).collect();
    if moving.len() < 2 {
        return moving.first().copied();
    }
    let CharacterFile { document, analysis, .. } = file;
    let takes_turns = |&index: &usize| {
        let steps = footsteps(&document.rig, analysis, &clips[index]).unwrap_or_default();
        ["left", "right"].iter().all(|side| steps.iter().any(|step| step.payload == *side))
    };
    moving.iter().copied().find(takes_turns).or(moving.first().copied())
}

/// True if any joint of a clip moves: a pose that is held is no walk, whatever its name.
fn moves(clip: &Clip) -> bool {
    clip.channels.iter().any(|channel| {
        let width = channel.property.width();
        // A cubic key has slopes before and after its value.
        let cubic = channel.interpolation == Interpolation::CubicSpline;
        let (stride, at) = if cubic { (3 * width, width) } else { (width, 0) };
        let keys: Vec<&[f32]> = channel.values.chunks_exact(stride).map(|key| &key[at..at + width]).collect();
        let Some(first) = keys.first() else { return false };
        let size = keys.iter().flat_map(|key| key.iter()).fold(1e-6, |most, value| max(most, value.abs()));
        keys.iter().any(|key| key.iter().zip(*first).any(|(a, b)| (a - b).abs() > MOVES * size))
    })
}

fn plain(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, ' ' | '_' | '-')).flat_map(char::to_lowercase).collect()
}

/// The clips of another file, on this character: by the names of joints, else by roles.
fn read_clips(path: &Path, file: &CharacterFile, notes: &mut Vec<String>) -> Result<Vec<Clip>> {
    // What is there is played, though the header of a BVH promises more or fewer frames.
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
