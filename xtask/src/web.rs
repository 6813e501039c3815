//! The viewer as a page: a folder of static files, and its test in a browser.

use crate::command::{self, cargo};
use crate::landing::{self, Facts};
use crate::{chapters, golden, ragdolls, targets};
use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Folder of the page's other files.
const PAGE: &str = "crates/sinew_viewer/page";
/// Files of the start page that are copied unchanged.
const COPIED: [&str; 4] = ["page.js", "page.css", "chapter.js", "poster.jpg"];
/// Files that the start page loads before its first picture.
const LOADED: [&str; 6] = ["index.html", "page.js", "page.css", "poster.jpg", "sinew.js", "sinew_bg.wasm"];
/// Crates whose API reference is on the page.
const API: [&str; 7] = [
    "sinew",
    "sinew_math",
    "sinew_geometry",
    "sinew_physics",
    "sinew_anim",
    "sinew_ragdoll",
    "sinew_formats",
];
/// Size limit of the start page's loaded files, bytes, compressed as by servers.
const MOST_BYTES: u64 = 6_000_000;
/// Time limit to the first picture on the loopback, milliseconds, after the browser has compiled it once.
const MOST_MS: u64 = 1_500;
/// Scenes whose hashes are compared: bodies on a floor, joints and a character's skin, a rope.
const SCENES: [&str; 3] = ["stack", "stairs", "rope_on_box"];
/// Rig dropped on the page, if the shared rigs exist.
const DROPPED: &str = "CesiumMan.glb";

/// `cargo xtask web`: builds the page, and prints its size.
#[derive(clap::Args)]
pub struct Web {
    /// Folder to write
    #[arg(long, default_value = "out/web")]
    out: PathBuf,
    /// Address at which it will be published, `https://…/`, for previews of the page
    #[arg(long, default_value = "")]
    address: String,
    /// Also test it in headless Chromium: hashes of three scenes, a drag, a dropped character, the demo in five sizes,
    /// its loading time
    #[arg(long)]
    check: bool,
    /// Redraw the start page's pictures in its sources
    #[arg(long)]
    pictures: bool,
}

impl Web {
    /// # Errors
    /// If the page does not compile, is too large, or fails its test.
    pub fn run(&self) -> Result<()> {
        let folder = command::root().join(&self.out);
        build(&folder, &self.address)?;
        if self.pictures {
            draw(&folder)?;
        }
        if self.check { tried(&folder) } else { Ok(()) }
    }
}

/// Builds and tests the page, for `cargo xtask ci --full`.
///
/// # Errors
/// The errors of [`Web::run`].
pub fn check() -> Result<()> {
    Web { out: "out/web".into(), address: String::new(), check: true, pictures: false }.run()
}

fn build(folder: &Path, address: &str) -> Result<()> {
    targets::add(targets::BROWSER)?;
    let binder = binder()?;
    let mut rustc = cargo(&["rustc", "--package", "sinew_viewer", "--lib", "--crate-type", "cdylib"]);
    rustc.args(["--release", "--target", targets::BROWSER]);
    // Every browser with WebGL2 has vector instructions, and results have the same bits with them.
    command::run(rustc.env("RUSTFLAGS", "-C target-feature=+simd128"))?;
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    let program = command::target().join(targets::BROWSER).join("release/sinew_viewer.wasm");
    let mut bind = Command::new(binder);
    bind.args(["--target", "web", "--no-typescript", "--remove-name-section", "--remove-producers-section"]);
    command::run(bind.args(["--out-name", "sinew", "--out-dir"]).arg(folder).arg(program))?;
    let root = command::root();
    for file in COPIED {
        fs::copy(root.join(PAGE).join(file), folder.join(file)).with_context(|| file.to_owned())?;
    }
    let (chapters, scenes) = chapters::write(&root, folder)?;
    let bytes = fs::metadata(folder.join("sinew_bg.wasm")).context("sinew_bg.wasm")?.len();
    let source = source();
    let facts = Facts { address, bytes, source: source.as_deref(), chapters: &chapters };
    landing::write(&root, folder, &facts)?;
    reference(folder)?;
    let bytes = LOADED.iter().map(|file| gzipped(&folder.join(file))).sum::<Result<u64>>()?;
    eprintln!(
        "{}: the start page loads {:.2} MB compressed; {} chapters of the book with {scenes} scenes",
        folder.display(),
        bytes as f64 * 1e-6,
        chapters.len()
    );
    ensure!(bytes < MOST_BYTES, "the page is larger than {MOST_BYTES} bytes");
    Ok(())
}

/// Returns the public address of the source, if the repository has one.
fn source() -> Option<String> {
    let mut git = Command::new("git");
    let address =
        command::output(git.args(["config", "--get", "remote.origin.url"]).current_dir(command::root()))
            .ok()?;
    let address = address.trim().trim_end_matches(".git");
    // An address with a user name or a secret is private.
    (address.starts_with("https://") && !address.contains('@')).then(|| address.to_owned())
}

