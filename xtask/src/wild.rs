//! Public characters: recognised roles, falls, and pictures of them after the fall.

mod page;
mod sheet;

use crate::command::{self, Profile};
use crate::ragdolls::{self, Measured};
use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::time::Instant;

/// Folder beside the repository.
const DATA: &str = "../shared/data";
/// Folders of mesh files to simulate.
const FOLDERS: [&str; 2] = ["rigs", "rigs_wild"];
const PAGE: &str = "out/wild/tables.md";
/// Folder for reports and pictures, which git ignores.
const OUT: &str = "out/wild";
/// Length of a bake, seconds: a character that falls at 0.5 s lies by then.
const SECONDS: &str = "6";

/// `cargo xtask wild`: builds, drops and bakes every rig beside the repository, recognises every skeleton, and writes
/// their metrics and sheets of pictures after the fall.
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  cargo xtask wild
  cargo xtask wild --only Cow --only Shark

Reports of rigs are kept in out/wild until the program is built anew: what was broken off goes on where it was.")]
pub struct Wild {
    /// Only files with this in their name; repeatable. Writes no page
    #[arg(long, value_name = "WORD")]
    only: Vec<String>,
}

/// Result of a file.
struct Row {
    /// Path under ../shared/data.
    file: String,
    /// Report `{"build","bake","build_s","bake_s"}`, or `{"refused"}`.
    report: Value,
    /// Picture of the character after the fall.
    picture: PathBuf,
}

impl Wild {
    /// # Errors
    /// If the program does not build, panics, or an output cannot be written.
    pub fn run(&self) -> Result<()> {
        let data = command::root().join(DATA);
        if !data.is_dir() {
            eprintln!("skipped: no {DATA}");
            return Ok(());
        }
        let out = command::root().join(OUT);
        fs::create_dir_all(&out).context(OUT)?;
        let binary = command::build_sinew(Profile::Release)?;
        let mut files = Vec::new();
        for folder in FOLDERS {
            files.extend(ragdolls::rigs_in(&data.join(folder))?);
        }
        files.retain(|file| self.is_selected(&file.to_string_lossy()));
        let rows = measure_all(&binary, &data, &out, &files)?;
        sheet::write(&rows, &out)?;
        if self.only.is_empty() {
            let roles = roles(&out)?;
            fs::write(command::root().join(PAGE), page::page(&rows, &roles)).context(PAGE)?;
        }
        Ok(())
    }

    fn is_selected(&self, file: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|word| file.contains(word.as_str()))
    }
}

/// Returns correct and total roles per file, from the tests of `sinew_anim`, which have the expected roles. Builds
/// them with the program's profile, so that nothing is compiled twice.
fn roles(out: &Path) -> Result<Value> {
    let path = out.join("roles.json");
    let test = [
        "test",
        "--release",
        "--package",
        "sinew_anim",
        "--test",
        "it",
        "wild::roles_of_public_rigs_reach_the_required_share",
    ];
    command::run(command::cargo(&test).env("SINEW_WILD_ROLES", &path))?;
    let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    serde_json::from_str(&text).with_context(|| path.display().to_string())
}

/// Runs all files in parallel; results are in the order of the files.
fn measure_all(binary: &Path, data: &Path, out: &Path, files: &[PathBuf]) -> Result<Vec<Row>> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let next = Mutex::new(files.iter().enumerate());
    let rows: Mutex<Vec<(usize, Result<Row>)>> = Mutex::new(Vec::new());
    let take = || next.lock().expect("no thread panics while it holds the lock").next();
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some((index, file)) = take() {
                    let row = measure(binary, data, out, file);
                    rows.lock().expect("no thread panics while it holds the lock").push((index, row));
                }
            });
        }
    });
    let mut rows = rows.into_inner().expect("no thread panics while it holds the lock");
    rows.sort_by_key(|(index, _)| *index);
    rows.into_iter().map(|(_, row)| row).collect()
}

/// Returns a file's report, from the last run if that is newer than the program.
fn measure(binary: &Path, data: &Path, out: &Path, path: &Path) -> Result<Row> {
    let file = path.strip_prefix(data).unwrap_or(path).display().to_string();
    let stem = file.replace('/', "_");
    let (kept, picture) = (out.join(format!("{stem}.json")), out.join(format!("{stem}.png")));
    let report = match fs::read_to_string(&kept) {
        Ok(text) if is_newer(&kept, binary)? => serde_json::from_str(&text)?,
        _ => {
            let report = fall(binary, path, &out.join(format!("{stem}.glb")), &picture)?;
            fs::write(&kept, report.to_string()).with_context(|| kept.display().to_string())?;
            report
        }
    };
    eprintln!("{file}: {}", report["build"]["quality"]["verdict"].as_str().unwrap_or("refused"));
    Ok(Row { file, report, picture })
}

fn is_newer(file: &Path, than: &Path) -> Result<bool> {
    let changed = |path: &Path| fs::metadata(path).and_then(|data| data.modified());
    Ok(changed(file)? > changed(than).with_context(|| than.display().to_string())?)
}

/// Builds, drops and bakes, and draws the fallen character.
fn fall(binary: &Path, path: &Path, baked: &Path, picture: &Path) -> Result<Value> {
    let start = Instant::now();
    let build = match ragdolls::measure(binary, path, 0)? {
        Measured::Built(report) => report,
        Measured::Refused(what) => return Ok(json!({ "refused": what })),
    };
    let build_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let mut bake = Command::new(binary);
    bake.args(["bake", "--json", "--no-builtin-motions", "--name", "fallen", "--seconds", SECONDS, "-o"]);
    let bake = command::output_json(bake.arg(baked).arg(path))?;
    let bake_s = start.elapsed().as_secs_f64();
    let lies = bake["settled_s"].as_f64().map_or(SECONDS.to_owned(), |settled| settled.to_string());
    let mut view = Command::new(binary);
    let [width, height] = sheet::SIZE.map(|pixels| pixels.to_string());
    view.arg("view").arg(baked).args(["--clip", "fallen", "--at", &lies, "--width", &width]);
    command::output(view.args(["--height", &height, "--picture"]).arg(picture))?;
    fs::remove_file(baked).with_context(|| baked.display().to_string())?;
    ensure!(picture.is_file(), "{}: no picture", path.display());
    Ok(json!({ "build": build, "bake": bake, "build_s": build_s, "bake_s": bake_s }))
}
