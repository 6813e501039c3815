//! Arguments of commands that draw.

use sinew_picture::PictureFormat;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Longest simulation that may be written as a clip or a movie, seconds.
const LONGEST: f32 = 600.0;

/// File for a picture, in the format of its extension.
#[derive(Clone, Debug)]
pub struct PictureFile {
    path: PathBuf,
    /// Format of the file.
    pub format: PictureFormat,
}

impl PictureFile {
    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl FromStr for PictureFile {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let path = PathBuf::from(text);
        let extension = path.extension().and_then(|extension| extension.to_str());
        let format = extension.and_then(PictureFormat::from_extension);
        format.map(|format| Self { path, format }).ok_or("must end in .gif, .png or .webp")
    }
}

/// Parses a time from the start, seconds.
pub fn seconds(text: &str) -> Result<f32, String> {
    let time: f32 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (0.0..=LONGEST).contains(&time) {
        Ok(time)
    } else {
        Err(format!("must lie between 0 and {LONGEST} s"))
    }
}

/// Limits the length of a movie to the largest allowed.
pub fn longest(seconds: f32) -> f32 {
    if seconds < LONGEST { seconds } else { LONGEST }
}

/// Parses a number of pictures or keys per second.
pub fn rate(text: &str) -> Result<f32, String> {
    const MOST: f32 = 240.0;
    let rate: f32 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (1.0..=MOST).contains(&rate) {
        Ok(rate)
    } else {
        Err(format!("must lie between 1 and {MOST} a second"))
    }
}

/// Parses a positive duration.
pub fn length(text: &str) -> Result<f32, String> {
    let time = seconds(text)?;
    if time > 0.0 { Ok(time) } else { Err("must be above 0".to_owned()) }
}
