//! Builds, packs and tests the npm package `sinew-physics`, like its users, in Node and in a browser.

use crate::command;
use crate::ragdolls;
use crate::targets;
use crate::web::{self, copy};
use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const MANIFEST: &str = "bindings/Cargo.toml";
/// Sources of the package besides the program.
const PACKAGE: &str = "bindings/web/package";
/// Tools with their versions, and the tests.
const TESTS: &str = "bindings/web/tests";
/// Size limit of the program after gzip, bytes. The goal is 1.3 MB; docs/guide/src/three.md explains the difference.
const MOST_BYTES: u64 = 2_000_000;
/// Rigs for the browser test, if the shared data exist.
const RIGS: [&str; 3] = ["CesiumMan.glb", "kaykit_Knight.glb", "CoolLoops_mixamorig_vrm0.vrm"];

/// `cargo xtask npm`: builds and packs the package, and prints its size.
#[derive(clap::Args)]
pub struct Npm {
    /// Folder to write
    #[arg(long, default_value = "out/npm")]
    out: PathBuf,
    /// Also test it: the program of its README, in Node, in a Vite project in headless Chromium, with hashes against
    /// the native library
    #[arg(long)]
    check: bool,
    /// Also measure it, against the native library in the same run
    #[arg(long)]
    measure: bool,
}

impl Npm {
    /// # Errors
    /// If the package does not build, its types are wrong, it is too large, or a test fails.
    pub fn run(&self) -> Result<()> {
        let out = command::root().join(&self.out);
        let tarball = build(&out)?;
        if self.check {
            tried(&out, &tarball)?;
        }
        if self.measure { measured(&out, &tarball) } else { Ok(()) }
    }
}

/// Builds and tests the package, for `cargo xtask ci --full`.
///
/// # Errors
/// The errors of [`Npm::run`].
pub fn check() -> Result<()> {
    Npm { out: "out/npm".into(), check: true, measure: false }.run()
}

fn cargo(arguments: &[&str]) -> Command {
    let mut cargo = command::cargo(arguments);
    cargo.args(["--locked", "--manifest-path", MANIFEST, "--package", "sinew_web", "--target-dir"]);
    cargo.arg(target());
    cargo
}

fn target() -> PathBuf {
    command::target().join("bindings")
}

/// Returns the folder with the tools of the tests, installed by their lock file.
fn tools() -> Result<PathBuf> {
    command::provide("npm", "npm")?;
    let folder = command::target().join("npm");
    fs::create_dir_all(&folder)?;
    let same = |name: &str| -> Result<bool> {
        let wanted = fs::read(command::root().join(TESTS).join(name)).with_context(|| name.to_owned())?;
        Ok(fs::read(folder.join(name)).is_ok_and(|found| found == wanted))
    };
    if !(same("package-lock.json")? && folder.join("node_modules/.package-lock.json").exists()) {
        for name in ["package.json", "package-lock.json"] {
            fs::copy(command::root().join(TESTS).join(name), folder.join(name))?;
        }
        let mut install = Command::new("npm");
        command::run(install.args(["ci", "--no-audit", "--no-fund"]).current_dir(&folder))?;
    }
    Ok(folder)
}

/// Builds the package in a folder of `out`, and packs it; returns the tarball.
fn build(out: &Path) -> Result<PathBuf> {
    targets::add(targets::BROWSER)?;
    let (binder, tools) = (web::binder()?, tools()?);
    // Every browser with WebGL2 has vector instructions, and results have the same bits with them. An additional Rust
    // library would prevent the linker from optimising across crates.
    let mut build = cargo(&["rustc", "--lib", "--crate-type", "cdylib", "--profile", "web"]);
    build.args(["--target", targets::BROWSER]);
    command::run(build.env("RUSTFLAGS", "-C target-feature=+simd128"))?;
    // The package is below the tools' folder, so that the compiler finds three's types.
    let package = tools.join("package");
    if package.exists() {
        fs::remove_dir_all(&package).with_context(|| package.display().to_string())?;
    }
    copy(&command::root().join(PACKAGE), &package)?;
    for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
        fs::copy(command::root().join(licence), package.join(licence))?;
    }
    let program = target().join(targets::BROWSER).join("web/sinew_web.wasm");
    let wasm = package.join("wasm");
    let mut bind = Command::new(binder);
    bind.args(["--target", "web", "--remove-name-section", "--remove-producers-section", "--out-dir"]);
    command::run(bind.arg(&wasm).arg(program))?;
    name_init(&wasm.join("sinew_web.js"))?;
    let program = wasm.join("sinew_web_bg.wasm");
    types(&package, &tools)?;
    let packed = command::output(Command::new("npm").args(["pack", "--silent"]).current_dir(&package))?;
    fs::create_dir_all(out)?;
    let tarball = out.join("sinew-physics.tgz");
    fs::copy(package.join(packed.trim()), &tarball).context("npm pack")?;
    let bytes = web::gzipped(&program)?;
    eprintln!("{}: the program is {:.2} MB after gzip", tarball.display(), bytes as f64 * 1e-6);
    ensure!(bytes < MOST_BYTES, "the program has {bytes} bytes after gzip, more than {MOST_BYTES}");
    Ok(tarball)
}

