//! Subjects: the content of a session, from which it can be restarted.

use sinew::formats::{Error, read_bytes};
use sinew_scenes::recording::Recording;
use sinew_scenes::scenes::{Scene, Settings, find};
use sinew_scenes::staged::Sample;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Content of a session, from which it can be restarted.
#[derive(Clone, Debug)]
pub enum Subject {
    /// A named scene with its settings, and the non-default settings as `key=value`.
    Scene(&'static Scene, Box<Settings>, Vec<String>),
    /// A file: a world, a character, a ragdoll.
    File(PathBuf),
    /// Files without a folder, as a page receives them: one that [`File`](Self::File) supports, and the files beside it.
    Dropped(Arc<[NamedFile]>),
    /// A recording, and the path of its file.
    Recording(PathBuf, Box<Recording>),
    /// A built-in character that walks, is pushed, falls and gets up, again and again.
    Sample(Sample),
    /// The character of files without a folder, on the stage of [`Sample`](Self::Sample).
    Staged(Arc<[NamedFile]>),
}

/// A file without a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedFile {
    /// Name of the file, with its extension.
    pub name: String,
    /// Content of the file.
    pub bytes: Vec<u8>,
}

impl Subject {
    /// Returns the scene of that name, with settings `key=value`.
    ///
    /// # Errors
    /// One line: there is no such scene, or the scene refuses a setting.
    pub fn scene(name: &str, assignments: &[String]) -> Result<Self, String> {
        let scene = find(name).ok_or_else(|| format!("no scene '{name}'"))?;
        let mut settings = scene.settings();
        for assignment in assignments {
            settings.assign(assignment).map_err(|error| error.to_string())?;
        }
        settings.check().map_err(|error| error.to_string())?;
        Ok(Self::Scene(scene, Box::new(settings), assignments.to_vec()))
    }

    /// Opens a file of any supported kind by its path.
    ///
    /// # Errors
    /// One line that names the file.
    pub fn file(path: &Path) -> Result<Self, Error> {
        if has_extension(path, "sinewrec") {
            return Self::recording(path, &read_bytes(path)?);
        }
        Ok(Self::File(path.to_owned()))
    }

    /// Opens files dropped together. The first file that can be shown on its own is shown; the others are its companions.
    ///
    /// # Errors
    /// One line that names the file.
    pub fn dropped(mut files: Vec<NamedFile>) -> Result<Self, Error> {
        match main_file(&mut files) {
            None => Err(Error::unsupported("nothing was dropped", "")),
            Some(file) if has_extension(Path::new(&file.name), "sinewrec") => {
                Self::recording(Path::new(&file.name), &file.bytes)
            }
            Some(_) => Ok(Self::Dropped(files.into())),
        }
    }

    /// Opens files like [`dropped`](Self::dropped), but the character walks, is pushed, falls and gets up.
    ///
    /// # Errors
    /// One line that names the file.
    pub fn staged(mut files: Vec<NamedFile>) -> Result<Self, Error> {
        let is_character = |file: &NamedFile| {
            ["glb", "gltf", "vrm"].iter().any(|extension| has_extension(Path::new(&file.name), extension))
        };
        match main_file(&mut files) {
            Some(file) if is_character(file) => Ok(Self::Staged(files.into())),
            _ => Self::dropped(files),
        }
    }

    fn recording(path: &Path, bytes: &[u8]) -> Result<Self, Error> {
        let recording = Recording::read(bytes);
        let recording = recording.map_err(|error| error.with_file(path.display().to_string()))?;
        Ok(Self::Recording(path.to_owned(), Box::new(recording)))
    }

    /// Returns true for a character on the stage of the demo, which the camera follows and a click pushes.
    pub fn is_staged(&self) -> bool {
        matches!(self, Self::Sample(_) | Self::Staged(_))
    }

    /// Returns the name for display.
    pub fn title(&self) -> String {
        let file_name =
            |path: &Path| path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        match self {
            Self::Scene(scene, ..) => scene.name.to_owned(),
            Self::File(path) | Self::Recording(path, _) => file_name(path),
            Self::Dropped(files) | Self::Staged(files) => files[0].name.clone(),
            Self::Sample(sample) => sample.name().to_owned(),
        }
    }

    /// Returns a description in one line.
    pub fn about(&self) -> String {
        match self {
            Self::Scene(scene, ..) => scene.about.to_owned(),
            Self::File(path) => path.display().to_string(),
            Self::Dropped(files) | Self::Staged(files) => files[0].name.clone(),
            Self::Sample(_) => ON_STAGE.to_owned(),
            Self::Recording(_, recording) => format!(
                "recording of {} by version {}, {} steps",
                recording.scene,
                recording.made_by,
                recording.steps.len()
            ),
        }
    }
}

/// Description of a built-in character on the stage.
const ON_STAGE: &str =
    "it walks, is pushed down the stairs, falls, gets up, and begins again: click to push it";

/// Extensions of files that can be shown on their own; others are companions.
const SHOWN: [&str; 7] = ["sinewrec", "json", "glb", "gltf", "vrm", "fbx", "bvh"];

/// Puts the first file that can be shown on its own before the others, and returns it.
fn main_file(files: &mut [NamedFile]) -> Option<&NamedFile> {
    let is_shown =
        |file: &NamedFile| SHOWN.iter().any(|extension| has_extension(Path::new(&file.name), extension));
    let first = files.iter().position(is_shown).unwrap_or(0);
    if first < files.len() {
        files.swap(0, first);
    }
    files.first()
}

pub(super) fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|it| it.eq_ignore_ascii_case(extension))
}
