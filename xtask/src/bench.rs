//! Time and quality of Sinew and other engines.

mod charts;
mod counts;
mod figures;
mod kernels;
mod machine;
mod needs;
mod page;
mod peers;
mod requirements;
mod results;
pub mod table;
mod trace;

use crate::command::{self, Profile};
use crate::ragdolls::SHARED;
use anyhow::{Context, Result, bail};
use machine::Machine;
use peers::{Engine, Judging, Run, Scene};
use results::{EngineResult, Results, SceneResult};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Duration;

pub use counts::check as check_counts;

/// Path of the page.
const PAGE: &str = "docs/benchmarks.md";

/// Number of rounds in which the engines alternate.
const ROUNDS: u32 = 3;

/// Number of slightly different starts of a heap, because one run of a chaotic scene has little meaning.
const STARTS: u32 = 5;

/// Steps of a scene in a quick run.
const QUICK_STEPS: u32 = 60;

/// Time limit of a run, because some engines take very long for scenes that diverge.
const LIMIT: Duration = Duration::from_secs(900);

/// A measurement outside of the peers' scenes: a character from rig to baked clip, compared to real time.
const BAKE: &str = "bake";

/// Extensions of files that hold characters.
const RIGS: &[&str] = &["glb", "gltf", "vrm", "fbx"];

/// A measurement outside of the peers' scenes: characters of files that fall limp until they sleep.
const LIMP: &str = "limp";

/// A measurement outside of the peers' scenes: some scenes on one thread and on two, by wall time.
const THREADS: &str = "threads";

/// A measurement outside of the peers' list: heaps of ragdolls at several efforts of each engine.
const EFFORT: &str = "effort";

/// Scenes measured at several efforts.
const AT_EFFORTS: &[&str] = &["ragdoll_pile", "crowd_pile"];

/// The threaded scenes, and the steps of each.
const THREADED: &[(&str, u32)] = &[("box_rain", 120), ("ragdoll_pile", 300)];

/// `cargo xtask bench`: writes docs/benchmarks.md and bench/benchmarks.json.
///
/// Exits with 2 if a peer cannot be built.
#[derive(clap::Args)]
#[command(after_help = "Example: cargo xtask bench --scene ragdoll_pile --scene chain_swing_1000 --quick")]
pub struct Bench {
    /// Only this scene of `peers list`, or `bake`, `effort`, `limp` or `threads`; others keep their results
    #[arg(long = "scene", value_name = "NAME")]
    scenes: Vec<String>,
    /// Only this engine of `peers list`; the scenes that run lose the results of the others
    #[arg(long = "engine", value_name = "NAME")]
    engines: Vec<String>,
    /// Number of rounds; heaps run from 5 starts that differ a little, and each run is judged
    #[arg(long, default_value_t = ROUNDS, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// Number of steps instead of the scene's; the page shows it
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    steps: Option<u32>,
    /// One short round, printed and not stored
    #[arg(long)]
    quick: bool,
    /// Exit with 1 if Sinew misses a required speed
    #[arg(long)]
    check: bool,
    /// Count the instructions of the kernels instead, and compare them with bench/counts/baseline.txt
    #[arg(long, conflicts_with_all = ["scenes", "engines", "quick", "check"])]
    counts: bool,
    /// Time the eight-lane kernels beside the limit of the machine's arithmetic instead; with --check, exit with 1 if
    /// one misses its share
    #[arg(long, conflicts_with_all = ["scenes", "engines", "quick", "counts"])]
    kernels: bool,
    /// Print the times and counts of Sinew's stages on a scene instead, of `peers list`
    /// or `sinew scenes`. With --steps: this many, after a warm-up of a third of the scene
    #[arg(long, value_name = "SCENE", conflicts_with_all = ["scenes", "engines", "quick", "check", "counts", "kernels", "page"])]
    trace: Option<String>,
    /// Number of steps before a trace starts, instead of a third of the scene
    #[arg(long, value_name = "STEPS", requires = "trace")]
    warm_up: Option<u32>,
    /// Write the page from the stored results instead
    #[arg(long, conflicts_with_all = ["scenes", "engines", "quick", "check", "counts", "kernels"])]
    page: bool,
    /// Add the results of another machine instead, a file in the form of bench/benchmarks.json, and write the page
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scenes", "engines", "quick", "check", "counts", "kernels", "trace", "page"])]
    take: Option<PathBuf>,
    /// Store the counts as the expected ones
    #[arg(long, requires = "counts")]
    bless: bool,
}

