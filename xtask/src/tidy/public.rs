//! Checks the public names at the roots of the libraries against a committed list, in which each type's name is unique.

use super::circles::{self, Import};
use super::lexer;
use super::{Finding, Repo};
use std::collections::{BTreeMap, BTreeSet};

/// File of the list: a crate and a name in each line, in order.
const LIST: &str = "xtask/public.txt";
/// Crates that are not used as libraries.
const BINARIES: &[&str] = &["sinew_cli", "sinew_scenes"];

/// Returns the number of names that a crate offers at its root.
pub fn offered(repo: &Repo, name: &str) -> usize {
    let of_crate = |line: &&str| line.split_once(' ').is_some_and(|(of, _)| of == name);
    repo.file(LIST).map_or(0, |list| list.text.lines().filter(of_crate).count())
}

/// Checks that the roots of the libraries offer the listed names, and each type's name is unique.
pub fn check(repo: &Repo) -> Vec<Finding> {
    let Some(list) = repo.file(LIST) else { return Vec::new() };
    let mut findings = Vec::new();
    let listed: BTreeSet<&str> = list.text.lines().filter(|line| !line.starts_with('#')).collect();
    let mut offered = BTreeSet::new();
    let mut types: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for file in repo.rust_files() {
        let name = file.crate_of_source().filter(|name| !BINARIES.contains(name));
        let Some(name) = name.filter(|_| file.path.ends_with("/src/lib.rs")) else { continue };
        let tokens = file.tokens_without_tests();
        for at in lexer::find(&tokens, "pub mod") {
            offered.insert(format!("{name} {}::", tokens[at + 2].text));
        }
        for Import { name: item, path, is_public } in circles::imports(file) {
            let is_own = path.first().is_none_or(|first| !first.starts_with("sinew_") && *first != "glam");
            if !is_public || !is_own {
                continue;
            }
            offered.insert(format!("{name} {item}"));
            let is_type = item.starts_with(char::is_uppercase) && item.contains(char::is_lowercase);
            if is_type {
                types.entry(item).or_default().insert(name);
            }
        }
    }
    let message = |what: &str, line: &str| {
        format!("`{line}` {what}: the list names everything at the roots of the libraries")
    };
    findings.extend(
        offered
            .iter()
            .filter(|line| !listed.contains(line.as_str()))
            .map(|line| Finding::new(LIST, 1, message("is missing", line))),
    );
    findings.extend(
        listed
            .iter()
            .filter(|line| !offered.contains(**line))
            .map(|line| Finding::new(LIST, 1, message("is not offered", line))),
    );
    findings.extend(types.iter().filter(|(_, crates)| crates.len() > 1).map(|(item, crates)| {
        let crates: Vec<&str> = crates.iter().copied().collect();
        Finding::new(LIST, 1, format!("`{item}` is a type of several crates: {}", crates.join(", ")))
    }));
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(list: &str, math: &str, geometry: &str) -> Vec<String> {
        let files = [
            (LIST, list),
            ("crates/sinew_math/src/lib.rs", math),
            ("crates/sinew_geometry/src/lib.rs", geometry),
        ];
        check(&Repo::planted(&files)).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn the_list_and_the_roots_agree() {
        let math = "pub mod trig; mod a; pub use a::{Sym3, min};";
        let list = "# Public\nsinew_math Sym3\nsinew_math min\nsinew_math trig::";
        assert!(found(list, math, "pub use sinew_math::Sym3;").is_empty());
        assert_eq!(found(list, math, "pub use b::Obb;").len(), 1);
        assert_eq!(found(list, "pub mod trig; pub use a::Sym3;", "").len(), 1);
    }

    #[test]
    fn a_type_of_two_crates_is_found() {
        let list = "sinew_geometry Sym3\nsinew_math Sym3";
        let shared = found(list, "pub use a::Sym3;", "pub use b::Sym3;");
        assert_eq!(
            shared,
            ["xtask/public.txt:1: `Sym3` is a type of several crates: sinew_geometry, sinew_math"]
        );
    }
}
