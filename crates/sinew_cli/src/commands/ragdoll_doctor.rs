//! `sinew ragdoll doctor`: diagnoses a ragdoll and repairs it.

use crate::failure::Result;
use crate::input::files::{CharacterFile, Outputs, must_end_in, never_over};
use crate::input::ragdoll_file::RagdollFile;
use crate::input::settings_arg::SettingsArg;
use crate::judge::with_default_life;
use crate::report::Report;
use crate::report::garments_report;
use crate::report::skin_report::SkinReport;
use crate::report::springs_report::proposal;
use crate::report::table::{Table, counted, shown};
use serde_json::{Value, json};
use sinew::formats::{Textures, write_ragdoll};
use sinew::ragdoll::doctor::{Code, Finding, Severity};
use sinew::ragdoll::settings::SpringSource;
use sinew::ragdoll::{BuildOptions, Flaw, Repair, cure, doctor, drop_test};
use std::path::PathBuf;

/// Explain why a ragdoll jitters, explodes or looks wrong, with measurements, and repair it
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew ragdoll doctor character.glb
  sinew ragdoll doctor character.sinew.json --fix -o mended.sinew.json
  sinew ragdoll doctor character.sinew.json --rig character.glb --fix \\
      -o mended.sinew.json
  sinew ragdoll doctor humanoid.xml --json

An error jitters, explodes or falls apart; a warning behaves, but not as a body does. \
The file that is examined is never changed. docs/ragdoll.md lists every code.")]
pub struct RagdollDoctor {
    /// A character (GLB, glTF, VRM, FBX), a definition (.sinew.json) or an MJCF model (.xml)
    file: PathBuf,
    /// Repair what can be repaired, and write the resulting definition
    #[arg(long, requires = "output")]
    fix: bool,
    /// File for the repaired definition
    #[arg(short, long, value_name = "OUT.sinew.json", requires = "fix")]
    output: Option<PathBuf>,
    /// The character that a definition belongs to: gives its bones and the joints without a body
    #[arg(long, value_name = "CHARACTER")]
    rig: Option<PathBuf>,
    #[command(flatten)]
    settings: SettingsArg,
}

/// Returns the skin flaws of a ragdoll on its rig. A ragdoll that explodes or lacks bodies is not dropped: its
/// skin would show nothing new.
fn skin_flaws(repair: &Repair, character: &CharacterFile) -> Vec<Flaw> {
    let is_cause = |finding: &Finding| {
        let is_missing = matches!(finding.code, Code::HeadWithoutBody | Code::LimbWithoutBody);
        is_missing || finding.severity == Severity::Error
    };
    if doctor(repair).iter().any(is_cause) {
        return Vec::new();
    }
    match repair.def.clone().for_rig(&character.document.rig) {
        Ok(def) => {
            let tested = drop_test(&def);
            let flaws = with_default_life(character, &def, None, |life| {
                SkinReport::of(character, &def, &tested, Some(life)).flaws
            });
            flaws.unwrap_or_else(|_| SkinReport::of(character, &def, &tested, None).flaws)
        }
        Err(_) => Vec::new(),
    }
}

