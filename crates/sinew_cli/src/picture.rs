//! Picture files as arguments.

use sinew_picture::PictureFormat;
use std::path::{Path, PathBuf};

/// Parses the path of a picture to write.
pub fn picture_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    picture_format(&path).map(|_| path).ok_or_else(|| "must end in .gif, .png or .webp".to_owned())
}

/// The format that a file name's end stands for.
pub fn picture_format(path: &Path) -> Option<PictureFormat> {
    PictureFormat::from_extension(path.extension()?.to_str()?)
}
