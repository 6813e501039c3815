//! The extension for Blender: its zip with the wheel, and its test in Blender's Python module.

use crate::bindings;
use crate::command;
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Blender as a module, and its Python.
const BPY: &str = "bpy==5.0.1";
const PYTHON: &str = "python3.11";
/// Rigs of tests/rigs.py for the whole test; those of files need the data.
const RIGS: &[&str] = &["cesium_man", "knight", "rigify_human", "fox", "scale_100", "gunner"];
/// Debian's packages for the test in a window.
const WINDOW: &[&str] = &["blender", "xvfb", "xauth", "python3-numpy", "libgl1-mesa-dri"];
const DATA: &str = "../shared/data";

/// `cargo xtask blender`.
#[derive(clap::Args)]
pub struct Blender {
    /// Also install it into Blender's Python module (1 GB from PyPI), test everything on six rigs, and take screenshots
    /// in a window
    #[arg(long)]
    check: bool,
}

impl Blender {
    /// Makes the zip, and tests it on request.
    ///
    /// # Errors
    /// If the zip cannot be made, or a test fails.
    pub fn run(&self) -> Result<()> {
        if self.check { check() } else { zip().map(drop) }
    }
}

fn folder() -> PathBuf {
    command::target().join("blender")
}

/// Builds the wheel and zips the extension with it.
fn zip() -> Result<PathBuf> {
    let folder = folder();
    fs::create_dir_all(&folder)?;
    let builder = folder.join("builder");
    if !builder.exists() {
        command::run(Command::new("python3").args(["-m", "venv"]).arg(&builder))?;
        command::run(bindings::pip(&builder).arg("maturin>=1.7,<2"))?;
    }
    let wheel = bindings::wheel(&builder, &folder.join("wheels"))?;
    let package = command::root().join("integrations/blender/package.py");
    let out = Command::new("python3").arg(package).arg(wheel).arg(&folder).output()?;
    if !out.status.success() {
        bail!("{}", String::from_utf8_lossy(&out.stderr));
    }
    let path = String::from_utf8(out.stdout)?.trim().to_owned();
    eprintln!("{path}");
    Ok(path.into())
}

/// Tests the zip, installed by Blender's own operator with empty settings: every operator, the whole workflow on each
/// rig, and a window.
///
/// # Errors
/// If a part fails, or there is no network.
pub fn check() -> Result<()> {
    let data = command::root().join(DATA);
    if !data.exists() {
        eprintln!("skipped: no {DATA} here");
        return Ok(());
    }
    if !command::answers(PYTHON) {
        eprintln!("skipped: no {PYTHON} here, which {BPY} is made for");
        return Ok(());
    }
    let zip = zip()?;
    let venv = folder().join("bpy");
    if !venv.exists() {
        command::run(Command::new(PYTHON).args(["-m", "venv"]).arg(&venv))?;
        command::run(bindings::pip(&venv).arg(BPY))?;
    }
    let settings = folder().join("settings");
    if settings.exists() {
        fs::remove_dir_all(&settings)?;
    }
    let tests = command::root().join("integrations/blender/tests");
    let run = |arguments: &[&str]| {
        let mut python = Command::new(venv.join("bin/python"));
        python.args(arguments).current_dir(&tests).env("PYTHONDONTWRITEBYTECODE", "1");
        python.env("SINEW_DATA", &data).env("SINEW_EXTENSION", &zip);
        command::run(python.env("BLENDER_USER_RESOURCES", &settings)).context(arguments.join(" "))
    };
    run(&["operators.py"])?;
    RIGS.iter().try_for_each(|rig| run(&["job.py", rig]))?;
    window(&tests, &data)
}

/// Tests the preview, the handles and the simulation in a window of an installed Blender, such as Debian's 3.4, and
/// leaves screenshots.
fn window(tests: &Path, data: &Path) -> Result<()> {
    let has_window = ["blender", "Xvfb"].into_iter().all(command::answers);
    if !has_window && !command::answers("apt-get") {
        eprintln!("skipped: no Blender and Xvfb here for the test in a window");
        return Ok(());
    }
    if !has_window {
        command::run(Command::new("apt-get").arg("update"))?;
        command::run(Command::new("apt-get").args(["install", "--yes"]).args(WINDOW))?;
    }
    let (wheel, shots) = (folder().join("unpacked"), folder().join("shots"));
    for made in [&wheel, &shots] {
        if made.exists() {
            fs::remove_dir_all(made)?;
        }
        fs::create_dir_all(made)?;
    }
    let wheels = fs::read_dir(folder().join("wheels"))?.collect::<std::io::Result<Vec<_>>>()?;
    let built = wheels.first().context("there is no wheel")?.path();
    let mut pip = bindings::pip(&folder().join("builder"));
    command::run(pip.args(["--no-deps", "--target"]).arg(&wheel).arg(built))?;
    let mut blender = Command::new("xvfb-run");
    blender.args([
        "-a",
        "-s",
        "-screen 0 1200x800x24",
        "blender",
        "--factory-startup",
        "--enable-event-simulate",
    ]);
    blender.args(["--window-geometry", "0", "0", "1200", "800", "-P"]).arg(tests.join("window.py"));
    blender.env("PYTHONDONTWRITEBYTECODE", "1").env("BLENDER_USER_RESOURCES", folder().join("settings"));
    command::run(blender.env("SINEW_DATA", data).env("SINEW_WHEEL", &wheel).env("SINEW_SHOTS", &shots))?;
    eprintln!("look at {}", shots.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_manifest_has_the_version_of_the_wheel() {
        let source = command::root().join("integrations/blender/sinew_blender");
        let version = format!("version = \"{}\"", env!("CARGO_PKG_VERSION"));
        let manifest =
            fs::read_to_string(source.join("blender_manifest.toml")).expect("the file can be read");
        assert!(manifest.contains(&version), "blender_manifest.toml: not {version}");
        let init = fs::read_to_string(source.join("__init__.py")).expect("the file can be read");
        let numbers = format!("\"version\": ({})", env!("CARGO_PKG_VERSION").replace('.', ", "));
        assert!(init.contains(&numbers), "__init__.py: not {numbers}");
    }
}
