//! The extension for Blender: its zip with the wheel, and its test in Blender's Python module.

use crate::bindings;
use crate::command;
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::PathBuf;
use std::process::Command;

/// Blender as a module, and its Python.
const BPY: &str = "bpy==5.0.1";
const PYTHON: &str = "python3.11";
/// Rigs of tests/rigs.py for the whole test; those of files need the data.
const RIGS: &[&str] = &["cesium_man", "knight", "rigify_human", "fox", "scale_100"];
const DATA: &str = "../shared/data";

/// `cargo xtask blender`.
#[derive(clap::Args)]
pub struct Blender {
    /// Also install it into Blender's Python module (1 GB from PyPI) and test everything on five rigs
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

/// Tests the zip, installed by Blender's own operator with empty settings: every operator, and the whole workflow on each rig.
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
    RIGS.iter().try_for_each(|rig| run(&["job.py", rig]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_manifest_has_the_version_of_the_wheel() {
        let source = command::root().join("integrations/blender/sinew_blender");
        let version = format!("version = \"{}\"", env!("CARGO_PKG_VERSION"));
        let manifest = fs::read_to_string(source.join("blender_manifest.toml")).expect("it is there");
        assert!(manifest.contains(&version), "blender_manifest.toml: not {version}");
        let init = fs::read_to_string(source.join("__init__.py")).expect("it is there");
        let numbers = format!("\"version\": ({})", env!("CARGO_PKG_VERSION").replace('.', ", "));
        assert!(init.contains(&numbers), "__init__.py: not {numbers}");
    }
}
