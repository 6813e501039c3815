//! Tests the bindings to C and Python like a user: library and header with `cc`, the wheel in an empty environment.

use crate::command;
use crate::new_user::{blocks, read};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const MANIFEST: &str = "bindings/Cargo.toml";
/// Pages whose programs are run.
const C_PAGES: &[&str] = &["docs/c.md"];
const PYTHON_PAGES: &[&str] = &["README.md", "docs/python.md"];
/// Strict warnings, so that the header causes no warning in a user's build.
const WARNINGS: &[&str] = &["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror"];
/// System libraries that the static library needs on Linux.
const SYSTEM: &[&str] = &["-lm", "-lpthread", "-ldl"];

/// `cargo xtask bindings`.
#[derive(clap::Args)]
pub struct Bindings {
    /// Only C
    #[arg(long, conflicts_with = "python")]
    c: bool,
    /// Only Python
    #[arg(long)]
    python: bool,
}

impl Bindings {
    /// Tests both bindings, or the requested one.
    ///
    /// # Errors
    /// The errors of [`c`] and [`python`].
    pub fn run(&self) -> Result<()> {
        if !self.python {
            c()?;
        }
        if self.c { Ok(()) } else { python() }
    }
}

fn target() -> PathBuf {
    command::target().join("bindings")
}

fn cargo(arguments: &[&str]) -> Command {
    let mut cargo = command::cargo(arguments);
    cargo.args(["--release", "--locked", "--manifest-path", MANIFEST, "--target-dir"]).arg(target());
    cargo
}

/// Runs the library's tests, checks its header, and builds and runs its example and the programs of the pages: plainly,
/// as C++, and with the address sanitizer.
///
/// # Errors
/// If a program does not build, or its exit status is not 0.
pub fn c() -> Result<()> {
    let both = ["-p", "sinew_c", "-p", "sinew_bindings"];
    command::run(cargo(&["clippy", "--all-targets"]).args(both).args(["--", "-D", "warnings"]))?;
    command::run(cargo(&["test"]).args(both))?;
    command::run(cargo(&["build"]).args(["-p", "sinew_c"]))?;
    let folder = target().join("c");
    fs::create_dir_all(&folder)?;
    let mut programs = vec![command::root().join("bindings/c/examples/fall.c")];
    for page in C_PAGES {
        let printed = blocks(&read(page)?, "c");
        if printed.is_empty() {
            bail!("{page}: the page has no program in C");
        }
        for (index, program) in printed.iter().enumerate() {
            let name = page.replace(['/', '.'], "_");
            let path = folder.join(format!("{name}_{index}.c"));
            fs::write(&path, program).with_context(|| path.display().to_string())?;
            programs.push(path);
        }
    }
    for program in &programs {
        compile_and_run(program, &folder, &[])?;
        compile_and_run(
            program,
            &folder,
            &["-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"],
        )?;
    }
    let header = command::root().join("bindings/c/include/sinew.h");
    command::run(
        Command::new("c++")
            .args(["-x", "c++", "-std=c++11", "-Wall", "-Werror", "-fsyntax-only"])
            .arg(header),
    )
}

fn compile_and_run(program: &Path, folder: &Path, options: &[&str]) -> Result<()> {
    let kind = if options.is_empty() { "plain" } else { "checked" };
    let binary =
        folder.join(program.file_stem().context("the program has no file name")?).with_extension(kind);
    let include = command::root().join("bindings/c/include");
    let mut cc = Command::new("cc");
    cc.args(WARNINGS).args(options).arg("-I").arg(include).arg(program);
    command::run(cc.arg(target().join("release/libsinew_c.a")).args(SYSTEM).arg("-o").arg(&binary))?;
    command::run(Command::new(binary).env("ASAN_OPTIONS", "detect_leaks=1").stdout(Stdio::null()))
}

