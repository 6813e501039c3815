//! Clips of a bake, and their roles.

use crate::commands::clip_choice::find_clip;
use crate::failure::{Failure, Result};
use crate::input::files::CharacterFile;
use crate::input::motion::Motion;
use crate::input::onto::carry;
use crate::report::table::shown;
use sinew::anim::Clip;
use sinew::anim::contact::footsteps;
use sinew::anim::retarget::RetargetOptions;
use sinew::formats::bvh::BvhRows;
use sinew::formats::{BvhOptions, MotionOptions};
use sinew::motions::looped_among;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// The motions of a character.
pub struct Motions {
    /// All clips: the file's own, then those of other files.
    pub clips: Vec<Clip>,
    /// The clip that plays until the fall.
    pub looped: Option<usize>,
    /// Forward speed of the character while that clip plays, m/s. With 0 the character moves by the clip's own motion.
    pub ahead: f32,
    /// Repairs made on reading the other files, one sentence each.
    pub notes: Vec<String>,
}

/// Speed of a character whose clip walks on the spot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Speed {
    /// Speed of the clip's feet.
    Feet,
    /// Given speed, m/s.
    Given(f32),
}

impl FromStr for Speed {
    type Err = String;

    fn from_str(text: &str) -> core::result::Result<Self, String> {
        /// Largest accepted speed, m/s: faster than any runner.
        const FASTEST: f32 = 50.0;
        if text == "feet" {
            return Ok(Self::Feet);
        }
        let speed: f32 = text.parse().map_err(|_| format!("'{text}' is neither a number nor 'feet'"))?;
        if speed.abs() <= FASTEST {
            Ok(Self::Given(speed))
        } else {
            Err(format!("must lie between -{FASTEST} and {FASTEST} m/s"))
        }
    }
}

/// Default name of the baked clip, with a number if the file has that name already. Clips of this name are not played
/// as motions unless requested.
pub const CLIP_NAME: &str = "sinew";

impl Motions {
    /// Returns the clips of the character's file and of `others`; `wanted` is the user's choice.
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
        Ok(Self { clips, looped, ahead: 0.0, notes })
    }

    /// Sets the forward speed. Returns a note if the clip walks on the spot and the user set no speed.
    ///
    /// # Errors
    /// If `speed` is that of the feet, and the feet do not walk on the spot.
    pub fn go_ahead(&mut self, file: &CharacterFile, speed: Option<Speed>) -> Result<Option<String>> {
        let Some(clip) = self.looped.map(|looped| &self.clips[looped]) else {
            return match speed {
                Some(_) => Err(Failure::at(&file.name, "there is no clip to play".to_owned(), "--speed")),
                None => Ok(None),
            };
        };
        let steps = footsteps(&file.document.rig, &file.analysis, clip);
        let feet = steps.as_ref().map_or(0.0, |steps| steps.speed);
        match speed {
            Some(Speed::Given(speed)) => self.ahead = speed,
            Some(Speed::Feet) if feet > 0.0 => self.ahead = feet,
            Some(Speed::Feet) => {
                let why = match steps {
                    Ok(_) => "its feet do not alternately move back at one speed".to_owned(),
                    Err(error) => error.to_string(),
                };
                let what =
                    format!("'{}' has no speed of its feet: {why}; give a number of m/s", shown(&clip.name));
                return Err(Failure::at(&file.name, what, "--speed"));
            }
            None if feet > 0.0 => {
                return Ok(Some(format!(
                    "'{}' walks on the spot, so it stays there: --speed feet moves it ahead at {feet:.2} m/s, the speed of its feet",
                    shown(&clip.name)
                )));
            }
            None => {}
        }
        Ok(None)
    }
}

/// Returns the clips of another file, retargeted to this character: by joint names, else by roles.
fn read_clips(path: &Path, file: &CharacterFile, notes: &mut Vec<String>) -> Result<Vec<Clip>> {
    // Accepts the rows that exist, even if the BVH header declares another number.
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
