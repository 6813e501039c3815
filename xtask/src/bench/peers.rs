//! The binary of `bench/peers`: built up to three times, and run by engine and scene.

use crate::command;
use anyhow::{Context, Result, bail};
use serde_json::{Value, json};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

const MANIFEST: &str = "bench/peers/Cargo.toml";

/// MuJoCo, in its Python wheel.
const MUJOCO: &str = "mujoco";

/// Program that runs MuJoCo.
const MUJOCO_SCRIPT: &str = "bench/peers/mujoco_run.py";

/// Field of MuJoCo's scenes.
const FIGURES: &str = "figures";

/// Rapier built with eight lanes.
const WIDE: &str = "rapier_simd8";

/// ozz-animation-rs.
const OZZ: &str = "ozz";

/// Toolchain for ozz-animation-rs, which calls functions of `std::simd` that were renamed in Rust 1.95.
const OZZ_TOOLCHAIN: &str = "1.94.0";

/// Compiler flags for AVX2, if the machine has it.
const WIDE_FLAGS: &str = "-C target-cpu=x86-64-v3";

/// Interval between checks of a running process.
const POLL: Duration = Duration::from_millis(20);

/// An engine in a binary.
#[derive(Clone, Debug)]
pub struct Engine {
    /// Name in the binary and the reports.
    pub name: String,
    binary: PathBuf,
    /// Binary that contains the engine.
    peers: PathBuf,
    /// Arguments before the scene.
    arguments: Vec<String>,
    /// Fields of work that the engine supports.
    fields: Vec<String>,
}

/// A scene of the peers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scene {
    /// Name in the binary.
    pub name: String,
    /// One-line description.
    pub about: String,
    /// Field of work of the scene.
    field: String,
    /// True if a small change of the start changes the run.
    pub is_chaotic: bool,
}

/// Measurement of the quality by a second run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Judging {
    /// Time only.
    Off,
    /// Time, then quality.
    On,
}

/// Options of a run.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Number of steps, instead of the scene's.
    pub steps: Option<u32>,
    /// Number of a slightly changed start.
    pub start: Option<u32>,
    /// Measurement of the quality.
    pub judging: Judging,
}

/// Builds the peers with common settings, and Rapier again for wide registers if this machine has them, because one
/// binary cannot have both. ozz-animation-rs needs its own compiler. Returns the `wanted` ones, Sinew first.
///
/// # Errors
/// If a peer does not compile.
pub fn build(wanted: &dyn Fn(&str) -> bool) -> Result<Vec<Engine>> {
    let plain = build_with("peers", &mut cargo_build("rapier,box3d,jolt"))?;
    let mut engines = engines(&plain)?;
    if wanted(WIDE) && has_wide_registers() {
        let wide = build_with("peers-x86-64-v3", cargo_build("simd8").env("RUSTFLAGS", WIDE_FLAGS))?;
        let rapier = self::engines(&wide)?.into_iter().filter(|engine| engine.name.starts_with("rapier"));
        let place =
            engines.iter().position(|engine| engine.name == "rapier").map_or(engines.len(), |at| at + 1);
        engines.splice(place..place, rapier);
    } else if wanted(WIDE) {
        eprintln!("SKIPPED: {WIDE}, whose eight lanes this machine does not have");
    }
    if wanted(OZZ) && has_toolchain(OZZ_TOOLCHAIN) {
        let ozz = self::engines(&build_with("peers-ozz", &mut ozz_build())?)?;
        engines.extend(ozz.into_iter().filter(|engine| engine.name == OZZ));
    } else if wanted(OZZ) {
        eprintln!("SKIPPED: {OZZ}, which needs `rustup toolchain install {OZZ_TOOLCHAIN} --profile minimal`");
    }
    if wanted(MUJOCO) && has_mujoco() {
        engines.push(mujoco(&plain));
    } else if wanted(MUJOCO) {
        eprintln!("SKIPPED: {MUJOCO}, which needs `pip install mujoco`");
    }
    engines.retain(|engine| wanted(&engine.name));
    Ok(engines)
}

