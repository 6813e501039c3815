//! Checks that every external crate has a row in ADR 0007 and is declared in the root manifest.

use super::{Finding, Repo};

const MANIFEST: &str = "Cargo.toml";
const RECORD: &str = "docs/adr/0007-dependencies.md";

/// Checks that the root manifest's dependencies and the record's rows ("| `name`
/// …") agree, that every dependency is used, and that no crate declares its own.
pub fn check(repo: &Repo) -> Vec<Finding> {
    let mut findings = Vec::new();
    let Some(manifest) = repo.file(MANIFEST) else { return findings };
    let declared = declared(&manifest.text);
    let recorded = recorded(repo.file(RECORD).map_or("", |file| &file.text));
    let used = used(repo);
    let names = |list: &[(&str, usize)], name: &str| list.iter().any(|&(other, _)| other == name);
    for &(name, line) in &declared {
        if !names(&recorded, name) {
            findings.push(Finding::new(MANIFEST, line, format!("`{name}` has no row in {RECORD}")));
        }
        if !used.iter().any(|&(_, other)| other == name) {
            findings.push(Finding::new(MANIFEST, line, format!("no crate uses `{name}`")));
        }
    }
    for &(name, line) in &recorded {
        if !names(&declared, name) {
            findings.push(Finding::new(RECORD, line, format!("`{name}` is not in [workspace.dependencies]")));
        }
    }
    for (user, name) in used {
        if !names(&declared, name) {
            let message = format!("{user} takes `{name}` from outside [workspace.dependencies]");
            findings.push(Finding::new(MANIFEST, 1, message));
        }
    }
    findings
}

/// Returns pairs of a crate of the workspace and an external crate that it uses, for any purpose.
fn used(repo: &Repo) -> Vec<(&str, &str)> {
    let mut used = Vec::new();
    for package in repo.packages() {
        let user = package["name"].as_str().unwrap_or_default();
        let dependencies = package["dependencies"].as_array().into_iter().flatten();
        let foreign = dependencies.filter(|dependency| !dependency["path"].is_string());
        used.extend(foreign.map(|dependency| (user, dependency["name"].as_str().unwrap_or_default())));
    }
    used
}

/// Returns names in `[workspace.dependencies]` that are not folders of this repository, with their lines.
fn declared(manifest: &str) -> Vec<(&str, usize)> {
    let numbered = manifest.lines().enumerate();
    let section = numbered.skip_while(|(_, line)| *line != "[workspace.dependencies]").skip(1);
    let section = section.take_while(|(_, line)| !line.starts_with('['));
    let entries = section.filter_map(|(index, line)| Some((line.split_once('=')?, index + 1)));
    let foreign = entries.filter(|((name, value), _)| !name.starts_with('#') && !value.contains("path ="));
    foreign.map(|((name, _), line)| (name.trim(), line)).collect()
}

/// Returns names in the first column of the record's table, with their lines.
fn recorded(record: &str) -> Vec<(&str, usize)> {
    let rows = record.lines().enumerate();
    let names =
        rows.filter_map(|(index, line)| Some((line.strip_prefix("| `")?.split_once('`')?, index + 1)));
    names.map(|((name, _), line)| (name, line)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    const TOML: &str = "[workspace.dependencies]\nsinew = { path = \"x\" }\n# note = 1\nglam = \"0.32\"\n[profile.dev]\na = 1\n";

    /// Checks a record with a crate `sinew` that uses `dependencies`.
    fn check_record(record: &str, dependencies: &[&str]) -> Vec<String> {
        let mut dependencies: Vec<_> = dependencies.iter().map(|name| json!({ "name": name })).collect();
        dependencies.push(json!({ "name": "sinew_math", "path": "crates/sinew_math" }));
        let mut repo = Repo::planted(&[(MANIFEST, TOML), (RECORD, record)]);
        repo.metadata = json!({ "packages": [{ "name": "sinew", "dependencies": dependencies }] });
        check(&repo).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn manifest_and_record_agree() {
        assert!(check_record("| crate |\n| `glam` | vectors |", &["glam"]).is_empty());
        assert_eq!(
            check_record("", &["glam"]),
            ["Cargo.toml:4: `glam` has no row in docs/adr/0007-dependencies.md"]
        );
        assert_eq!(
            check_record("| `glam` | a |\n| `rand` | b |", &["glam"]),
            ["docs/adr/0007-dependencies.md:2: `rand` is not in [workspace.dependencies]"]
        );
    }

    #[test]
    fn unused_dependency_and_one_outside_the_root_manifest_are_found() {
        assert_eq!(check_record("| `glam` | a |", &[]), ["Cargo.toml:4: no crate uses `glam`"]);
        assert_eq!(
            check_record("| `glam` | a |", &["glam", "rand"]),
            ["Cargo.toml:1: sinew takes `rand` from outside [workspace.dependencies]"]
        );
    }
}