impl Bench {
    /// # Errors
    /// If a run cannot be started or its results cannot be written.
    pub fn run(&self) -> Result<ExitCode> {
        if self.counts {
            let counted = if self.bless { counts::bless() } else { counts::check() };
            return counted.map(|()| ExitCode::SUCCESS);
        }
        if self.kernels {
            let shortfalls = kernels::measure()?;
            let fails = self.check && !shortfalls.is_empty();
            return Ok(if fails { ExitCode::FAILURE } else { ExitCode::SUCCESS });
        }
        if let Some(scene) = &self.trace {
            return trace::print(scene, self.steps, self.warm_up).map(|()| ExitCode::SUCCESS);
        }
        if self.page {
            return write_page(&kept(), &[]).map(|()| ExitCode::SUCCESS);
        }
        if let Some(file) = &self.take {
            return take(file).map(|()| ExitCode::SUCCESS);
        }
        let wanted = |name: &str| self.is_wanted_engine(name);
        let engines = match needs::check().and_then(|()| peers::build(&wanted)) {
            Ok(engines) => engines,
            Err(error) => {
                eprintln!("error: {error:#}");
                return Ok(ExitCode::from(2));
            }
        };
        let scenes = peers::scenes(engines.first().context("`peers list` has no engine")?)?;
        self.refuse_unknown(&scenes, &engines)?;
        let results = self.measure(&engines, &scenes)?;
        let [joints, stands] =
            [requirements::HOLDS, requirements::STANDS].map(|rows| page::holds(&results, rows));
        let [physics, animation] = [page::glance(&results), page::animation(&results)];
        println!("{physics}\n{joints}\n{stands}\n{animation}\n{}", page::ragdolls(&results));
        if !results.efforts.is_empty() {
            println!("{}", page::efforts(&results));
        }
        println!("{}", page::speeds(&results));
        Ok(self.verdict(&results))
    }

    fn refuse_unknown(&self, scenes: &[Scene], engines: &[Engine]) -> Result<()> {
        let is_there = |name: &&String| engines.iter().any(|engine| engine.name == **name);
        if let Some(name) = self.engines.iter().find(|name| !is_there(name)) {
            bail!("no engine `{name}`");
        }
        let is_known = |scene: &String| {
            [BAKE, EFFORT, LIMP, THREADS].contains(&scene.as_str())
                || scenes.iter().any(|known| known.name == *scene)
        };
        match self.scenes.iter().find(|scene| !is_known(scene)) {
            Some(scene) => {
                let names: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
                bail!(
                    "no scene `{scene}`; there are {}, {BAKE}, {EFFORT}, {LIMP}, {THREADS}",
                    names.join(", ")
                )
            }
            None => Ok(()),
        }
    }

    fn is_wanted(&self, scene: &str) -> bool {
        self.scenes.is_empty() || self.scenes.iter().any(|name| name == scene)
    }

    fn is_wanted_engine(&self, name: &str) -> bool {
        self.engines.is_empty() || self.engines.iter().any(|engine| engine == name)
    }

    fn measure(&self, engines: &[Engine], scenes: &[Scene]) -> Result<Results> {
        let revision = machine::revision();
        let machine = Some(Machine::this().to_string());
        let mut results = Results { machine, ..Results::default() };
        for scene in scenes.iter().filter(|scene| self.is_wanted(&scene.name)) {
            let rounds = if scene.is_chaotic { STARTS } else { self.rounds };
            results.scenes.push(self.race(engines, scene, &revision, rounds)?);
            self.keep(&results, scenes)?;
        }
        if self.is_wanted(EFFORT) {
            let engines = peers::at_efforts(engines);
            for scene in scenes.iter().filter(|scene| AT_EFFORTS.contains(&scene.name.as_str())) {
                results.efforts.push(self.race(&engines, scene, &revision, self.rounds)?);
                self.keep(&results, scenes)?;
            }
        }
        if self.is_wanted(BAKE) && !self.quick {
            (results.bake, results.build) = bake()?;
            self.keep(&results, scenes)?;
        }
        if self.is_wanted(LIMP) && !self.quick {
            results.limp = limp()?;
            self.keep(&results, scenes)?;
        }
        if self.is_wanted(THREADS) && !self.quick {
            results.threads = two_threads(self.rounds)?;
            self.keep(&results, scenes)?;
        }
        Ok(results)
    }