#[cfg(target_arch = "x86_64")]
fn has_wide_registers() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") && is_x86_feature_detected!("bmi2")
}

#[cfg(not(target_arch = "x86_64"))]
fn has_wide_registers() -> bool {
    false
}

const BUILD: &[&str] = &["build", "--release", "--locked", "--manifest-path", MANIFEST, "--features"];

fn cargo_build(features: &str) -> Command {
    let mut build = command::cargo(BUILD);
    build.arg(features);
    build
}

/// Returns the build command of ozz: optimised for this machine, without the parts that its older compiler cannot
/// build.
fn ozz_build() -> Command {
    let mut build = Command::new("rustup");
    build.current_dir(command::root()).args(["run", OZZ_TOOLCHAIN, "cargo"]).args(BUILD);
    build.args([OZZ, "--no-default-features", "--ignore-rust-version"]).env("RUSTC_BOOTSTRAP", "1");
    if has_wide_registers() {
        build.env("RUSTFLAGS", WIDE_FLAGS);
    }
    build
}

/// Builds Sinew alone, which needs only a Rust toolchain.
///
/// # Errors
/// If the binary does not compile.
pub fn build_ours() -> Result<PathBuf> {
    let build = &BUILD[..BUILD.len() - 1];
    build_with("peers", command::cargo(build).arg("--no-default-features"))
}

fn has_mujoco() -> bool {
    let import = Command::new("python3").args(["-c", "import mujoco"]).stderr(Stdio::null()).status();
    import.is_ok_and(|status| status.success())
}

/// Returns MuJoCo's engine; the binary `peers` lists its scenes.
fn mujoco(peers: &Path) -> Engine {
    let script = command::root().join(MUJOCO_SCRIPT);
    let arguments = [&script, Path::new("--peers"), peers].map(|part| part.to_string_lossy().into_owned());
    let (name, fields) = (MUJOCO.to_owned(), vec![FIGURES.to_owned()]);
    let (binary, peers) = ("python3".into(), peers.to_owned());
    Engine { name, binary, peers, arguments: arguments.to_vec(), fields }
}

fn has_toolchain(name: &str) -> bool {
    let version = Command::new("rustup").args(["run", name, "rustc", "--version"]).output();
    version.is_ok_and(|output| output.status.success())
}

fn build_with(folder: &str, build: &mut Command) -> Result<PathBuf> {
    let folder = command::target().join("bench").join(folder);
    command::build(build.arg("--target-dir").arg(folder), "peers")
}

/// Returns the engines of a binary.
fn engines(binary: &Path) -> Result<Vec<Engine>> {
    let list = command::output_json(Command::new(binary).arg("list"))?;
    let engines = list["engines"].as_array().context("`peers list` names no engines")?;
    let built = engines.iter().filter(|engine| engine["built"] == true);
    built
        .map(|engine| {
            let name = engine["name"].as_str().context("an engine without a name")?.to_owned();
            let fields = engine["fields"].as_array().into_iter().flatten();
            let fields = fields.filter_map(Value::as_str).map(str::to_owned).collect();
            let arguments = ["run", "--engine", &name].map(str::to_owned).to_vec();
            let [binary, peers] = [binary, binary].map(Path::to_owned);
            Ok(Engine { name, binary, peers, arguments, fields })
        })
        .collect()
}

/// Returns all scenes.
///
/// # Errors
/// If the binary fails.
pub fn scenes(engine: &Engine) -> Result<Vec<Scene>> {
    let list = command::output_json(Command::new(&engine.peers).arg("list"))?;
    let scenes = list["scenes"].as_array().context("`peers list` names no scenes")?;
    let text = |scene: &Value, key: &str| scene[key].as_str().map(str::to_owned);
    let scene = |scene: &Value| {
        let is_chaotic = scene["is_chaotic"].as_bool()?;
        let (name, about, field) = (text(scene, "name")?, text(scene, "about")?, text(scene, "field")?);
        Some(Scene { name, about, field, is_chaotic })
    };
    scenes.iter().map(|value| scene(value).context("a scene without a name")).collect()
}