/// Makes calls before `init` fail with a message that names it; without this they read a property of `undefined`.
fn name_init(binding: &Path) -> Result<()> {
    const UNLOADED: &str = "const unloaded = new Proxy({}, {
    get() { throw new Error('sinew-physics is not loaded: call `init` and wait for it'); },
});
let wasmModule, wasmInstance, wasm = unloaded;";
    let mut text = fs::read_to_string(binding)?;
    for (old, new) in [
        ("let wasmModule, wasmInstance, wasm;", UNLOADED),
        ("if (wasm !== undefined) return wasm;", "if (wasm !== unloaded) return wasm;"),
    ] {
        ensure!(text.contains(old), "{}: `{old}` is missing", binding.display());
        text = text.replace(old, new);
    }
    Ok(fs::write(binding, text)?)
}

/// Checks the package's JavaScript, and writes its types.
fn types(package: &Path, tools: &Path) -> Result<()> {
    fs::copy(command::root().join(TESTS).join("tsconfig.json"), tools.join("tsconfig.json"))?;
    let mut compiler = Command::new(tools.join("node_modules/.bin/tsc"));
    command::run(compiler.arg("--project").arg(tools).arg("--outDir").arg(package))
}

/// Returns hashes and times of the native library for the same scenes; `flags` are the compiler's.
fn native(flags: &str, arguments: &[&str]) -> Result<Value> {
    let mut build =
        command::cargo(&["build", "--locked", "--manifest-path", MANIFEST, "--package", "sinew_web"]);
    // Uses separate folders, so that neither build replaces the other.
    let folder = if flags.is_empty() { target() } else { target().join("narrow") };
    build.args(["--release", "--example", "native", "--target-dir"]).arg(folder).env("RUSTFLAGS", flags);
    let program = command::build(&mut build, "native")?;
    let mut run = Command::new(program);
    command::output_json(run.arg(rigs()).args(RIGS).args(arguments))
}

fn rigs() -> PathBuf {
    let shared = command::root().join(ragdolls::SHARED);
    shared.canonicalize().unwrap_or(shared)
}

fn tried(out: &Path, tarball: &Path) -> Result<()> {
    let mut clippy = cargo(&["clippy", "--target", targets::BROWSER]);
    command::run(clippy.args(["--", "-D", "warnings"]))?;
    run_tests("check.mjs", out, tarball, &native("", &[])?)
}

/// Measures the package beside the native library, as built by default and without 256-bit registers.
fn measured(out: &Path, tarball: &Path) -> Result<()> {
    let mut times = native("", &["--measure"])?;
    times["narrow"] = native("--cfg sinew_narrow", &["--measure"])?["times"].take();
    run_tests("measure.mjs", out, tarball, &times)
}

fn run_tests(script: &str, out: &Path, tarball: &Path, native: &Value) -> Result<()> {
    command::provide("chromium", "chromium")?;
    command::provide("node", "nodejs")?;
    let folder = tools()?;
    copy(&command::root().join(TESTS), &folder)?;
    if !rigs().is_dir() {
        eprintln!("skipped: {} is missing: only the mannequin falls", ragdolls::SHARED);
    }
    let input = json!({
        "tarball": tarball,
        "out": out,
        "root": command::root(),
        "rigs": if rigs().is_dir() { json!(rigs()) } else { Value::Null },
        "native": native,
    });
    let mut node = Command::new("node");
    node.arg(folder.join(script)).arg(input.to_string()).current_dir(&folder).stdout(Stdio::inherit());
    if !node.status().context("node")?.success() {
        bail!("{script} failed");
    }
    Ok(())
}
