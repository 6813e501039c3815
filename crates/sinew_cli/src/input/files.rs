//! Reads and writes the files of commands.

use crate::failure::{Failure, Result};
use crate::input::kin::units_beside;
use crate::input::source::{self, load_gltf, load_motion, read_bytes};
use crate::report::table::shown;
use sinew::CharacterSource;
use sinew::anim::roles::Correction;
use sinew::anim::weights::lost_weights;
use sinew::anim::{Hints, Rig};
use sinew::formats::{
    MotionFormat, MotionOptions, ReadOptions, Textures, no_files, read_gltf, write_all_atomic, write_motion,
};
use sinew::ragdoll::build::joint_name;
use std::borrow::Cow;
use std::ops::{Deref, DerefMut};
use std::path::{Path, PathBuf};

/// Source of the weights of a skin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum WeightSource {
    /// The weights of the file
    #[default]
    File,
    /// New weights, by the distance of vertices from bones
    Nearest,
}

/// A character file with its analysis.
pub struct CharacterFile {
    /// Name of the file, as given by the user.
    pub name: String,
    /// Content of the file, and what was recognised in it.
    pub source: CharacterSource,
}

impl Deref for CharacterFile {
    type Target = CharacterSource;

    fn deref(&self) -> &CharacterSource {
        &self.source
    }
}

impl DerefMut for CharacterFile {
    fn deref_mut(&mut self) -> &mut CharacterSource {
        &mut self.source
    }
}

impl CharacterFile {
    /// Reads a file that must contain a skinned character. An FBX is converted to a glTF first, to which clips can be
    /// added.
    pub fn load(path: &Path, textures: Textures, weights: WeightSource) -> Result<Self> {
        let name = source::name(path);
        let options = ReadOptions { textures };
        let format = format_of(path)?;
        if let Some(MotionFormat::Bvh | MotionFormat::DeepMimic) = format {
            let what = "a motion without a skin: 'sinew convert --onto CHARACTER' puts it on a character, and \
                        'sinew bake CHARACTER --clips' plays it before a fall";
            return Err(Failure::of_file(&name, what));
        }
        let mut document = if format == Some(MotionFormat::Fbx) {
            let file = load_motion(path, &MotionOptions::default())?;
            let bytes = write_motion(&file.rig, &file.clips, &file.events);
            let read = |bytes: Vec<u8>| read_gltf(&bytes, options, &mut no_files);
            bytes.and_then(read).map_err(|error| error.with_file(&name))?
        } else {
            load_gltf(path, options)?
        };
        if weights == WeightSource::Nearest {
            document.weigh_by_nearness();
        }
        if let Some(joint) = lost_weights(&document.rig) {
            let bone = shown(&joint_name(&document.rig, joint));
            let what = format!(
                "all vertices hang on one bone, {bone}: the weights of the skin were lost, and it cannot bend; \
                 --weights nearest makes new ones by the nearness of vertices to bones"
            );
            return Err(Failure::of_file(&name, what));
        }
        let source = CharacterSource::new(document, &path.to_string_lossy());
        let source = source.map_err(|no_skin| Failure::of_file(&name, no_skin))?;
        let mut file = Self { name, source };
        // A file in metres needs no evidence; for others the neighbouring files may give more.
        if file.is_in_doubt() && file.analysis.unit_scale != 1.0 {
            let kin = units_beside(path);
            file.hint(&Hints { kin, ..file.analysis.hints.clone() })?;
        }
        Ok(file)
    }

