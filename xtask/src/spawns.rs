//! Random falls of every available rig, and the thresholds of each rig.

use crate::command::{self, Profile};
use crate::ragdolls::{self, Measured};
use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Falls of each rig before every merge, and with `--full`.
pub const SOME: u32 = 100;
pub const ALL: u32 = 10_000;

/// Runs falls of the mannequin and of each rig beside the repository: no NaN, no added energy, no open joint.
///
/// # Errors
/// With the numbers of the falls that miss a threshold.
pub fn check(spawns: u32) -> Result<()> {
    let binary = command::build_sinew(Profile::Release)?;
    let folder = std::env::temp_dir().join(format!("sinew-spawns-{}", std::process::id()));
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let outcome = check_in(&binary, &folder, spawns);
    fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
    outcome
}

fn check_in(binary: &Path, folder: &Path, spawns: u32) -> Result<()> {
    // The demo writes the mannequin as a file.
    command::run(Command::new(binary).args(["demo", "--out", "."]).current_dir(folder))?;
    let mut files = vec![folder.join("demo.glb")];
    let shared = command::root().join(ragdolls::SHARED);
    if shared.is_dir() {
        files.extend(ragdolls::rigs_in(&shared)?);
    } else {
        eprintln!("the mannequin alone: no {}", ragdolls::SHARED);
    }
    let mut failed = Vec::new();
    for file in files {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        match ragdolls::measure(binary, &file, spawns)? {
            Measured::Built(report) => {
                let gate = &report["quality"]["gate"];
                eprintln!("{name}: {}", summary(gate));
                if broken(gate, spawns)? > 0 {
                    failed.push(format!("{name}: {}", gate["failures"]));
                }
            }
            // The mannequin has a skin, so a rejection is a failure.
            Measured::Refused(what) => {
                ensure!(file.parent() != Some(folder), "{name} is refused: {what}");
                eprintln!("{name}: refused, {what}");
            }
        }
    }
    if !failed.is_empty() {
        bail!("falls that violate a hard requirement:\n{}", failed.join("\n"));
    }
    Ok(())
}

/// Returns the number of falls that miss a threshold. A report without that number, or of another number of falls, is
/// an error.
fn broken(gate: &Value, spawns: u32) -> Result<u64> {
    ensure!(gate["spawns"] == spawns, "the report has {} falls, not {spawns}", gate["spawns"]);
    gate["failed"].as_u64().context("`quality.gate.failed` is missing")
}

fn summary(gate: &Value) -> String {
    let worst = |key: &str| gate["worst"][key].as_f64().unwrap_or(f64::NAN);
    format!(
        "{} good, {} usable, {} bad; energy gain {:.4}, joint gap p99 {:.4} mm, {} not finite",
        gate["good"],
        gate["usable"],
        gate["bad"],
        worst("energy_gain_max"),
        1000.0 * worst("joint_gap_p99_m"),
        gate["worst"]["nan"],
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_report_without_its_falls_fails() {
        assert_eq!(broken(&json!({ "spawns": 100, "failed": 0 }), 100).ok(), Some(0));
        assert_eq!(broken(&json!({ "spawns": 100, "failed": 3 }), 100).ok(), Some(3));
        assert!(broken(&json!({ "spawns": 1, "failed": 0 }), 100).is_err());
        assert!(broken(&json!({ "spawns": 100 }), 100).is_err());
    }
}
