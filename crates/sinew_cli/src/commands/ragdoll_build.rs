//! `sinew ragdoll build`: a rigged file becomes a ragdoll, with a report on its quality.

use crate::failure::{Failure, Result};
use crate::files::{CharacterFile, Outputs};
use crate::ragdoll_report::RagdollReport;
use crate::report::Report;
use clap::ValueEnum;
use sinew::formats::{Textures, write_ragdoll};
use sinew::ragdoll::{BuildOptions, Sex, ShapeChoice, build, drop_test, gate};
use std::path::PathBuf;

/// Build a ragdoll from a rigged file: shapes, masses, limits, collision filter, and a quality report
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew ragdoll build character.glb -o character.sinew.json
  sinew ragdoll build character.glb --shapes capsule --mass 62 --sex f")]
pub struct RagdollBuild {
    /// A glTF, GLB or VRM file with a skinned character
    file: PathBuf,
    /// Where to write the definition; without it there is only the report
    #[arg(short, long, value_name = "OUT.sinew.json")]
    output: Option<PathBuf>,
    /// Shapes of the bodies; auto takes for each bone what fits better
    #[arg(long, value_enum, default_value_t = Shapes::Auto)]
    shapes: Shapes,
    /// Mass of the whole character, kg; by default from its height or volume
    #[arg(long, value_name = "KG")]
    mass: Option<f32>,
    /// Whose distribution of mass over the body
    #[arg(long, value_enum, default_value_t = SexArg::M)]
    sex: SexArg,
    /// Also let it fall this many times at random: pose, speed and ground
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    gate: Option<u32>,
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
        let character = CharacterFile::load(&self.file, Textures::Skip)?;
        let CharacterFile { name, document, analysis } = &character;
        let (def, report) =
            build(&document.rig, analysis, &self.options()).map_err(|error| Failure::of_file(name, error))?;
        let tested = drop_test(&def);
        let gated = self.gate.map(|spawns| gate(&def, spawns as usize));
        let report = RagdollReport {
            file: name,
            def: &def,
            notes: &report.notes,
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

    fn options(&self) -> BuildOptions {
        BuildOptions {
            shapes: match self.shapes {
                Shapes::Box => ShapeChoice::Box,
                Shapes::Capsule => ShapeChoice::Capsule,
                Shapes::Auto => ShapeChoice::Auto,
            },
            mass: self.mass,
            sex: match self.sex {
                SexArg::M => Sex::Male,
                SexArg::F => Sex::Female,
            },
        }
    }
}
