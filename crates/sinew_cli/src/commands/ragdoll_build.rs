//! `sinew ragdoll build`: a rigged file becomes a ragdoll, with a report on its quality.

use crate::cpu_clock::timed;
use crate::failure::Result;
use crate::files::{CharacterFile, Outputs, never_over};
use crate::ragdoll_report::RagdollReport;
use crate::report::Report;
use crate::settings_arg::{LoadedSettings, SettingsArg};
use clap::ValueEnum;
use sinew::formats::{Textures, write_ragdoll};
use sinew::ragdoll::{BuildOptions, RagdollDef, Sex, ShapeChoice, drop_test, gate};
use std::path::PathBuf;

/// Build a ragdoll from a rigged file: shapes, masses, limits, collision filter, and a quality report
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew ragdoll build character.glb -o character.sinew.json
  sinew ragdoll build character.glb --shapes capsule --mass 62 --sex f
  sinew ragdoll build character.glb --settings hero.ragdoll.json

docs/ragdoll.md says what a definition and settings hold.")]
pub struct RagdollBuild {
    /// A GLB, glTF, VRM or FBX file with a skinned character
    file: PathBuf,
    /// Where to write the definition; without it there is only the report
    #[arg(short, long, value_name = "OUT.sinew.json")]
    output: Option<PathBuf>,
    /// Shapes of the bodies; auto, the default, takes for each bone what fits better
    #[arg(long, value_enum)]
    shapes: Option<Shapes>,
    /// Mass of the whole character, kg; by default from its height or volume
    #[arg(long, value_name = "KG", allow_negative_numbers = true)]
    mass: Option<f32>,
    /// Whose distribution of mass over the body; by default male
    #[arg(long, value_enum)]
    sex: Option<SexArg>,
    /// Also let it fall this many times at random: pose, speed and ground
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    gate: Option<u32>,
    #[command(flatten)]
    settings: SettingsArg,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Shapes {
    Box,
    Capsule,
    Auto,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SexArg {
    /// Male
    M,
    /// Female
    F,
}

impl RagdollBuild {
    /// Builds, drops it, reports, writes.
    pub fn run(&self) -> Result<Report> {
        let settings = self.settings.path_for(&self.file);
        never_over([self.file.as_path(), &settings], self.output.as_deref())?;
        let (built, seconds) = timed(|| self.build());
        let (character, def, notes) = built?;
        let tested = drop_test(&def);
        let gated = self.gate.map(|spawns| gate(&def, spawns as usize));
        let report = RagdollReport {
            file: &character.name,
            def: &def,
            notes: &notes,
            build_ms: 1000.0 * seconds,
            tested: &tested,
            gated: gated.as_ref(),
        };
        let mut outputs = Outputs::default();
        if let Some(path) = &self.output {
            outputs.add(path, write_ragdoll(&def).into_bytes());
        }
        outputs.write()?;
        Ok(report.finish())
    }

    /// From the file to the definition, with what a person should know.
    fn build(&self) -> Result<(CharacterFile, RagdollDef, Vec<String>)> {
        let character = CharacterFile::load(&self.file, Textures::Skip)?;
        let (def, notes) = self.settings()?.build(&character, &BuildOptions::default())?;
        Ok((character, def, notes))
    }

    /// Settings of the file, and over them what the command line says.
    fn settings(&self) -> Result<LoadedSettings> {
        let mut loaded = self.settings.load(&self.file)?;
        let settings = &mut loaded.settings;
        if let Some(shapes) = self.shapes {
            settings.shapes = Some(match shapes {
                Shapes::Box => ShapeChoice::Box,
                Shapes::Capsule => ShapeChoice::Capsule,
                Shapes::Auto => ShapeChoice::Auto,
            });
        }
        if let Some(sex) = self.sex {
            settings.sex = Some(match sex {
                SexArg::M => Sex::Male,
                SexArg::F => Sex::Female,
            });
        }
        settings.mass = self.mass.or(settings.mass);
        Ok(loaded)
    }
}
