//! First steps of a new user: the programs in README and guide, in an empty folder outside the workspace.

use crate::command;
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::Path;
use std::process::Command;

/// A page whose programs are tested, and the name of their project.
const PAGES: &[(&str, &str)] = &[("README.md", "readme"), ("docs/guide/src/first_ragdoll.md", "guide")];
const BEVY_PAGE: &str = "integrations/bevy_sinew/README.md";

/// `cargo xtask new-user`.
#[derive(clap::Args)]
pub struct NewUser {
    /// The plugin for Bevy as well
    #[arg(long)]
    bevy: bool,
}

impl NewUser {
    /// Tests the library, and the plugin on request.
    ///
    /// # Errors
    /// The errors of [`library`] and [`bevy`].
    pub fn run(&self) -> Result<()> {
        library()?;
        if self.bevy { bevy() } else { Ok(()) }
    }
}

/// Builds and runs the programs of README and of the guide's first chapter in release builds, without kernels for
/// processors that lack AVX2: they take a third of the compile time.
///
/// # Errors
/// If a program fails.
pub fn library() -> Result<()> {
    let path = command::root().join("crates/sinew");
    let features = r#"default-features = false, features = ["formats", "parallel"]"#;
    let dependencies = format!("sinew = {{ path = {path:?}, {features} }}\n");
    PAGES.iter().try_for_each(|&(page, name)| project(name, page, &dependencies, &["--release"]))
}

/// Builds and runs the program of the plugin's README with its listed dependencies, in a debug build, which takes half
/// the time.
///
/// # Errors
/// If the program does not build or run, or lists no dependencies.
pub fn bevy() -> Result<()> {
    let text = read(BEVY_PAGE)?;
    let listed = blocks(&text, "toml").into_iter().find(|block| block.contains("bevy_app"));
    let listed = listed.context("the page has no `toml` block with the dependencies")?;
    let path = command::root().join("integrations/bevy_sinew");
    let by_path = |line: &str| match line.split_once(" = ") {
        Some(("bevy_sinew", _)) => format!("bevy_sinew = {{ path = {path:?} }}\n"),
        _ => format!("{line}\n"),
    };
    let lines = listed.lines().filter(|line| *line != "[dependencies]");
    project("bevy", BEVY_PAGE, &lines.map(by_path).collect::<String>(), &[])
}

pub fn read(page: &str) -> Result<String> {
    fs::read_to_string(command::root().join(page)).with_context(|| page.to_owned())
}

/// Creates a project in an empty folder with each Rust block of a page as a program, and runs all.
fn project(name: &str, page: &str, dependencies: &str, profile: &[&str]) -> Result<()> {
    let folder = std::env::temp_dir().join(format!("sinew-new-user-{name}-{}", std::process::id()));
    fs::create_dir_all(folder.join("src/bin")).with_context(|| folder.display().to_string())?;
    let outcome = try_in(&folder, name, page, dependencies, profile).with_context(|| page.to_owned());
    fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
    outcome
}

fn try_in(folder: &Path, name: &str, page: &str, dependencies: &str, profile: &[&str]) -> Result<()> {
    let programs = blocks(&read(page)?, "rust");
    if programs.is_empty() {
        bail!("the page has no program in Rust");
    }
    let manifest = format!(
        "[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[dependencies]\n{dependencies}"
    );
    fs::write(folder.join("Cargo.toml"), manifest)?;
    for (index, program) in programs.iter().enumerate() {
        fs::write(folder.join(format!("src/bin/{name}_{index}.rs")), whole(program))?;
    }
    for index in 0..programs.len() {
        let mut run = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        run.args(["run", "--quiet", "--bin", &format!("{name}_{index}")]).args(profile).current_dir(folder);
        run.arg("--target-dir").arg(command::target().join("new_user"));
        // Remove build variables of `cargo xtask`, which a new user does not have.
        for variable in ["CARGO_MANIFEST_DIR", "CARGO_PKG_NAME", "RUSTFLAGS"] {
            run.env_remove(variable);
        }
        command::run(run.stdout(std::process::Stdio::null()))?;
    }
    Ok(())
}

/// Returns a program with a `main`: the text's own, or one around the text.
fn whole(program: &str) -> String {
    if program.contains("fn main()") { program.to_owned() } else { format!("fn main() {{\n{program}}}\n") }
}

/// Returns the fenced blocks of a language as a reader sees them, without lines that only tests use.
pub fn blocks(text: &str, language: &str) -> Vec<String> {
    let mut blocks = Vec::new();
    let mut open: Option<(bool, String)> = None;
    for line in text.lines() {
        match (&mut open, line.strip_prefix("```")) {
            (None, Some(info)) => open = Some((info == language, String::new())),
            (Some(_), Some(_)) => blocks.extend(open.take().filter(|block| block.0).map(|block| block.1)),
            (Some((_, block)), None) if line != "#" && !line.starts_with("# ") => {
                block.push_str(line);
                block.push('\n');
            }
            _ => {}
        }
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_extracted_as_printed() {
        let page = "Text.\n\n```rust\nlet x = 1;\n# let hidden = 2;\n#[derive(Debug)]\nstruct A;\n```\n\n\
                    ```sh\ncargo run\n```\n\n```rust\nfn main() {}\n```\n";
        let programs = blocks(page, "rust");
        assert_eq!(programs, ["let x = 1;\n#[derive(Debug)]\nstruct A;\n", "fn main() {}\n"]);
        assert_eq!(whole(&programs[0]), "fn main() {\nlet x = 1;\n#[derive(Debug)]\nstruct A;\n}\n");
        assert_eq!(whole(&programs[1]), programs[1]);
        assert_eq!(blocks(page, "sh"), ["cargo run\n"]);
    }

    #[test]
    fn every_page_has_programs() {
        for page in PAGES.iter().map(|page| page.0).chain([BEVY_PAGE]) {
            assert!(!blocks(&read(page).expect("the file can be read"), "rust").is_empty(), "{page}");
        }
        let listed = blocks(&read(BEVY_PAGE).expect("the file can be read"), "toml");
        assert!(listed.iter().all(|block| block.contains("bevy_sinew = ")) && listed.len() == 2);
    }

    /// The page shows the program that the package `window` compiles.
    #[test]
    fn program_with_a_window_is_the_compiled_one() {
        let shown = blocks(&read(BEVY_PAGE).expect("the file can be read"), "rust,ignore").swap_remove(0);
        let file = read("integrations/bevy_sinew/window/examples/first.rs").expect("the file can be read");
        let (_, program) = file.split_once("\n\n").expect("the program follows a comment");
        assert_eq!(shown, program);
    }
}
