//! Which clips a bake has, and what each is for.

use crate::failure::{Failure, Result};
use crate::files::CharacterFile;
use crate::table::shown;
use sinew::anim::{Channel, Clip, Rig};
use sinew::formats::{ReadOptions, load_gltf};
use std::path::PathBuf;

/// The motions of a character.
pub struct Motions {
    /// All clips: those of its own file, then those of others.
    pub clips: Vec<Clip>,
    /// The clip that plays until the fall.
    pub looped: Option<usize>,
    /// Clips that get it up.
    pub get_ups: Vec<usize>,
}

/// What a clip that gets a body up is called, without case, blanks, `-` and `_`.
const GET_UP_NAMES: [&str; 3] = ["getup", "standup", "gettingup"];

impl Motions {
    /// From the character's file and from `others`; `wanted` is the user's choice of a clip.
    pub fn gather(file: &CharacterFile, others: &[PathBuf], wanted: Option<&str>) -> Result<Self> {
        let mut clips = file.document.clips.clone();
        for path in others {
            clips.extend(read_clips(path, &file.document.rig)?);
        }
        let plain: Vec<String> = clips.iter().map(|clip| plain(&clip.name)).collect();
        let is_get_up = |index: &usize| GET_UP_NAMES.iter().any(|name| plain[*index].contains(name));
        let get_ups: Vec<usize> = (0..clips.len()).filter(is_get_up).collect();
        let looped = match wanted {
            Some(name) => Some(find(&clips, name).map_err(|what| Failure::at(&file.name, what, "--clip"))?),
            None => {
                let called = |word: &str| plain.iter().position(|name| name.contains(word));
                let first = (0..clips.len()).find(|index| !is_get_up(index));
                called("walk").or_else(|| called("idle")).or(first)
            }
        };
        Ok(Self { clips, looped, get_ups })
    }
}

fn plain(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, ' ' | '_' | '-')).flat_map(char::to_lowercase).collect()
}

/// The clip of that name, or of that number where no clip is called so.
fn find(clips: &[Clip], name: &str) -> Result<usize, String> {
    let numbered = || name.parse().ok().filter(|&index: &usize| index < clips.len());
    let found = clips.iter().position(|clip| clip.name == name).or_else(numbered);
    found.ok_or_else(|| {
        let names: Vec<String> =
            clips.iter().enumerate().map(|(index, clip)| called(index, &clip.name)).collect();
        match names.len() {
            0 => format!("no clip '{name}': there are no clips"),
            _ => format!("no clip '{name}'; there are {}", names.join(", ")),
        }
    })
}

/// What the user may call a clip.
fn called(index: usize, name: &str) -> String {
    if name.is_empty() { format!("{index} (without a name)") } else { shown(name) }
}

/// The clips of another file, for the joints of `rig` that have the same names.
fn read_clips(path: &PathBuf, rig: &Rig) -> Result<Vec<Clip>> {
    let other = load_gltf(path, ReadOptions::default())?;
    let same = |joint: usize| {
        let name = &other.rig.joints[joint].name;
        (!name.is_empty()).then(|| rig.joints.iter().position(|own| own.name == *name)).flatten()
    };
    let renamed = |channel: &Channel| same(channel.joint).map(|joint| Channel { joint, ..channel.clone() });
    let clips: Vec<Clip> = other
        .clips
        .iter()
        .map(|clip| Clip { channels: clip.channels.iter().filter_map(renamed).collect(), ..clip.clone() })
        .filter(|clip| !clip.channels.is_empty())
        .collect();
    if clips.is_empty() {
        let what = "no clip that moves a joint of the character (joints are found by name)";
        return Err(Failure::of_file(path.display().to_string(), what));
    }
    Ok(clips)
}
