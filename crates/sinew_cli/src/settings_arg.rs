//! Settings of a ragdoll: those that were asked for, else those beside the character's file.

use crate::failure::{Failure, Result};
use crate::files::CharacterFile;
use sinew::formats::{read_bytes, read_ragdoll_settings, settings_path};
use sinew::ragdoll::build::{BuildReport, takes};
use sinew::ragdoll::{BuildOptions, RagdollDef, Settings, SettingsError, build_moving};
use std::path::{Path, PathBuf};

/// Where settings come from.
#[derive(clap::Args)]
pub struct SettingsArg {
    /// Settings of the ragdoll, a JSON file; by default NAME.ragdoll.json beside the character, if it is there
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
}

/// Settings and the file that they are from, `""` where there is none.
#[derive(Debug, Default)]
pub struct LoadedSettings {
    /// As a person names it.
    pub file: String,
    /// What they say.
    pub settings: Settings,
}

impl SettingsArg {
    /// Where the user said they are.
    pub fn path(&self) -> Option<&Path> {
        self.settings.as_deref()
    }

    /// Where those for a character's file are: where the user said, else beside it, whether there are any or not.
    pub fn path_for(&self, character: &Path) -> PathBuf {
        self.settings.clone().unwrap_or_else(|| settings_path(character))
    }

    /// Reads those for a character's file.
    pub fn load(&self, character: &Path) -> Result<LoadedSettings> {
        let path = &self.path_for(character);
        if self.settings.is_none() && !path.is_file() {
            return Ok(LoadedSettings::default());
        }
        let file = path.display().to_string();
        let read = read_bytes(path).and_then(|bytes| read_ragdoll_settings(&bytes));
        let settings = read.map_err(|error| error.with_file(&file))?;
        Ok(LoadedSettings { file, settings })
    }
}

impl LoadedSettings {
    /// The ragdoll of a character and its clips, and what the build says of it.
    pub fn build(
        &self,
        character: &CharacterFile,
        options: &BuildOptions,
    ) -> Result<(RagdollDef, BuildReport)> {
        let CharacterFile { name, document, analysis } = character;
        let moves = takes(&document.rig, &document.clips);
        let built = build_moving(&document.rig, analysis, &moves, options, &self.settings);
        let (def, mut report) = built.map_err(|error| match error {
            SettingsError::Build(error) => Failure::of_file(name, error),
            SettingsError::Setting { what, place } => Failure::at(&self.file, what, place),
        })?;
        if !self.file.is_empty() {
            report.notes.insert(0, format!("with the settings of {}", self.file));
        }
        Ok((def, report))
    }
}
