//! `sinew ragdoll build`: builds a ragdoll from a rigged file, with a report on its quality.

use crate::cpu_clock::timed;
use crate::failure::Result;
use crate::input::files::{CharacterFile, Outputs, must_end_in, never_over};
use crate::input::settings_arg::{LoadedSettings, SettingsArg};
use crate::judge::{Judgement, judge_life, with_default_life};
use crate::report::Report;
use crate::report::progress::Progress;
use crate::report::ragdoll_report::RagdollReport;
use clap::ValueEnum;
use sinew::formats::{Textures, write_ragdoll};
use sinew::physics::Threads;
use sinew::ragdoll::build::BuildReport;
use sinew::ragdoll::quality::{GateReport, gate_on};
use sinew::ragdoll::{BuildOptions, LimitSource, RagdollDef, Settings, Sex, ShapeChoice, drop_test};
use std::path::PathBuf;

/// Build a ragdoll from a rigged file: shapes, masses, limits, collision filter, and a quality report
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew ragdoll build character.glb -o character.sinew.json
  sinew ragdoll build character.glb --shapes capsule --mass 62 --sex f
  sinew ragdoll build character.glb --settings hero.ragdoll.json
  sinew ragdoll build character.glb --role hips=Bone_12 --ignore Cape \\
      --height 1.8
  sinew ragdoll build character.glb --limits clips --gate 1000 --threads 8

docs/ragdoll.md says what a definition and settings hold.")]
pub struct RagdollBuild {
    /// A GLB, glTF, VRM or FBX file with a skinned character
    file: PathBuf,
    /// Definition file to write; without it only the report is printed
    #[arg(short, long, value_name = "OUT.sinew.json")]
    output: Option<PathBuf>,
    /// Shapes of the bodies; auto, the default, picks the better fit for each bone
    #[arg(long, value_enum)]
    shapes: Option<Shapes>,
    /// Sex whose mass distribution is used; by default male
    #[arg(long, value_enum)]
    sex: Option<SexArg>,
    /// Joint limits: those of anatomy, the default, or learned from the file's clips
    #[arg(long, value_enum)]
    limits: Option<Limits>,
    /// Also simulate this many random falls: pose, speed and ground
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    gate: Option<u32>,
    /// Number of the first of these falls, to repeat falls that the report lists
    #[arg(long, value_name = "K", default_value_t = 0, requires = "gate")]
    gate_from: u32,
    /// Threads for the falls; the report does not depend on the number
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=256))]
    threads: u16,
    #[command(flatten)]
    settings: SettingsArg,
}

/// Number of falls between two updates of the progress bar.
const BATCH: u32 = 64;

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Shapes {
    Box,
    Capsule,
    Auto,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Limits {
    Anatomy,
    Clips,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SexArg {
    /// Male
    M,
    /// Female
    F,
}

impl RagdollBuild {
    /// Runs the command: builds the ragdoll, drops it, reports on it and writes it.
    pub fn run(&self) -> Result<Report> {
        let settings = self.settings.path_for(&self.file);
        never_over([self.file.as_path(), &settings], self.output.as_deref())?;
        self.output.iter().try_for_each(|output| must_end_in(output, &["json"]))?;
        let (built, seconds) = timed(|| self.build());
        let (character, settings, def, build) = built?;
        let mut tested = drop_test(&def);
        let doubt = settings.doubt(&character, &def);
        let Judgement { verdict, reasons, skin } =
            with_default_life(&character, &def, doubt.as_ref(), |life| {
                judge_life(&character, &tested, life, doubt.as_ref())
            })?;
        // The entry for unmeasured metrics is last.
        let not_measured = tested.reasons.pop();
        (tested.verdict, tested.reasons) = (verdict, reasons);
        tested.reasons.extend(not_measured);
        let gated = self.gate.map(|spawns| self.gated(&def, spawns));
        let report = RagdollReport {
            file: &character.name,
            def: &def,
            build: &build,
            build_ms: 1000.0 * seconds,
            tested: &tested,
            skin: &skin,
            gated: gated.as_ref(),
        };
        let mut outputs = Outputs::default();
        if let Some(path) = &self.output {
            outputs.add(path, write_ragdoll(&def).into_bytes());
        }
        outputs.write()?;
        Ok(report.finish())
    }

    /// Simulates random falls, with a progress bar.
    fn gated(&self, def: &RagdollDef, spawns: u32) -> GateReport {
        let threads = Threads::new(usize::from(self.threads));
        let progress = Progress::new("random falls", spawns as usize);
        let mut report = GateReport::default();
        for from in (0..spawns).step_by(BATCH as usize) {
            let to = u32::min(from.saturating_add(BATCH), spawns);
            let number = |fall: u32| u64::from(self.gate_from) + u64::from(fall);
            report = report.and(gate_on(def, number(from)..number(to), &threads));
            progress.reach(to as usize);
        }
        report
    }

    /// Builds the definition from the file, with notes.
    fn build(&self) -> Result<(CharacterFile, LoadedSettings, RagdollDef, BuildReport)> {
        let (character, mut loaded) = self.settings.load_character(&self.file, Textures::Skip)?;
        self.say(&mut loaded.settings);
        let (def, report) = loaded.build(&character, &BuildOptions::default())?;
        Ok((character, loaded, def, report))
    }

    /// Overrides the settings by the command line.
    fn say(&self, settings: &mut Settings) {
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
        if let Some(limits) = self.limits {
            settings.limits = Some(match limits {
                Limits::Anatomy => LimitSource::Anatomy,
                Limits::Clips => LimitSource::Clips,
            });
        }
    }
}
