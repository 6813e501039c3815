//! `sinew ragdoll export`: writes the definition for other engines.

use crate::failure::{Failure, Result};
use crate::input::files::{CharacterFile, Outputs, WeightSource, must_end_in, never_over};
use crate::input::ragdoll_file::{RagdollFile, is_character, read_definition};
use crate::input::settings_arg::SettingsArg;
use crate::input::source::{name, read_bytes};
use crate::report::Report;
use crate::report::table::{counted, shown};
use clap::ValueEnum;
use serde_json::json;
use sinew::CharacterSource;
use sinew::formats::{KhrFile, MjcfText, Textures, write_khr, write_mjcf};
use sinew::ragdoll::{BuildOptions, RagdollDef};
use std::path::PathBuf;

/// Write a ragdoll for other engines: as physics in a copy of the character's own file, or as a MuJoCo model
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew ragdoll export character.glb --as khr -o character.physics.glb
  sinew ragdoll export character.glb --ragdoll edited.sinew.json --as khr
  sinew ragdoll export character.sinew.json --as mjcf -o character.xml")]
pub struct RagdollExport {
    /// A character (GLB, glTF, VRM, FBX); for mjcf also a definition (.sinew.json) or another MJCF model
    file: PathBuf,
    /// khr: glTF with KHR_physics_rigid_bodies and KHR_implicit_shapes (drafts); mjcf: a MuJoCo model
    #[arg(long = "as", value_enum, value_name = "FORMAT")]
    format: Format,
    /// File to write; by default NAME.khr.glb or NAME.mjcf.xml next to the file
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
    /// A ragdoll of this character from `ragdoll build`, edited or not; by default one is built
    #[arg(long, value_name = "FILE.sinew.json", conflicts_with = "SettingsArg")]
    ragdoll: Option<PathBuf>,
    #[command(flatten)]
    settings: SettingsArg,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Format {
    Khr,
    Mjcf,
}

impl Format {
    /// Returns the extensions allowed for the format.
    fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Khr => &["glb", "vrm"],
            Self::Mjcf => &["xml", "mjcf"],
        }
    }
}

impl RagdollExport {
    /// Runs the command: reads or builds the ragdoll, converts it and writes the output.
    pub fn run(&self) -> Result<Report> {
        let output = self.output();
        let settings = self.settings.path_for(&self.file);
        let inputs = [self.file.as_path(), &settings].into_iter().chain(self.ragdoll.as_deref());
        never_over(inputs, [output.as_path()])?;
        must_end_in(&output, self.format.extensions())?;
        let (def, bytes, notes) = match self.format {
            Format::Khr => self.khr()?,
            Format::Mjcf => self.mjcf()?,
        };
        let mut outputs = Outputs::default();
        outputs.add(&output, bytes);
        outputs.write()?;
        let json = json!({
            "bodies": def.bodies.len(),
            "joints": def.joints.len(),
            "notes": notes,
            "outputs": [output.display().to_string()],
        });
        let mut text = format!(
            "{}: {}, {}\n",
            shown(&name(&self.file)),
            counted(def.bodies.len(), "body", "bodies"),
            counted(def.joints.len(), "joint", "joints")
        );
        for note in &notes {
            text += &format!("note: {}\n", shown(note));
        }
        text += &format!("written: {}\n", output.display());
        Ok(Report { json, text })
    }

    fn khr(&self) -> Result<(RagdollDef, Vec<u8>, Vec<String>)> {
        if !is_character(&read_bytes(&self.file)?) {
            let what =
                "khr adds physics to the character's own file: give that file, and this one with --ragdoll";
            return Err(Failure::of_file(name(&self.file), what));
        }
        let (character, def, mut all_notes) = self.character()?;
        let CharacterFile { name, source: CharacterSource { document, analysis, .. } } = &character;
        let KhrFile { bytes, notes } =
            write_khr(document, &analysis.bind_model, &def).map_err(|error| error.with_file(name))?;
        all_notes.extend(notes);
        Ok((def, bytes, all_notes))
    }

    fn mjcf(&self) -> Result<(RagdollDef, Vec<u8>, Vec<String>)> {
        let (def, mut notes) = match &self.ragdoll {
            Some(_) => {
                let (_, def, notes) = self.character()?;
                (def, notes)
            }
            None => {
                let file = RagdollFile::load(&self.file, Textures::Skip, &self.settings)?;
                file.check_settings(&self.settings)?;
                (file.repair.def, file.notes)
            }
        };
        let name = self.file.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
        let MjcfText { text, notes: lost } = write_mjcf(&def, &name);
        notes.extend(lost);
        Ok((def, text.into_bytes(), notes))
    }

    /// Returns the character with its ragdoll, and notes.
    fn character(&self) -> Result<(CharacterFile, RagdollDef, Vec<String>)> {
        match &self.ragdoll {
            Some(path) => {
                let character = CharacterFile::load(&self.file, Textures::Skip, WeightSource::File)?;
                let def = read_definition(path, &character)?;
                Ok((character, def, Vec::new()))
            }
            None => {
                let (character, settings) = self.settings.load_character(&self.file, Textures::Skip)?;
                let (def, report) = settings.build(&character, &BuildOptions::default())?;
                Ok((character, def, report.notes))
            }
        }
    }

    fn output(&self) -> PathBuf {
        let extension = match self.format {
            Format::Khr => "khr.glb",
            Format::Mjcf => "mjcf.xml",
        };
        self.output.clone().unwrap_or_else(|| self.file.with_extension(extension))
    }
}
