//! Collects the public methods from the crate's sources. Each needs a deed that calls it.

use crate::extension::CALLED;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Returns the names of all public methods of the types that lives call: `method` for methods of `World`, otherwise
/// `Type::method`.
pub fn methods() -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("src")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("the folder with the sources must be readable") {
            let path = entry.expect("the folder's entry must be readable").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                of_file(&fs::read_to_string(&path).expect("the source file must be readable"), &mut found);
            }
        }
    }
    for of in CALLED {
        found.insert(named(of, "clone"));
    }
    found
}

/// Returns the name under which lives count a call.
fn named(of: &str, method: &str) -> String {
    if of == "World" { method.to_owned() } else { format!("{of}::{method}") }
}

/// Collects the public methods in a file's `impl` blocks of these types; each block ends at a brace in the first
/// column.
fn of_file(source: &str, found: &mut BTreeSet<String>) {
    let mut inside = None;
    for line in source.lines() {
        if let Some(of) = line.strip_prefix("impl ").and_then(|line| line.strip_suffix(" {")) {
            inside = CALLED.iter().find(|&&called| called == of);
        } else if line == "}" {
            inside = None;
        } else if let (Some(of), Some(rest)) = (inside, line.strip_prefix("    pub fn ")) {
            let end = rest.find(['(', '<']).expect("a method's name ends at a bracket");
            found.insert(named(of, &rest[..end]));
        }
    }
}

/// Returns whether the lives call every method.
pub fn has_all(calls: &BTreeMap<&'static str, u64>) -> bool {
    methods().iter().all(|name| calls.contains_key(name.as_str()))
}

/// Checks that the lives call every method.
///
/// # Panics
/// If no life calls a method, or the lives call one that does not exist.
pub fn expect_all(calls: &BTreeMap<&'static str, u64>) {
    let there = methods();
    let missing: Vec<&String> = there.iter().filter(|name| !calls.contains_key(name.as_str())).collect();
    assert!(missing.is_empty(), "no deed calls {missing:?}: add one in tests/lives");
    let is_of_here = |name: &str| name.contains("::") || CALLED.contains(&"World");
    let unknown: Vec<&&str> =
        calls.keys().filter(|name| is_of_here(name) && !there.contains(**name)).collect();
    assert!(unknown.is_empty(), "the counts name calls that do not exist: {unknown:?}");
}