    /// Stores the results so far, so that stopping a long run loses only one scene.
    fn keep(&self, results: &Results, scenes: &[Scene]) -> Result<()> {
        let names: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
        if self.quick { Ok(()) } else { write(results.clone(), &names) }
    }

    /// Runs a scene on all engines that support it, alternating, so that other load affects them equally.
    fn race(&self, engines: &[Engine], scene: &Scene, revision: &str, rounds: u32) -> Result<SceneResult> {
        let result = |engine: &Engine| EngineResult { name: engine.name.clone(), reports: Vec::new() };
        let engines: Vec<&Engine> = engines.iter().filter(|engine| engine.is_for(scene)).collect();
        let mut results: Vec<_> = engines.iter().copied().map(result).collect();
        let (rounds, steps) = if self.quick { (1, Some(QUICK_STEPS)) } else { (rounds, self.steps) };
        for round in 1..=rounds {
            for (engine, result) in engines.iter().zip(&mut results) {
                if result.missing_reason().is_some() {
                    continue;
                }
                eprint!("{:<26} round {round} of {rounds}  {:<14}", scene.name, engine.name);
                std::io::stderr().flush()?;
                let judging = if round == 1 || scene.is_chaotic { Judging::On } else { Judging::Off };
                let start = scene.is_chaotic.then_some(round);
                let report = engine.run(&scene.name, Run { steps, start, judging }, LIMIT)?;
                eprintln!("{}", summary(&report));
                result.reports.push(report);
            }
        }
        let (name, about) = (scene.name.clone(), scene.about.clone());
        Ok(SceneResult { name, about, revision: revision.to_owned(), engines: results })
    }

    fn verdict(&self, results: &Results) -> ExitCode {
        if !self.check {
            return ExitCode::SUCCESS;
        }
        let (missed, open) = requirements::shortfalls(results);
        for line in &missed {
            println!("misses its requirement: {line}");
        }
        for line in &open {
            println!("not measured: {line}");
        }
        if missed.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
    }
}

/// Returns a short summary of a run for the console.
fn summary(report: &Value) -> String {
    match report["cpu_ms"]["median"].as_f64() {
        Some(median) => format!("{:>9} ms", figures::rounded(median)),
        None => report["unsupported"]
            .as_str()
            .or_else(|| report["failed"].as_str())
            .unwrap_or("nothing")
            .to_owned(),
    }
}

/// Measures the demo: returns the simulated seconds per processor second of its bake, and the number of conversions of
/// its file, scaled to 6,000 vertices, to a ragdoll in 100 ms.
fn bake() -> Result<(Option<f64>, Option<f64>)> {
    let sinew = command::build_sinew(Profile::Release)?;
    let folder = std::env::temp_dir().join(format!("sinew-bench-{}", std::process::id()));
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let file = folder.join("demo.glb");
    let demo = command::output_json(Command::new(&sinew).args(["demo", "--json", "--out"]).arg(&folder));
    let of_file = |arguments: &[&str]| command::output_json(Command::new(&sinew).args(arguments).arg(&file));
    let built = of_file(&["ragdoll", "build", "--json"]);
    let inside = of_file(&["inspect", "--json"]);
    fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let realtime = demo?["realtime_factor"].as_f64().context("`sinew demo --json`: no `realtime_factor`")?;
    let milliseconds = built?["build_ms"].as_f64().context("`ragdoll build --json`: no `build_ms`")?;
    let vertices = inside?["vertices"].as_f64().context("`inspect --json`: no `vertices`")?;
    Ok((Some(realtime), Some(100.0 / milliseconds * (vertices / 6000.0))))
}

/// Returns the simulated seconds per processor second of limp characters until they sleep, for the rigs in [`SHARED`];
/// empty without them.
fn limp() -> Result<BTreeMap<String, f64>> {
    let folder = command::root().join(SHARED);
    let Ok(files) = fs::read_dir(&folder) else {
        eprintln!("{LIMP}: left out, there is no {}", folder.display());
        return Ok(BTreeMap::new());
    };
    let files = files.map(|file| Ok(file?.path())).collect::<Result<Vec<PathBuf>>>()?;
    let is_rig = |file: &&PathBuf| file.extension().is_some_and(|end| RIGS.iter().any(|rig| end == *rig));
    let mut rigs: Vec<&PathBuf> = files.iter().filter(is_rig).collect();
    rigs.sort();
    let falls = command::output_json(Command::new(peers::build_ours()?).arg("limp").args(rigs))?;
    let factor = |name: &str| Some((name.to_owned(), falls["realtime_factor"][name].as_f64()?));
    Ok(["median", "slowest_humanoid"].into_iter().filter_map(factor).collect())
}

