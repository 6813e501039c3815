//! The viewer as a page: a folder of static files, and its trial in a browser.

use crate::command::{self, cargo};
use crate::{chapters, golden, ragdolls, targets};
use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Folder of the files around the program.
const PAGE: &str = "crates/sinew_viewer/page";
/// Most bytes of the folder, compressed as servers do.
const MOST_BYTES: u64 = 6_000_000;
/// Most milliseconds to the first picture on the loopback, once the browser has compiled it before.
const MOST_MS: u64 = 2_000;
/// Scenes whose hashes are compared: bodies on a floor, joints and a character's skin, a rope.
const SCENES: [&str; 3] = ["stack", "stairs", "rope_on_box"];
/// Dropped on the page where the shared rigs are there.
const DROPPED: &str = "CesiumMan.glb";

/// `cargo xtask web`: builds the page, and says how large it is.
#[derive(clap::Args)]
pub struct Web {
    /// Folder to write
    #[arg(long, default_value = "out/web")]
    out: PathBuf,
    /// Tries it in headless Chromium as well: hashes of three scenes, a drag, a dropped character, the time that it takes
    #[arg(long)]
    check: bool,
}

impl Web {
    /// # Errors
    /// If the page does not compile, is too large, or fails its trial.
    pub fn run(&self) -> Result<()> {
        let folder = command::root().join(&self.out);
        build(&folder)?;
        if self.check { tried(&folder) } else { Ok(()) }
    }
}

/// Builds the page and tries it, for `cargo xtask ci --full`.
///
/// # Errors
/// As [`Web::run`].
pub fn check() -> Result<()> {
    Web { out: "out/web".into(), check: true }.run()
}

fn build(folder: &Path) -> Result<()> {
    targets::add(targets::BROWSER)?;
    let binder = binder()?;
    let mut rustc = cargo(&["rustc", "--package", "sinew_viewer", "--lib", "--crate-type", "cdylib"]);
    rustc.args(["--release", "--target", targets::BROWSER]);
    // Every browser that has WebGL2 has vectors, and the bits are the same with them.
    command::run(rustc.env("RUSTFLAGS", "-C target-feature=+simd128"))?;
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    let program = command::target().join(targets::BROWSER).join("release/sinew_viewer.wasm");
    let mut bind = Command::new(binder);
    bind.args(["--target", "web", "--no-typescript", "--remove-name-section", "--remove-producers-section"]);
    command::run(bind.args(["--out-name", "sinew", "--out-dir"]).arg(folder).arg(program))?;
    let page = command::root().join(PAGE);
    for file in ["index.html", "page.js", "chapter.js"] {
        fs::copy(page.join(file), folder.join(file)).with_context(|| file.to_owned())?;
    }
    let (chapters, scenes) = chapters::write(&command::root(), folder)?;
    let bytes = compressed(folder)?;
    eprintln!(
        "{}: {:.2} MB compressed, {chapters} chapters of the book with {scenes} scenes",
        folder.display(),
        bytes as f64 * 1e-6
    );
    ensure!(bytes < MOST_BYTES, "the page is larger than {MOST_BYTES} bytes");
    Ok(())
}

/// The program that writes the JavaScript around a WebAssembly program, of the version that the lock file has.
pub fn binder() -> Result<PathBuf> {
    let lock = fs::read_to_string(command::root().join("Cargo.lock")).context("Cargo.lock")?;
    let after =
        lock.split_once("name = \"wasm-bindgen\"\nversion = \"").context("no wasm-bindgen in Cargo.lock")?.1;
    let version = after.split('"').next().unwrap_or_default();
    let root = command::target().join("tools");
    let program = root.join("bin/wasm-bindgen");
    let told = Command::new(&program).arg("--version").output().map(|out| out.stdout).unwrap_or_default();
    if !String::from_utf8_lossy(&told).contains(version) {
        let mut install = cargo(&["install", "wasm-bindgen-cli", "--version", version, "--root"]);
        command::run(install.arg(&root))?;
    }
    Ok(program)
}

/// Bytes of the files that lie in a folder, each compressed by itself.
fn compressed(folder: &Path) -> Result<u64> {
    let mut bytes = 0;
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            // Pictures, each fetched by its chapter alone.
            continue;
        }
        bytes += gzipped(&path)?;
    }
    Ok(bytes)
}

/// Bytes of a file after gzip.
pub fn gzipped(path: &Path) -> Result<u64> {
    let out = Command::new("gzip").args(["-9", "-c"]).arg(path).output().context("gzip")?;
    ensure!(out.status.success(), "gzip: {}", String::from_utf8_lossy(&out.stderr));
    Ok(out.stdout.len() as u64)
}

/// Opens the page in a browser, by WebGL2 and by WebGPU.
fn tried(folder: &Path) -> Result<()> {
    command::provide("chromium", "chromium")?;
    command::provide("node", "nodejs")?;
    let pictures = command::target().join("web");
    fs::create_dir_all(&pictures)?;
    let expected = SCENES.iter().map(|scene| golden::committed(scene)).collect::<Result<Vec<_>>>()?;
    let scenes: Vec<Value> =
        SCENES.iter().zip(&expected).map(|(scene, (steps, _))| json!([scene, steps])).collect();
    let dropped = command::root().join(ragdolls::SHARED).join(DROPPED);
    // Chromium reads no file by a path with `..` in it.
    let drop: Vec<PathBuf> = dropped.canonicalize().into_iter().collect();
    if drop.is_empty() {
        eprintln!("skipped: {DROPPED} is not there to be dropped");
    }
    let mut node = Command::new("node");
    node.args(["--no-warnings", "--experimental-websocket"]);
    node.arg(command::root().join("xtask/src/browser.mjs")).arg(folder).arg(&pictures);
    node.arg(json!({"scenes": scenes, "drop": drop}).to_string()).stderr(Stdio::inherit());
    let told = command::output_json(&mut node)?;
    eprintln!("{told:#}\npictures in {}", pictures.display());
    for (way, told) in told.as_object().context("no outcome")? {
        for (scene, (steps, hash)) in SCENES.iter().zip(&expected) {
            let found = &told["hashes"][scene];
            if found != hash {
                bail!("{way}: {scene} has {found} after {steps} steps, elsewhere {hash}");
            }
        }
        // One attempt, regardless of other load: the bar is that of an idle machine.
        if told["ready_again_ms"].as_u64().is_none_or(|ms| ms > MOST_MS) {
            eprintln!("{way}: more than {MOST_MS} ms to the first picture");
        }
    }
    Ok(())
}
