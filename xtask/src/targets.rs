//! Other processors: builds the code for them, and checks that WebAssembly computes the bits of x86-64.

use crate::command;
use anyhow::Result;
use std::process::Command;

/// Target of browsers.
pub const BROWSER: &str = "wasm32-unknown-unknown";

/// Target of programs that Node runs.
const PROGRAM: &str = "wasm32-wasip1";

/// Target of phones and of some desktops.
const ARM: &str = "aarch64-unknown-linux-gnu";

/// Script that runs such a program in Node.
const RUNNER: &str = "xtask/src/wasi.mjs";

/// Tests that compare the eight lanes and their kernels with hashes of all processors. Only these are run here.
const SOUP: &str = "golden_soup";

/// Compiles the library for the browser.
///
/// # Errors
/// If the build fails.
pub fn browser() -> Result<()> {
    build_for(BROWSER, &["build", "--package", "sinew"])
}

/// Compiles for aarch64, without running.
///
/// # Errors
/// If the build fails.
pub fn arm() -> Result<()> {
    build_for(ARM, &["check", "--package", "sinew_math"])
}

fn build_for(target: &str, arguments: &[&str]) -> Result<()> {
    if let Err(error) = add(target) {
        eprintln!("{error:#}");
        eprintln!("SKIPPED: the target {target} cannot be added on this machine");
        return Ok(());
    }
    command::run(command::cargo(arguments).args(["--target", target]))
}

/// Checks that the hashes of all eight-lane operations are the same in Node, with vectors and without.
///
/// # Errors
/// If the bits differ, or the test does not compile.
pub fn soup() -> Result<()> {
    if let Err(missing) = add(PROGRAM).and_then(|()| command::provide("node", "nodejs")) {
        eprintln!("{missing:#}");
        eprintln!("SKIPPED: WebAssembly cannot be run on this machine");
        return Ok(());
    }
    for flags in ["", "-C target-feature=+simd128"] {
        eprintln!("RUSTFLAGS={flags:?}");
        soup_with(flags, &["--package", "sinew_math", "--lib"])?;
        soup_with(flags, &["--package", "sinew_geometry", "--test", "it"])?;
    }
    Ok(())
}

fn soup_with(flags: &str, tests: &[&str]) -> Result<()> {
    // Node 20 may crash at the end of a program whose memory has grown, unless it has one thread.
    let runner = format!("node --no-warnings --single-threaded {}", command::root().join(RUNNER).display());
    let mut test = command::cargo(&["test", "--target", PROGRAM]);
    test.args(tests).args(["--", SOUP]);
    command::run(test.env("RUSTFLAGS", flags).env("CARGO_TARGET_WASM32_WASIP1_RUNNER", runner))
}

/// Adds a target to the toolchain.
///
/// # Errors
/// If the installation fails.
pub fn add(target: &str) -> Result<()> {
    command::run(Command::new("rustup").args(["target", "add", target]))
}