    /// Returns the rig without the skin of garments and of ignored joints, which covers no body.
    pub fn body(&self) -> Cow<'_, Rig> {
        Correction { ignored: self.worn.clone(), ..Correction::default() }.seen(&self.document.rig)
    }

    /// Returns true if the file's unit is in doubt.
    pub fn is_in_doubt(&self) -> bool {
        self.analysis.unit_guess.as_ref().is_some_and(|guess| !guess.is_only)
    }

    /// Repeats the analysis with additional evidence for the unit.
    pub fn hint(&mut self, hints: &Hints) -> Result<()> {
        self.source.hint(hints).map_err(|no_skin| Failure::of_file(&self.name, no_skin))
    }

    /// Removes the meshes of characters other than the `wanted` one, counted from 1. If there are several and none is
    /// wanted, keeps the character with the most vertices, with a note.
    pub fn choose(&mut self, wanted: Option<usize>) -> Result<()> {
        let count = self.characters().len();
        let number = match (wanted, self.largest()) {
            (Some(number), _) => number,
            (None, Some(largest)) if count > 1 => largest + 1,
            _ => return Ok(()),
        };
        let Some(index) = number.checked_sub(1).filter(|&index| index < count) else {
            let there = if count == 1 { "one character" } else { &format!("{count} characters") };
            let what = format!("there is no character {number} but {there}");
            return Err(Failure::at(&self.name, what, "--character"));
        };
        self.source.keep(index).map_err(|no_skin| Failure::of_file(&self.name, no_skin))?;
        if wanted.is_none() {
            self.analysis.notes.push(format!(
                "there are {count} characters in the file, and this is number {number}: --character 1 to {count} picks one"
            ));
        }
        Ok(())
    }
}

/// Returns the format of a file, by its first bytes.
fn format_of(path: &Path) -> Result<Option<MotionFormat>> {
    Ok(MotionFormat::of(&read_bytes(path)?).ok())
}

/// Rejects an output that is one of the user's own files.
pub fn never_over<'a>(
    inputs: impl IntoIterator<Item = &'a Path>,
    outputs: impl IntoIterator<Item = &'a Path>,
) -> Result<()> {
    // Compares canonical paths, because one file can have several paths. A file that does not exist yet is no input.
    let real = |path: &Path| std::fs::canonicalize(path).ok();
    let inputs: Vec<PathBuf> = inputs.into_iter().filter_map(real).collect();
    match outputs.into_iter().find(|output| real(output).is_some_and(|output| inputs.contains(&output))) {
        Some(output) => {
            Err(Failure::Usage(format!("{} is an input: write to another file", output.display())))
        }
        None => Ok(()),
    }
}

/// Rejects an output whose extension is none of these: the name decides the format.
pub fn must_end_in(output: &Path, extensions: &[&str]) -> Result<()> {
    let extension = output.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    if extensions.iter().any(|known| known.eq_ignore_ascii_case(extension)) {
        return Ok(());
    }
    let known: Vec<String> = extensions.iter().map(|known| format!(".{known}")).collect();
    Err(Failure::Usage(format!("-o {}: must end in {}", output.display(), known.join(" or "))))
}

/// Files that are written together: all of them, or none.
#[derive(Debug, Default)]
pub struct Outputs {
    files: Vec<(PathBuf, Vec<u8>)>,
}

impl Outputs {
    /// Adds a file with these bytes.
    pub fn add(&mut self, path: &Path, bytes: Vec<u8>) {
        self.files.push((path.to_path_buf(), bytes));
    }

    /// Returns the first file.
    pub fn first(&self) -> Option<(&Path, &[u8])> {
        self.files.first().map(|(path, bytes)| (path.as_path(), bytes.as_slice()))
    }

    /// Returns the paths of the files.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.files.iter().map(|(path, _)| path.as_path())
    }

    /// Writes the files atomically; none appears before all are on disk.
    pub fn write(&self) -> Result<()> {
        let mut paths: Vec<&Path> = self.paths().collect();
        paths.sort_unstable();
        if let Some(twice) = paths.windows(2).find(|pair| pair[0] == pair[1]) {
            let name = twice[0].display();
            return Err(Failure::Usage(format!("{name} is given twice: each output needs its own name")));
        }
        Ok(write_all_atomic(&self.files)?)
    }
}