/// Work per step at which each engine is measured: Sinew's qualities, the peers' numbers of substeps.
const EFFORTS: &[(&str, &[&str])] = &[
    ("sinew", &["fast", "balanced", "exact"]),
    ("rapier", &["4", "8", "16"]),
    ("box3d", &["4", "8", "16", "64"]),
    ("jolt", &["1", "4", "16"]),
];

/// Returns each engine of [`EFFORTS`] once per effort, named by both.
pub fn at_efforts(engines: &[Engine]) -> Vec<Engine> {
    let efforts = |engine: &Engine| EFFORTS.iter().find(|(name, _)| *name == engine.name);
    let each = |engine| {
        efforts(engine).into_iter().flat_map(|(_, efforts)| *efforts).map(move |effort| (engine, effort))
    };
    let at = |(engine, effort): (&Engine, &&str)| {
        let mut engine = engine.clone();
        engine.name = format!("{} {effort}", engine.name);
        engine.arguments.extend(["--effort", effort].map(str::to_owned));
        engine
    };
    engines.iter().flat_map(each).map(at).collect()
}

impl Engine {
    /// Returns true if the engine runs this kind of scene.
    pub fn is_for(&self, scene: &Scene) -> bool {
        self.fields.contains(&scene.field)
    }

    /// Runs a scene. Returns the process's output, or, because a failure is a result too, an object with `failed` if
    /// the process crashed or took too long.
    ///
    /// # Errors
    /// If the process cannot be started, or prints something else.
    pub fn run(&self, scene: &str, run: Run, limit: Duration) -> Result<Value> {
        let Run { steps, start, judging } = run;
        let mut run = Command::new(&self.binary);
        run.args(&self.arguments).args(["--scene", scene]);
        for (option, value) in [("--steps", steps), ("--start", start)] {
            if let Some(value) = value {
                run.args([option, &value.to_string()]);
            }
        }
        if judging == Judging::On {
            run.arg("--quality");
        }
        match output_within(&mut run, limit)? {
            Ok(text) => serde_json::from_str(&text)
                .with_context(|| format!("{} on {scene}: stdout is not one JSON value", self.name)),
            Err(why) => Ok(json!({ "engine": self.name, "scene": scene, "failed": why })),
        }
    }
}

/// Returns the output of a program, or the reason of its failure.
fn output_within(command: &mut Command, limit: Duration) -> Result<Result<String, String>> {
    let mut child = command.stdout(Stdio::piped()).spawn().context("cannot start `peers`")?;
    let Some(mut stdout) = child.stdout.take() else { bail!("`peers` has no stdout") };
    let reader = thread::spawn(move || {
        let mut text = String::new();
        stdout.read_to_string(&mut text).map(|_| text)
    });
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if start.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            return Ok(Err(format!("stopped after {} s", limit.as_secs())));
        }
        thread::sleep(POLL);
    };
    let text = reader.join().map_err(|_| anyhow::anyhow!("reading from `peers` failed"))??;
    Ok(if status.success() { Ok(text) } else { Err(status.to_string()) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell(script: &str, limit: Duration) -> Result<String, String> {
        output_within(Command::new("sh").args(["-c", script]), limit).expect("the shell starts")
    }

    #[test]
    #[cfg(unix)]
    fn a_run_succeeds_fails_or_times_out() {
        let long = Duration::from_secs(60);
        assert_eq!(shell("echo 1", long), Ok("1\n".to_owned()));
        assert_eq!(shell("exit 3", long), Err("exit status: 3".to_owned()));
        assert_eq!(shell("exec sleep 60", Duration::ZERO), Err("stopped after 0 s".to_owned()));
    }
}