/// Builds the wheel and installs it in its own environment: its tests, its types, the programs of the pages, the
/// notebook, and Ray on two workers.
///
/// # Errors
/// If a part fails, or there is no network.
pub fn python() -> Result<()> {
    command::run(cargo(&["clippy"]).args(["-p", "sinew_py", "--", "-D", "warnings"]))?;
    let folder = target().join("python");
    // Remove the results of an earlier run.
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    let (builder, user) = (folder.join("builder"), folder.join("user"));
    for venv in [&builder, &user] {
        command::run(Command::new("python3").args(["-m", "venv"]).arg(venv))?;
    }
    let source = command::root().join("bindings/python");
    command::run(pip(&builder).arg("maturin>=1.7,<2"))?;
    let wheel = wheel(&builder, &folder.join("wheels"))?;
    let with_extras = format!("sinew[gym,ray] @ file://{}", wheel.display());
    command::run(pip(&user).arg(with_extras))?;
    command::run(pip(&user).args(["pytest", "mypy", "matplotlib", "nbconvert", "ipykernel", "usd-core"]))?;
    let run = |program: &str, arguments: &[&str], place: &Path| {
        command::run(Command::new(user.join("bin").join(program)).args(arguments).current_dir(place))
    };
    // Runs in a separate folder, so that the tests use the installed package and not the sources.
    let tests = folder.join("tests");
    copy(&source.join("tests"), &tests)?;
    run("pytest", &["-q", "."], &tests)?;
    let settings = source.join("pyproject.toml").display().to_string();
    run("mypy", &["--config-file", &settings], &tests)?;
    run("python", &["-m", "mypy.stubtest", "sinew._sinew"], &tests)?;
    for (index, program) in printed(PYTHON_PAGES, "python")?.into_iter().enumerate() {
        let name = format!("page_{index}.py");
        fs::write(tests.join(&name), program)?;
        run("mypy", &["--strict", &name], &tests)?;
        run("python", &[&name], &tests)?;
    }
    command::run(Command::new("python3").arg(source.join("api_page.py")).arg("--check"))?;
    let training = source.join("examples/train.py").display().to_string();
    run("python", &[&training], &tests)?;
    let notebook = source.join("notebooks/fall.ipynb");
    let mut convert = Command::new(user.join("bin/python"));
    convert.args(["-m", "nbconvert", "--to", "html", "--execute", "--output-dir"]).arg(&folder).arg(notebook);
    command::run(convert.current_dir(&tests).env("PATH", path_with(&user.join("bin"))))
}

/// Returns the start of a command that installs packages into an environment.
pub fn pip(venv: &Path) -> Command {
    let mut pip = Command::new(venv.join("bin/pip"));
    pip.args(["install", "--quiet", "--disable-pip-version-check"]);
    pip
}

/// Builds the wheel by the maturin of an environment into a folder, which is emptied first.
///
/// # Errors
/// If the wheel does not build.
pub fn wheel(builder: &Path, out: &Path) -> Result<PathBuf> {
    if out.exists() {
        fs::remove_dir_all(out)?;
    }
    let mut build = Command::new(builder.join("bin/maturin"));
    build.args(["build", "--release", "--locked", "--out"]).arg(out);
    let source = command::root().join("bindings/python");
    command::run(build.current_dir(source).env("CARGO_TARGET_DIR", target()))?;
    let wheels = fs::read_dir(out)?.collect::<std::io::Result<Vec<_>>>()?;
    Ok(wheels.first().context("maturin built no wheel")?.path())
}

/// Returns the programs on pages.
fn printed(pages: &[&str], language: &str) -> Result<Vec<String>> {
    let mut all = Vec::new();
    for page in pages {
        let programs = blocks(&read(page)?, language);
        if programs.is_empty() {
            bail!("{page}: the page has no program in {language}");
        }
        all.extend(programs);
    }
    Ok(all)
}

fn path_with(first: &Path) -> std::ffi::OsString {
    let mut path = first.as_os_str().to_owned();
    if let Some(rest) = std::env::var_os("PATH") {
        path.push(":");
        path.push(rest);
    }
    path
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        if entry.file_type()?.is_file() {
            fs::copy(entry.path(), to.join(entry.file_name()))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pages_have_programs() {
        assert!(
            C_PAGES.iter().all(|page| !blocks(&read(page).expect("the file can be read"), "c").is_empty())
        );
        assert!(printed(PYTHON_PAGES, "python").is_ok());
    }
}
