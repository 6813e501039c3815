//! Runs other programs, mainly cargo and the `sinew` binary.

use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Returns the root of the workspace.
pub fn root() -> PathBuf {
    // Cargo sets the variable; the compile-time value serves a binary started by hand.
    let manifest = env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
    let manifest = PathBuf::from(manifest);
    manifest.parent().map(Path::to_path_buf).unwrap_or(manifest)
}

/// Returns the target folder.
pub fn target() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// Returns a command of the running cargo in the root of the repository.
pub fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).current_dir(root());
    command
}

/// Runs `command` with its output on the console.
///
/// # Errors
/// If the command does not start, or does not exit with 0.
pub fn run(command: &mut Command) -> Result<()> {
    eprintln!("$ {}", shown(command));
    let status = command.status().with_context(|| format!("cannot start `{}`", shown(command)))?;
    if !status.success() {
        bail!("`{}`: {status}", shown(command));
    }
    Ok(())
}

/// Runs `command` and returns its stdout; stderr goes to the console.
///
/// # Errors
/// If the command does not start, does not exit with 0, or writes something that is not UTF-8.
pub fn output(command: &mut Command) -> Result<String> {
    let output = command
        .stderr(Stdio::inherit())
        .output()
        .with_context(|| format!("cannot start `{}`", shown(command)))?;
    if !output.status.success() {
        bail!("`{}`: {}", shown(command), output.status);
    }
    String::from_utf8(output.stdout).with_context(|| format!("`{}`", shown(command)))
}

/// Runs `command` and parses its stdout as one JSON value.
///
/// # Errors
/// The errors of [`output`], and if stdout is anything but one JSON value.
pub fn output_json(command: &mut Command) -> Result<Value> {
    let text = output(command)?;
    serde_json::from_str(&text).with_context(|| format!("`{}`: stdout is not one JSON value", shown(command)))
}

/// Returns true if there is a program of that name.
pub fn answers(program: &str) -> bool {
    let mut command = Command::new(program);
    command.arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

/// Installs Debian's `package` unless `program` exists. Reads the package lists first, which a fresh machine
/// lacks.
///
/// # Errors
/// If the installation fails.
pub fn provide(program: &str, package: &str) -> Result<()> {
    if answers(program) {
        return Ok(());
    }
    run(Command::new("apt-get").arg("update"))
        .and_then(|()| run(Command::new("apt-get").args(["install", "--yes", package])))
        .with_context(|| format!("`{program}` is missing (Debian's package `{package}`)"))
}

/// Build profile of the `sinew` binary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Profile {
    /// Debug build, with overflow checks and debug assertions.
    Debug,
    /// Release build, the profile that users have.
    Release,
}

/// Builds the command line without its window and returns the path of its binary.
///
/// # Errors
/// If the command line does not compile.
pub fn build_sinew(profile: Profile) -> Result<PathBuf> {
    let mut command = cargo(&["build", "--package", "sinew_cli"]);
    if profile == Profile::Release {
        command.arg("--release");
    }
    build(&mut command, "sinew")
}

/// Returns the path of the debug binary that the tests run, with the window. After the tests it needs no compiling; the
/// command line alone has other features and takes two minutes.
///
/// # Errors
/// If the tests do not compile.
pub fn sinew_of_tests() -> Result<PathBuf> {
    let arguments = ["test", "--workspace", "--features", "sinew_cli/viewer", "--tests", "--no-run"];
    build(&mut cargo(&arguments), "sinew")
}

/// Runs `command`, a `cargo build`, and returns the path of the executable `name` in any target folder.
///
/// # Errors
/// If the build fails.
pub fn build(command: &mut Command, name: &str) -> Result<PathBuf> {
    command.args(["--message-format", "json-render-diagnostics"]);
    eprintln!("$ {}", shown(command));
    let messages = output(command)?;
    messages
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok())
        .filter(|message| message["target"]["name"] == name && message["profile"]["test"] == false)
        .find_map(|message| message["executable"].as_str().map(PathBuf::from))
        .with_context(|| format!("cargo names no executable `{name}`"))
}

fn shown(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_name().unwrap_or(command.get_program());
    let words = std::iter::once(program).chain(command.get_args());
    words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
}
