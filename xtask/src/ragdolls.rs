//! Quality of the ragdolls of unprepared rigs.

use crate::bench::table::Table;
use crate::command::{self, Profile};
use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const PAGE: &str = "docs/ragdoll-quality.md";
/// Folder of rigs beside the repository.
pub const SHARED: &str = "../shared/data/rigs";
/// Files that may hold a rig.
const RIGS: [&str; 3] = ["glb", "gltf", "vrm"];

/// `cargo xtask ragdolls`: builds, drops and throws the ragdoll of each rig in a folder, and writes
/// docs/ragdoll-quality.md.
#[derive(clap::Args)]
#[command(after_help = "Example: cargo xtask ragdolls --rigs ~/characters --gate 1000")]
pub struct Ragdolls {
    /// Folder with rigs, or with folders of rigs
    #[arg(long, default_value = SHARED)]
    rigs: PathBuf,
    /// Number of random falls of each rig
    #[arg(long, default_value_t = 100)]
    gate: u32,
}

impl Ragdolls {
    /// # Errors
    /// If there is no rig, or the page cannot be written.
    pub fn run(&self) -> Result<()> {
        let binary = command::build_sinew(Profile::Release)?;
        let folder = command::root().join(&self.rigs);
        let mut measured = Vec::new();
        for file in rigs_in(&folder)? {
            let name = file.strip_prefix(&folder).unwrap_or(&file).display().to_string();
            eprintln!("{name}");
            measured.push((name, measure(&binary, &file, self.gate)?));
        }
        ensure!(
            measured.iter().any(|(_, report)| matches!(report, Measured::Built(_))),
            "{}: no rig",
            folder.display()
        );
        fs::write(command::root().join(PAGE), self.page(&measured)).context(PAGE)
    }

    fn page(&self, measured: &[(String, Measured)]) -> String {
        let mut page = format!(
            "# Ragdolls of rigs that nobody prepared\n\nMade by `cargo xtask ragdolls --gate {}`; do not edit. No rig has settings or code of its own.\n\n{LEGEND}\n",
            self.gate
        );
        let mut rows = Table::new(2, COLUMNS);
        let mut reasons = String::new();
        for (name, report) in measured {
            match report {
                Measured::Built(report) => {
                    rows.row(row(name, report));
                    let reasons_text = report["quality"]["reasons"].as_array().into_iter().flatten();
                    // Skips the note that no clip is played: the page states it once.
                    for reason in reasons_text
                        .filter_map(Value::as_str)
                        .filter(|reason| !reason.starts_with("hand-over"))
                    {
                        let _ = writeln!(reasons, "- {name}: {reason}");
                    }
                }
                Measured::Refused(what) => _ = writeln!(reasons, "- {name}: refused, {what}"),
            }
        }
        let _ = write!(page, "## Rigs\n\n{rows}\n");
        let _ = write!(
            page,
            "## Outside a bar, or not measured\n\n- all: hand-over momentum, since no clip is played\n{reasons}"
        );
        page
    }
}

/// Result of building a rig's ragdoll.
pub enum Measured {
    /// Report of `ragdoll build`.
    Built(Value),
    /// Error message of a refused file.
    Refused(String),
}

/// Runs `ragdoll build` on a file, with `gate` random falls on all threads.
///
/// # Errors
/// If the binary does not start, or prints no JSON.
pub fn measure(binary: &Path, file: &Path, gate: u32) -> Result<Measured> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut command = Command::new(binary);
    command.args(["ragdoll", "build", "--json"]).arg(file);
    if gate > 0 {
        command.args(["--gate", &gate.to_string(), "--threads", &threads.min(256).to_string()]);
    }
    let output = command.output().with_context(|| binary.display().to_string())?;
    if output.status.success() {
        return Ok(Measured::Built(serde_json::from_slice(&output.stdout)?));
    }
    let reasons_text = String::from_utf8_lossy(&output.stderr).into_owned();
    // A rejected file gives one line; a panic is a bug.
    ensure!(output.status.code() == Some(1), "{}: {}\n{reasons_text}", file.display(), output.status);
    Ok(Measured::Refused(reasons_text.trim().rsplit(": ").next().unwrap_or_default().to_owned()))
}

const LEGEND: &str = "Each rig is dropped eight times from 1 m, thrown at a wall at 15 m/s (second figure of a cell), and falls at random: pose, speed and ground. A rig is *good* with
joint gaps below 1 mm (99 %) and 5 mm (largest), limits exceeded by less than 2° and 4°, asleep within 6 s of a release and 3 s of calm, overlap of bodies without a joint below 10 mm,
5 mm in the ground at rest, energy gain below 0.01, and a sound skin ([ragdolls](ragdoll.md)); *usable* without NaN, with gaps below 20 mm, asleep within 8 s, overlap below 30 mm.
";

const COLUMNS: [&str; 9] = [
    "rig",
    "verdict",
    "bodies",
    "gap, mm",
    "beyond limit, °",
    "asleep, s",
    "overlap, mm",
    "falls: good/usable/bad",
    "gap in falls, mm",
];

/// Returns a metric of the drops and of the wall hit.
fn pair(report: &Value, key: &str, factor: f64) -> String {
    let figure = |run: &str| number(&report["quality"][run][key], factor);
    format!("{} · {}", figure("drop"), figure("wall"))
}

fn number(value: &Value, factor: f64) -> String {
    match value.as_f64() {
        Some(0.0) => "0".to_owned(),
        Some(x) if (x * factor).abs() < 0.001 => "< 0.001".to_owned(),
        Some(x) => format!("{:.3}", x * factor),
        None => "–".to_owned(),
    }
}

fn row(name: &str, report: &Value) -> Vec<String> {
    let quality = &report["quality"];
    let gate = &quality["gate"];
    let falls = ["good", "usable", "bad"].map(|key| gate[key].as_u64().unwrap_or_default().to_string());
    vec![
        name.to_owned(),
        quality["verdict"].as_str().unwrap_or("–").to_owned(),
        report["bodies"].as_array().map_or(0, Vec::len).to_string(),
        pair(report, "joint_gap_max_m", 1e3),
        pair(report, "limit_overshoot_max_deg", 1.0),
        number(&quality["asleep_s"], 1.0),
        number(&quality["nonadjacent_overlap_max_m"], 1e3),
        if gate.is_null() { "–".to_owned() } else { falls.join("/") },
        number(&gate["worst"]["joint_gap_max_m"], 1e3),
    ]
}

/// Returns all files that may hold a rig, in a folder and its subfolders, sorted by path.
///
/// # Errors
/// If a folder cannot be read.
pub fn rigs_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    find(folder, &mut files)?;
    files.sort();
    Ok(files)
}

fn find(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    let entries = fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() {
            find(&path, files)?;
        } else if path.extension().and_then(|e| e.to_str()).is_some_and(|e| RIGS.contains(&e)) {
            files.push(path);
        }
    }
    Ok(())
}
