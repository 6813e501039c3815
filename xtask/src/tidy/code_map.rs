//! Compares the code map of `ARCHITECTURE.md` with the code: every named file exists, and every file and folder at the
//! top of a crate is named.

use super::{Finding, Repo};

const MAP: &str = "ARCHITECTURE.md";
/// Other pages with names of files.
const PAGES: &[&str] = &["CONTRIBUTING.md", "docs/step.md", "docs/glossary.md"];

/// Checks that each section of a crate names its files and folders, and no others; and that files named by other pages
/// exist.
pub fn check(repo: &Repo) -> Vec<Finding> {
    let mut findings: Vec<Finding> = PAGES.iter().flat_map(|page| missing(repo, page)).collect();
    findings.extend(check_map(repo));
    findings
}

/// Returns findings for files that a page names and that do not exist.
fn missing(repo: &Repo, page: &str) -> Vec<Finding> {
    let text = repo.file(page).map_or("", |file| file.text.as_str());
    let lines = text
        .lines()
        .enumerate()
        .flat_map(|(index, line)| code(line).into_iter().map(move |name| (name, index + 1)));
    let is_file = |name: &str| name.ends_with(".rs") && name.len() > 3 && name.chars().all(is_path);
    let is_there =
        |name: &str| repo.rust_files().any(|file| format!("/{}", file.path).ends_with(&format!("/{name}")));
    let within = |name: &str| {
        name.split_once('/').is_some_and(|(first, rest)| {
            let path = format!("crates/{first}/src/{rest}");
            repo.file(&path).is_some()
        })
    };
    lines
        .filter(|(name, _)| is_file(name) && !is_there(name) && !within(name))
        .map(|(name, line)| Finding::new(page, line, format!("there is no `{name}`")))
        .collect()
}

fn check_map(repo: &Repo) -> Vec<Finding> {
    let Some(map) = repo.file(MAP) else { return Vec::new() };
    let mut findings = Vec::new();
    for section in sections(&map.text) {
        let root = format!("crates/{}/src/", section.name);
        let files: Vec<&str> = repo.files.iter().filter_map(|file| file.path.strip_prefix(&root)).collect();
        if files.is_empty() {
            continue;
        }
        let named: Vec<(String, usize)> = section
            .lines()
            .flat_map(|(line, number)| code(line).into_iter().map(move |name| (name, number)))
            .collect();
        for (name, number) in named.iter().filter(|(name, _)| is_place(name)) {
            let is_there = |file: &&str| match name.strip_suffix('/') {
                Some(folder) => format!("/{file}").contains(&format!("/{folder}/")),
                None => format!("/{file}").ends_with(&format!("/{name}")),
            };
            if !files.iter().any(is_there) {
                let message = format!("{} has no `{name}`", section.name);
                findings.push(Finding::new(MAP, *number, message));
            }
        }
        let code = files.iter().filter(|file| file.ends_with(".rs"));
        let mut tops: Vec<String> = code.map(|file| top(file)).collect();
        tops.dedup();
        for top in tops.iter().filter(|top| !matches!(top.as_str(), "lib.rs" | "main.rs")) {
            let is_named = |name: &str| name == top || top.ends_with('/') && name.starts_with(top.as_str());
            if !named.iter().any(|(name, _)| is_named(name)) {
                let message = format!("the section of {} does not name `{top}`", section.name);
                findings.push(Finding::new(MAP, section.start, message));
            }
        }
    }
    findings
}

/// Returns the folder or file at the top of `src/`, folders with a slash.
fn top(file: &str) -> String {
    match file.split_once('/') {
        Some((folder, _)) => format!("{folder}/"),
        None => file.to_owned(),
    }
}

/// Part of the map about one crate.
struct Section<'a> {
    name: &'a str,
    text: Vec<&'a str>,
    /// Line of its heading, from 1.
    start: usize,
}

impl<'a> Section<'a> {
    fn lines(&self) -> impl Iterator<Item = (&'a str, usize)> {
        self.text.iter().enumerate().map(|(index, line)| (*line, self.start + 1 + index))
    }
}

/// Returns the sections under headings like "### `sinew_math`".
fn sections(text: &str) -> Vec<Section<'_>> {
    let mut sections: Vec<Section<'_>> = Vec::new();
    let mut is_within = false;
    for (index, line) in text.lines().enumerate() {
        if line.starts_with('#') {
            let name = line.strip_prefix("### `").and_then(|rest| rest.strip_suffix('`'));
            is_within = name.is_some();
            sections.extend(name.map(|name| Section { name, text: Vec::new(), start: index + 1 }));
        } else if let Some(section) = sections.last_mut().filter(|_| is_within) {
            section.text.push(line);
        }
    }
    sections
}

/// Returns the code in a line, with `{a,b}.rs` expanded.
fn code(line: &str) -> Vec<String> {
    let pieces = line.split('`').skip(1).step_by(2);
    pieces
        .flat_map(|piece| {
            let braces = piece.split_once('{').and_then(|(before, rest)| {
                let (list, after) = rest.split_once('}')?;
                Some(list.split(',').map(|one| format!("{before}{}{after}", one.trim())).collect())
            });
            braces.unwrap_or_else(|| vec![piece.to_owned()])
        })
        .collect()
}

fn is_path(c: char) -> bool {
    c.is_ascii_lowercase() || c.is_ascii_digit() || matches!(c, '_' | '/' | '.')
}

/// Returns true if a piece of code is a file or a folder of the crate.
fn is_place(name: &str) -> bool {
    let ends = name.ends_with(".rs") || name.ends_with('/');
    let is_of_root = ["crates/", "docs/", "xtask/", "fuzz/", "bench/", "tests/", "out/", "src/"];
    ends && name.chars().all(is_path) && !is_of_root.iter().any(|root| name.starts_with(root))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_with_a_missing_file_is_found() {
        let page = "`trig.rs`, `sinew_math/trig.rs` and `sinew_math/src/trig.rs`, `crates/sinew_math/src/trig.rs`,\n`sine.rs`";
        let repo = Repo::planted(&[("docs/step.md", page), ("crates/sinew_math/src/trig.rs", "")]);
        let found: Vec<String> = check(&repo).iter().map(ToString::to_string).collect();
        assert_eq!(found, ["docs/step.md:2: there is no `sine.rs`"]);
    }

    #[test]
    fn map_and_code_agree() {
        let found = |map: &str| -> Vec<String> {
            let files = [
                (MAP, map),
                ("crates/sinew_math/src/lib.rs", ""),
                ("crates/sinew_math/src/trig.rs", ""),
                ("crates/sinew_math/src/lanes/mod.rs", ""),
                ("crates/sinew_math/src/lanes/neon.rs", ""),
            ];
            check(&Repo::planted(&files)).iter().map(ToString::to_string).collect()
        };
        let whole =
            "# A\n\n### `sinew_math`\n\n| `trig.rs` | a |\n`lanes/` and `lanes/{mod,neon}.rs`, `f32::sin`\n";
        assert!(found(whole).is_empty());
        assert!(found("# A\n\n### `sinew_math`\n`trig.rs` `neon.rs` `lanes/neon.rs`\n").is_empty());
        assert_eq!(
            found("### `sinew_math`\n\n`trig.rs` `sse.rs`\n## End\n`gone.rs`\n"),
            [
                "ARCHITECTURE.md:3: sinew_math has no `sse.rs`",
                "ARCHITECTURE.md:1: the section of sinew_math does not name `lanes/`"
            ]
        );
    }
}