/// Returns the speed-up of a step by a second thread for each scene: the median of alternating rounds.
fn two_threads(rounds: u32) -> Result<BTreeMap<String, f64>> {
    let binary = peers::build_ours()?;
    let wall = |scene: &str, steps: u32, threads: u32| -> Result<f64> {
        let mut run = Command::new(&binary);
        run.args(["trace", "--scene", scene, "--steps", &steps.to_string()]);
        let trace = command::output_json(run.args(["--threads", &threads.to_string()]))?;
        trace["step"]["wall_us"].as_f64().context("`peers trace`: no `wall_us`")
    };
    let mut factors = BTreeMap::new();
    for &(scene, steps) in THREADED {
        let ratio = |_| Ok(wall(scene, steps, 1)? / wall(scene, steps, 2)?);
        let mut ratios = (0..rounds).map(ratio).collect::<Result<Vec<f64>>>()?;
        ratios.sort_by(f64::total_cmp);
        eprintln!("{scene:<26} on two threads {}×", figures::rounded(ratios[ratios.len() / 2]));
        factors.insert(scene.to_owned(), ratios[ratios.len() / 2]);
    }
    Ok(factors)
}

/// Returns the file with the results of earlier runs, which is committed, because a full run takes hours.
fn file() -> PathBuf {
    command::root().join("bench/benchmarks.json")
}

/// Returns the results of earlier runs; empty if none can be read.
fn kept() -> Results {
    let earlier = fs::read_to_string(file()).ok().and_then(|text| serde_json::from_str(&text).ok());
    Results::from_json(&earlier.unwrap_or(Value::Null))
}

/// Returns the charts of the landing page, and the machine of the last measurement as text.
///
/// # Errors
/// If a scene of the charts was not measured.
pub fn charts() -> Result<(String, String)> {
    let results = kept();
    let html = charts::charts(&results)?;
    Ok((html, results.machine.unwrap_or_default()))
}

/// Adds the results of another machine, at least one.
fn take(file: &Path) -> Result<()> {
    let text = fs::read_to_string(file).with_context(|| file.display().to_string())?;
    let value = serde_json::from_str(&text).with_context(|| file.display().to_string())?;
    let taken = Results::from_json(&value);
    if taken.scenes.is_empty() && taken.threads.is_empty() {
        bail!("{}: no scene, and nothing on two threads", file.display());
    }
    let earlier = kept();
    let mut names: Vec<String> = Vec::new();
    for scene in taken.scenes.iter().chain(&earlier.scenes) {
        if !names.contains(&scene.name) {
            names.push(scene.name.clone());
        }
    }
    write(taken, &names.iter().map(String::as_str).collect::<Vec<_>>())
}

/// Merges new results of the scenes `names` with earlier ones, and writes the page.
fn write(results: Results, names: &[&str]) -> Result<()> {
    let mut all = kept();
    all.update(results, names);
    fs::write(file(), format!("{}\n", all.to_json())).with_context(|| file().display().to_string())?;
    write_page(&all, &[names, &[BAKE, LIMP, THREADS]].concat())
}

/// Writes the page of all results, with a list of `names` without results. Never replaces a page with more scenes.
fn write_page(all: &Results, names: &[&str]) -> Result<()> {
    let missing: Vec<&str> = names.iter().copied().filter(|name| !all.has(name)).collect();
    let page = command::root().join(PAGE);
    if page::scene_count(&fs::read_to_string(&page).unwrap_or_default()) > all.scenes.len() {
        eprintln!(
            "{PAGE} is unchanged: it has more scenes than were measured here, which lack {}",
            missing.join(", ")
        );
        return Ok(());
    }
    fs::write(&page, page::page(all, &missing)).context(PAGE)?;
    let scenes = command::target().join("benchmarks.md");
    fs::write(&scenes, page::scenes(all)).with_context(|| scenes.display().to_string())
}
