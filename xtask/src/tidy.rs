//! Project rules that the compiler does not check. Each rule is one file and one function from the repository to
//! findings; a test beside it plants a violation and expects its finding.
//!
//! The rules read tokens, not types ([`lexer`]): comments and strings never trigger a rule, but the rules miss names
//! that are reached through a macro or an alias. Rules that need types are in `clippy.toml` (`disallowed-methods`).

mod arrows;
mod bits;
mod circles;
mod code_map;
mod contract_table;
mod dependencies;
mod doc_examples;
mod first_words;
mod guide;
mod leftovers;
mod lexer;
mod libraries;
mod public;
mod python_names;
mod rooms;
mod size;
mod stages;
mod tuning;
mod unsafety;

use crate::command;
use anyhow::{Context, Result, bail};
use lexer::Token;
use serde_json::Value;
use std::fmt;
use std::fs;
use std::path::Path;

/// The rules, in the order in which their findings are printed.
const RULES: &[fn(&Repo) -> Vec<Finding>] = &[
    arrows::check,
    rooms::check,
    circles::check,
    public::check,
    python_names::check,
    code_map::check,
    libraries::check,
    bits::check,
    size::check,
    unsafety::check,
    stages::check,
    contract_table::check,
    leftovers::check,
    dependencies::check,
    first_words::check,
    doc_examples::check,
    tuning::check,
    guide::check,
];

/// `cargo xtask tidy`.
#[derive(clap::Args)]
pub struct Tidy {
    /// Also print metrics of each crate
    #[arg(long)]
    table: bool,
}

impl Tidy {
    /// Runs the rules without the table.
    pub const CHECK: Self = Self { table: false };

    /// Prints violations of the rules, one line each.
    ///
    /// # Errors
    /// If there is a violation, or the repository cannot be read.
    pub fn run(&self) -> Result<()> {
        let repo = Repo::read()?;
        if self.table {
            println!("{}", table(&repo));
        }
        let findings = check(&repo);
        for finding in &findings {
            println!("{finding}");
        }
        if !findings.is_empty() {
            let plural = if findings.len() == 1 { "" } else { "s" };
            bail!("tidy: {} finding{plural}", findings.len());
        }
        Ok(())
    }
}

/// Returns a row for each crate: files, circles, and names at its root.
fn table(repo: &Repo) -> String {
    let mut text = "crate              files  flat  circle  back up  names\n".to_owned();
    for circles::House { name, files, flat, circle } in circles::houses(repo) {
        let back = rooms::arrows_back_up(name).map_or("–".to_owned(), |arrows| arrows.to_string());
        let names = public::offered(repo, name);
        text += &format!("{name:<18} {files:5} {flat:5} {circle:7} {back:>8} {names:6}\n");
    }
    text
}

fn check(repo: &Repo) -> Vec<Finding> {
    RULES.iter().flat_map(|rule| rule(repo)).collect()
}

/// A violation of a rule.
#[derive(Debug, PartialEq, Eq)]
pub struct Finding {
    file: String,
    line: usize,
    message: String,
}

impl Finding {
    /// Creates a finding; `line` counts from 1.
    pub fn new(file: &str, line: usize, message: impl Into<String>) -> Self {
        Self { file: file.to_owned(), line, message: message.into() }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file, self.line, self.message)
    }
}

/// A text file of the repository.
pub struct File {
    /// Path from the root, with `/` on every system.
    pub path: String,
    /// Contents.
    pub text: String,
}

impl File {
    fn is_rust(&self) -> bool {
        self.path.ends_with(".rs")
    }

    /// Returns the name of the crate whose `src` folder holds this file.
    fn crate_of_source(&self) -> Option<&str> {
        let (name, inside) = self.path.strip_prefix("crates/")?.split_once('/')?;
        (self.is_rust() && inside.starts_with("src/")).then_some(name)
    }