impl RagdollDoctor {
    /// Runs the command: reads the ragdoll, examines it, repairs it on request and writes the result.
    pub fn run(&self) -> Result<Report> {
        let character = self.rig.as_deref().unwrap_or(&self.file);
        let settings = self.settings.path_for(character);
        never_over([self.file.as_path(), character, &settings], self.output.as_deref())?;
        self.output.iter().try_for_each(|output| must_end_in(output, &["json"]))?;
        let file = RagdollFile::load(&self.file, Textures::Skip, &self.settings)?;
        if self.rig.is_none() {
            file.check_settings(&self.settings)?;
        }
        let RagdollFile { name, mut repair, mut notes, mut character, mut garments } = file;
        if let Some(rig) = &self.rig {
            let (rig, settings) = self.settings.load_character(rig, Textures::Skip)?;
            repair.reference = Some(settings.build(&rig, &BuildOptions::default())?.0);
            garments = settings.garments(&rig)?;
            character = Some(rig);
        }
        if let Some(character) = &character {
            repair.skin = skin_flaws(&repair, character);
            let rig = &character.document.rig;
            if rig.springs.is_empty() {
                let springs = SpringSource::Names.springs(rig, character.analysis.up_axis);
                notes.extend(proposal(rig, &springs, &repair.def));
            }
            notes.extend(garments_report::worn_notes(&garments));
            if garments.is_empty() {
                notes.extend(garments_report::proposal(rig, &repair.def));
            }
        }
        let findings = match &self.output {
            None => doctor(&repair),
            Some(output) => {
                let (mut cured, mut findings) = cure(&repair);
                // The skin of a ragdoll with errors is only examined once they are repaired.
                if let Some(character) = character.as_ref().filter(|_| repair.skin.is_empty()) {
                    cured.skin = skin_flaws(&cured, character);
                    let left = doctor(&cured);
                    let is_new = |left: &Finding| {
                        !findings.iter().any(|one| one.code == left.code && one.bones == left.bones)
                    };
                    findings.extend(left.into_iter().filter(is_new).collect::<Vec<_>>());
                }
                if repair.springs.iter().any(Option::is_some) {
                    notes.push("springs of joints are no part of a definition: they are not written".into());
                }
                let mut outputs = Outputs::default();
                outputs.add(output, write_ragdoll(&cured.def).into_bytes());
                outputs.write()?;
                findings
            }
        };
        Ok(Report { json: self.to_json(&findings, &notes), text: self.to_text(&name, &findings, &notes) })
    }

    fn to_json(&self, findings: &[Finding], notes: &[String]) -> Value {
        let finding = |finding: &Finding| {
            json!({
                "code": finding.code.name(),
                "severity": finding.severity.name(),
                "bone": finding.bones.first().map_or("", String::as_str),
                "bones": finding.bones,
                "cause": finding.code.cause(),
                "evidence": finding.evidence,
                "fix": finding.fix,
                "fixed": finding.fixed,
            })
        };
        let outputs: Vec<String> = self.output.iter().map(|path| path.display().to_string()).collect();
        json!({
            "findings": findings.iter().map(finding).collect::<Vec<_>>(),
            "notes": notes,
            "outputs": outputs,
        })
    }

    fn to_text(&self, name: &str, findings: &[Finding], notes: &[String]) -> String {
        let is_fixed = |finding: &Finding| self.fix && finding.fixed;
        let count = |severity| {
            findings.iter().filter(|finding| finding.severity == severity && !is_fixed(finding)).count()
        };
        let fixed = match findings.iter().filter(|finding| is_fixed(finding)).count() {
            0 => String::new(),
            fixed => format!(", {fixed} fixed"),
        };
        let mut text = format!(
            "{}: {}, {}{fixed}\n",
            shown(name),
            counted(count(Severity::Error), "error", "errors"),
            counted(count(Severity::Warning), "warning", "warnings")
        );
        for finding in findings {
            let fixed = match (self.fix, finding.fixed) {
                (true, true) => "  [fixed]",
                (true, false) if finding.severity != Severity::Note => "  [not fixed]",
                _ => "",
            };
            text += &format!("\n{}: {}{fixed}\n", finding.severity.name(), finding.code.name());
            let mut table = Table::default();
            table.row(["found".into(), shown(&finding.evidence)]);
            table.row(["cause".into(), finding.code.cause().into()]);
            table.row(["fix".into(), finding.fix.clone()]);
            text += &table.to_text();
        }
        if findings.iter().all(|finding| finding.severity == Severity::Note) {
            text += "no errors and no warnings\n";
        }
        for note in notes {
            text += &format!("note: {}\n", shown(note));
        }
        if let Some(output) = &self.output {
            text += &format!("\nwritten: {}\n", output.display());
        }
        text
    }
}
