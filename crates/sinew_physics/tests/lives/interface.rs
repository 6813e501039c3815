//! The calls of a world, as its sources have them: each needs a deed that makes it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Names of all public methods of `World`.
fn methods() -> BTreeSet<String> {
    let mut found = BTreeSet::from(["clone".to_owned()]);
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("src")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("the sources are there") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                of_file(&fs::read_to_string(&path).expect("a source"), &mut found);
            }
        }
    }
    found
}

/// Collects the public methods in a file's `impl World` blocks, each of which ends at a brace in the first column.
fn of_file(source: &str, found: &mut BTreeSet<String>) {
    let mut inside = false;
    for line in source.lines() {
        match line {
            "impl World {" => inside = true,
            "}" => inside = false,
            _ if inside => {
                let Some(rest) = line.strip_prefix("    pub fn ") else { continue };
                let end = rest.find(['(', '<']).expect("a method has arguments");
                found.insert(rest[..end].to_owned());
            }
            _ => {}
        }
    }
}

/// True if the lives call every method.
pub fn has_all(calls: &BTreeMap<&'static str, u64>) -> bool {
    methods().iter().all(|name| calls.contains_key(name.as_str()))
}

/// # Panics
/// If there is a method that no life calls, or the lives call one that is not there.
pub fn expect_all(calls: &BTreeMap<&'static str, u64>) {
    let there = methods();
    let missing: Vec<&String> = there.iter().filter(|name| !calls.contains_key(name.as_str())).collect();
    assert!(missing.is_empty(), "no deed calls {missing:?}: add one in tests/lives/deeds");
    let unknown: Vec<&&str> = calls.keys().filter(|name| !there.contains(**name)).collect();
    assert!(unknown.is_empty(), "lives count calls that there are not: {unknown:?}");
}

#[test]
fn methods_are_read_from_the_sources() {
    let found = methods();
    assert!(found.len() > 120, "{} methods", found.len());
    for name in ["add_body", "object_mut", "set_mover_walk", "save_shapes", "query", "hash"] {
        assert!(found.contains(name), "{name}");
    }
    assert!(!found.contains("expect_mut"), "what is private is no call");
}