    fn tokens(&self) -> Vec<Token<'_>> {
        lexer::tokens(&self.text)
    }

    /// Returns the tokens without `#[cfg(test)]` items; none for a file of tests.
    fn tokens_without_tests(&self) -> Vec<Token<'_>> {
        let is_test = self.path.contains("/tests/") || self.path.ends_with("/tests.rs");
        if is_test { Vec::new() } else { lexer::without_tests(&self.tokens()) }
    }
}

/// The repository as input of the rules.
pub struct Repo {
    /// Text files, by path.
    pub files: Vec<File>,
    /// Output of `cargo metadata --no-deps`.
    metadata: Value,
}

impl Repo {
    /// # Errors
    /// If a folder cannot be read, or cargo fails.
    pub fn read() -> Result<Self> {
        let mut files = Vec::new();
        let root = command::root();
        collect(&root, "", &mut files).with_context(|| root.display().to_string())?;
        let metadata =
            command::output_json(&mut command::cargo(&["metadata", "--no-deps", "--format-version", "1"]))?;
        Ok(Self { files, metadata })
    }

    /// Returns the file at `path`, if it exists.
    pub fn file(&self, path: &str) -> Option<&File> {
        self.files.iter().find(|file| file.path == path)
    }

    fn rust_files(&self) -> impl Iterator<Item = &File> {
        self.files.iter().filter(|file| file.is_rust())
    }

    /// Returns the packages of the workspace.
    fn packages(&self) -> impl Iterator<Item = &Value> {
        self.metadata["packages"].as_array().into_iter().flatten()
    }
}

/// Returns true for a folder without source files. Build folders are named like `target` or `target-something`; `.git`
/// is a file in a linked working tree.
fn is_foreign(name: &str) -> bool {
    name == ".git" || name == "out" || name == "node_modules" || name.starts_with("target")
}

fn collect(folder: &Path, prefix: &str, files: &mut Vec<File>) -> std::io::Result<()> {
    let mut entries = fs::read_dir(folder)?.collect::<std::io::Result<Vec<_>>>()?;
    entries.sort_by_key(fs::DirEntry::file_name);
    for entry in entries {
        let name = entry.file_name().to_string_lossy().into_owned();
        let path = format!("{prefix}{name}");
        let kind = entry.file_type()?;
        if is_foreign(&name) {
            continue;
        }
        if kind.is_dir() {
            collect(&entry.path(), &format!("{path}/"), files)?;
        } else if kind.is_file()
            && let Ok(text) = String::from_utf8(fs::read(entry.path())?)
        {
            files.push(File { path, text });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Repo {
        /// Returns a repository of these files (path, text) and no packages.
        pub(crate) fn planted(files: &[(&str, &str)]) -> Self {
            let files = files.iter().map(|&(path, text)| File { path: path.into(), text: text.into() });
            Self { files: files.collect(), metadata: Value::Null }
        }

        /// Returns a repository of these packages, as `cargo metadata` writes them, and no files.
        pub(crate) fn planted_packages(packages: &Value) -> Self {
            Self { files: Vec::new(), metadata: serde_json::json!({ "packages": packages }) }
        }
    }

    /// Checks that `rule`, on a repository with only `text` at `path`, finds these lines.
    pub(crate) fn check_lines(rule: fn(&Repo) -> Vec<Finding>, path: &str, text: &str, expected: &[usize]) {
        let findings = rule(&Repo::planted(&[(path, text)]));
        let lines: Vec<usize> = findings.iter().map(|finding| finding.line).collect();
        assert_eq!(lines, expected, "{findings:#?}");
    }

    #[test]
    fn repository_has_no_findings() {
        let findings = check(&Repo::read().expect("the repository can be read"));
        let text: Vec<String> = findings.iter().map(ToString::to_string).collect();
        assert!(findings.is_empty(), "{} findings:\n{}", text.len(), text.join("\n"));
    }

    #[test]
    fn finding_is_formatted_like_a_compiler_message() {
        assert_eq!(Finding::new("a/b.rs", 7, "too long").to_string(), "a/b.rs:7: too long");
    }
}
