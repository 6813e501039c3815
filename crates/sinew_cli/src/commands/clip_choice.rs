//! Which of a file's clips the user means.

use crate::failure::{Failure, Result};
use crate::motion::Motion;
use crate::table::shown;
use sinew::anim::Clip;

/// The clip of that name, or of that number where no clip is called so.
pub fn find_clip(clips: &[Clip], name: &str) -> Result<usize, String> {
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

/// Indices of the clips that the user named, in that order; of all if none.
pub fn choose_clips(motion: &Motion, wanted: &[String]) -> Result<Vec<usize>> {
    let clips = &motion.file.clips;
    if wanted.is_empty() {
        return Ok((0..clips.len()).collect());
    }
    let find =
        |name: &String| find_clip(clips, name).map_err(|what| Failure::at(&motion.name, what, "--clip"));
    wanted.iter().map(find).collect()
}