/// Writes the API reference of the libraries by rustdoc.
fn reference(folder: &Path) -> Result<()> {
    let mut doc = cargo(&["doc", "--no-deps", "--lib"]);
    for name in API {
        doc.args(["--package", name]);
    }
    // Uses a separate target folder: the usual one has other documentation.
    let target = command::target().join("web-doc");
    command::run(doc.arg("--target-dir").arg(&target))?;
    copy(&target.join("doc"), &folder.join("api"))
}

/// Copies a folder recursively.
pub fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to).with_context(|| to.display().to_string())?;
    for entry in fs::read_dir(from).with_context(|| from.display().to_string())? {
        let entry = entry?;
        let (from, to) = (entry.path(), to.join(entry.file_name()));
        if from.is_dir() { copy(&from, &to)? } else { _ = fs::copy(from, to)? }
    }
    Ok(())
}

/// Returns the path of `wasm-bindgen`, in the version of the lock file.
pub fn binder() -> Result<PathBuf> {
    let lock = fs::read_to_string(command::root().join("Cargo.lock")).context("Cargo.lock")?;
    let after =
        lock.split_once("name = \"wasm-bindgen\"\nversion = \"").context("no wasm-bindgen in Cargo.lock")?.1;
    let version = after.split('"').next().unwrap_or_default();
    let root = command::target().join("tools");
    let program = root.join("bin/wasm-bindgen");
    let answer = Command::new(&program).arg("--version").output().map(|out| out.stdout).unwrap_or_default();
    if !String::from_utf8_lossy(&answer).contains(version) {
        let mut install = cargo(&["install", "wasm-bindgen-cli", "--version", version, "--root"]);
        command::run(install.arg(&root))?;
    }
    Ok(program)
}

/// Returns the bytes of a file after gzip.
pub fn gzipped(path: &Path) -> Result<u64> {
    let out = Command::new("gzip").args(["-9", "-c"]).arg(path).output().context("gzip")?;
    ensure!(out.status.success(), "gzip: {}", String::from_utf8_lossy(&out.stderr));
    Ok(out.stdout.len() as u64)
}

/// Redraws the pictures of the start page: the demo's first frame, and the scenes of the gallery.
fn draw(folder: &Path) -> Result<()> {
    let gallery: Vec<Value> =
        landing::GALLERY.iter().map(|(scene, steps, ..)| json!([scene, steps])).collect();
    let pictures = command::root().join(PAGE);
    fs::create_dir_all(pictures.join("gallery"))?;
    browser("pictures", folder, &pictures, &json!({"gallery": gallery}))?;
    fs::copy(pictures.join("poster.jpg"), folder.join("poster.jpg"))?;
    copy(&pictures.join("gallery"), &folder.join("gallery"))
}

/// Runs the script in a browser and returns its output.
fn browser(task: &str, folder: &Path, pictures: &Path, cases: &Value) -> Result<Value> {
    command::provide("chromium", "chromium")?;
    command::provide("node", "nodejs")?;
    let mut node = Command::new("node");
    node.args(["--no-warnings", "--experimental-websocket"]);
    node.arg(command::root().join("xtask/src/browser.mjs")).args([task.as_ref(), folder, pictures]);
    command::output_json(node.arg(cases.to_string()).stderr(Stdio::inherit()))
}

/// Opens the page in a browser, by WebGL2 and by WebGPU.
fn tried(folder: &Path) -> Result<()> {
    let pictures = command::target().join("web");
    fs::create_dir_all(&pictures)?;
    let expected = SCENES.iter().map(|scene| golden::committed(scene)).collect::<Result<Vec<_>>>()?;
    let scenes: Vec<Value> =
        SCENES.iter().zip(&expected).map(|(scene, (steps, _))| json!([scene, steps])).collect();
    let dropped = command::root().join(ragdolls::SHARED).join(DROPPED);
    // Chromium does not read files by a path with `..`.
    let drop: Vec<PathBuf> = dropped.canonicalize().into_iter().collect();
    if drop.is_empty() {
        eprintln!("skipped: {DROPPED} is missing");
    }
    let answer = browser("check", folder, &pictures, &json!({"scenes": scenes, "drop": drop}))?;
    eprintln!("{answer:#}\npictures in {}", pictures.display());
    for (way, answer) in answer.as_object().context("no outcome")? {
        for (scene, (steps, hash)) in SCENES.iter().zip(&expected) {
            let found = &answer["hashes"][scene];
            if found != hash {
                bail!("{way}: {scene} has {found} after {steps} steps, elsewhere {hash}");
            }
        }
        // Makes a single attempt, regardless of other load: the limit is for an idle machine.
        if answer["ready_again_ms"].as_u64().is_none_or(|ms| ms > MOST_MS) {
            eprintln!("{way}: more than {MOST_MS} ms to the first picture");
        }
    }
    Ok(())
}
