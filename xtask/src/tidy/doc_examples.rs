//! Examples for users: each public module of characters and files has one, and programs are short.

use super::{File, Finding, Repo};

/// Crates of which every public module has an example in its documentation.
const CRATES: &[&str] = &["sinew_formats", "sinew_ragdoll"];

/// Folder of short programs.
const EXAMPLES: &str = "crates/sinew/examples/";

/// Limit on the lines of a program.
const MOST_LINES: usize = 60;

/// Longer examples, each a whole part of a game: custom kinds of bodies with their state, all queries of a world, a
/// fight over a network, a character with all its accessories.
const LONGER: &[&str] = &["door_and_cape", "flock", "pendulum_clock", "probes", "rollback_fight"];

/// Finds public modules of those crates without an example that is compiled and run, and examples that are too long or
/// use names outside the prelude.
pub fn check(repo: &Repo) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in repo.rust_files() {
        if file.crate_of_source().is_some_and(|name| CRATES.contains(&name)) {
            findings.extend(modules(repo, file));
        }
        if let Some(name) = file.path.strip_prefix(EXAMPLES) {
            findings.extend(example(file, name.trim_end_matches(".rs")));
        }
    }
    findings
}

fn example(file: &File, name: &str) -> Vec<Finding> {
    let mut findings = Vec::new();
    let lines = file.text.lines().count();
    if lines > MOST_LINES && !LONGER.contains(&name) {
        findings.push(Finding::new(&file.path, lines, format!("an example has at most {MOST_LINES} lines")));
    }
    for (index, line) in file.text.lines().enumerate() {
        if line.starts_with("use sinew::") && line != "use sinew::prelude::*;" {
            findings.push(Finding::new(&file.path, index + 1, "an example uses only names of the prelude"));
        }
    }
    findings
}

/// Returns findings for the public modules of a file.
fn modules(repo: &Repo, file: &File) -> Vec<Finding> {
    let folder = match file.path.rsplit_once('/') {
        Some((folder, "lib.rs" | "mod.rs")) => folder,
        _ => file.path.trim_end_matches(".rs"),
    };
    let mut findings = Vec::new();
    for (index, line) in file.text.lines().enumerate() {
        let Some(name) = line.strip_prefix("pub mod ").and_then(|rest| rest.strip_suffix(';')) else {
            continue;
        };
        let paths = [format!("{folder}/{name}.rs"), format!("{folder}/{name}/mod.rs")];
        let module = paths.iter().find_map(|path| repo.file(path));
        if !module.is_some_and(|module| has_example(&module.text)) {
            let message = format!("`{name}` is public, and its documentation has no example that is run");
            findings.push(Finding::new(&file.path, index + 1, message));
        }
    }
    findings
}

/// Returns true if the documentation at the head of a module has a Rust block that runs.
fn has_example(text: &str) -> bool {
    let mut is_open = false;
    text.lines().filter_map(|line| line.strip_prefix("//! ```")).any(|info| {
        is_open = !is_open;
        is_open && matches!(info, "" | "rust")
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::check_lines;
    use super::*;

    #[test]
    fn a_planted_module_without_an_example_is_found() {
        let lib = ("crates/sinew_ragdoll/src/lib.rs", "mod a;\npub mod b;\npub mod c;\n");
        let b =
            ("crates/sinew_ragdoll/src/b/mod.rs", "//! B.\n//!\n//! ```\n//! b();\n//! ```\npub mod d;\n");
        let c = ("crates/sinew_ragdoll/src/c.rs", "//! C.\n//!\n//! ```json\n//! {}\n//! ```\n");
        let d = ("crates/sinew_ragdoll/src/b/d.rs", "//! D.\n");
        let found = check(&Repo::planted(&[lib, b, c, d]));
        let found: Vec<_> = found.iter().map(|finding| (finding.file.as_str(), finding.line)).collect();
        assert_eq!(found, [(lib.0, 3), (b.0, 6)]);
    }

    #[test]
    fn a_planted_long_example_is_found() {
        let long = "use sinew::prelude::*;\n".to_owned() + &"// .\n".repeat(60);
        check_lines(check, "crates/sinew/examples/a.rs", &long, &[61]);
        check_lines(check, "crates/sinew/examples/flock.rs", &long, &[]);
        check_lines(
            check,
            "crates/sinew/examples/a.rs",
            "use sinew::prelude::*;\nuse sinew::math::trig;\n",
            &[2],
        );
    }

    #[test]
    fn other_crates_need_no_examples() {
        check_lines(check, "crates/sinew_physics/src/lib.rs", "pub mod b;\n", &[]);
        check_lines(check, "crates/sinew_formats/src/lib.rs", "pub mod b;\n", &[1]);
    }
}
