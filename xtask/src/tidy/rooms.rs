//! Allowed dependencies between the modules of a crate ("rooms"), which are the folders and files directly in its
//! `src/`.

use super::lexer::{self, Kind, Token};
use super::{File, Finding, Repo};

/// Crates with layered modules. The modules of each crate are listed from the lowest layer up: a module may depend only
/// on those before it.
const ROOMS: &[(&str, &[&str])] = &[(
    "sinew_physics",
    &[
        "id",
        "arena",
        "spatial",
        "registered",
        "pool",
        "runner",
        "slices",
        "stage",
        "context",
        "draw",
        "island",
        "body",
        "joint",
        "contact",
        "particles",
        "activity",
        "field",
        "solver",
        "step",
        "user_object",
        "world",
        "mover",
        "query",
    ],
)];

/// Existing upward dependencies, by file and module. Entries may be removed but not added.
const EXCEPTIONS: &[(&str, &str)] = &[
    // A step accesses the whole world, because the user's objects and the movers act on it within the step.
    ("crates/sinew_physics/src/step/mod.rs", "world"),
    ("crates/sinew_physics/src/step/mod.rs", "user_object"),
    ("crates/sinew_physics/src/step/mod.rs", "mover"),
    // The interface for users takes the world as an argument.
    ("crates/sinew_physics/src/user_object/mod.rs", "world"),
    // The world owns its movers, which act on a world.
    ("crates/sinew_physics/src/world/mod.rs", "mover"),
    ("crates/sinew_physics/src/world/snapshot.rs", "mover"),
    // A ray tests which bodies shelter others from a blast.
    ("crates/sinew_physics/src/world/explosions.rs", "query"),
];

/// Largest number of upward dependencies.
const EXCEPTIONS_MAX: usize = 10;
const _: () = assert!(EXCEPTIONS.len() <= EXCEPTIONS_MAX, "there are too many upward dependencies");

/// Returns the number of upward dependencies in a crate; `None` if its modules are not layered.
pub fn arrows_back_up(name: &str) -> Option<usize> {
    let source = format!("crates/{name}/");
    let has_rooms = ROOMS.iter().any(|&(with_rooms, _)| with_rooms == name);
    has_rooms.then(|| EXCEPTIONS.iter().filter(|(file, _)| file.starts_with(&source)).count())
}

/// Checks that modules depend only on lower ones, except for the listed exceptions, each of which must be needed.
pub fn check(repo: &Repo) -> Vec<Finding> {
    check_rooms(repo, ROOMS, EXCEPTIONS)
}

fn check_rooms(repo: &Repo, crates: &[(&str, &[&str])], exceptions: &[(&str, &str)]) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut needed = vec![false; exceptions.len()];
    for &(name, rooms) in crates {
        let root = format!("crates/{name}/src/lib.rs");
        let Some(lib) = repo.file(&root) else { continue };
        let exported = exports(lib);
        let files = || repo.rust_files().filter(|file| file.crate_of_source() == Some(name));
        for file in files().filter(|file| file.path != root && !is_test(file, repo)) {
            let Some(own) = rooms.iter().position(|&room| room == room_of(file)) else {
                let message = format!("this module of {name} is not listed in xtask/src/tidy/rooms.rs");
                findings.push(Finding::new(&file.path, 1, message));
                continue;
            };
            for (word, line) in named(file) {
                let room = exported.iter().find(|(name, _)| *name == word).map_or(word, |&(_, room)| room);
                let Some(to) = rooms.iter().position(|&name| name == room).filter(|&to| to > own) else {
                    continue;
                };
                match exceptions.iter().position(|&exception| exception == (file.path.as_str(), rooms[to])) {
                    Some(exception) => needed[exception] = true,
                    None => {
                        let message =
                            format!("`{}` must not name `{}`, which stands above it", rooms[own], rooms[to]);
                        findings.push(Finding::new(&file.path, line, message));
                    }
                }
            }
        }
    }
    let unneeded = exceptions.iter().zip(needed).filter(|(_, needed)| !needed);
    findings.extend(unneeded.map(|((file, room), _)| {
        Finding::new(
            file,
            1,
            format!("no longer depends on `{room}`: remove it from the exceptions of rooms.rs"),
        )
    }));
    findings
}

/// Returns the layered module of a file: its top folder in `src/`, or the file itself.
fn room_of(file: &File) -> &str {
    let inside = file.path.splitn(4, '/').nth(3).unwrap_or_default();
    inside.split('/').next().unwrap_or_default().trim_end_matches(".rs")
}

/// Returns true if a file is compiled for tests alone: its module is declared under `#[cfg(test)]`.
pub fn is_test(file: &File, repo: &Repo) -> bool {
    let Some((folder, name)) = file.path.trim_end_matches(".rs").rsplit_once('/') else { return false };
    let parent = repo.file(&format!("{folder}/mod.rs"));
    name == "tests"
        || parent.is_some_and(|parent| {
            lexer::find(&parent.tokens(), &format!("# [ cfg ( test ) ] mod {name} ;")).next().is_some()
        })
}

/// Returns the names that `lib.rs` re-exports, each with its layered module.
fn exports(lib: &File) -> Vec<(&str, &str)> {
    let tokens = lib.tokens();
    let mut exports = Vec::new();
    for start in lexer::find(&tokens, "pub use") {
        let end = lexer::end_of_item(&tokens, start);
        let words = tokens[start + 2..end].iter().filter(|token| token.kind == Kind::Word);
        let mut words = words.map(|token| token.text);
        if let Some(room) = words.next() {
            exports.extend(words.map(|word| (word, room)));
        }
    }
    exports
}

/// Returns the names directly below `crate` that a file uses, with their lines.
fn named(file: &File) -> Vec<(&str, usize)> {
    // Removes the `super` words that lead to the root of the crate.
    let inside = file.path.splitn(4, '/').nth(3).unwrap_or_default();
    let depth = inside.trim_end_matches("/mod.rs").matches('/').count() + 1;
    let tokens = file.tokens_without_tests();
    let tops = ["crate".to_owned(), vec!["super"; depth].join(" :: ")];
    let below = |top: &String| {
        let pattern = format!("{top} ::");
        let length = pattern.split(' ').count();
        lexer::find(&tokens, &pattern).map(move |at| at + length).collect::<Vec<_>>()
    };
    tops.iter().flat_map(below).flat_map(|at| firsts(&tokens, at)).collect()
}

/// Returns the word at `at`, or the first words of the parts of the group there.
fn firsts<'a>(tokens: &[Token<'a>], at: usize) -> Vec<(&'a str, usize)> {
    let Some(first) = tokens.get(at) else { return Vec::new() };
    if first.text != "{" {
        return vec![(first.text, first.line)];
    }
    let mut depth = 0;
    let mut found = Vec::new();
    let group = &tokens[at..=lexer::closing(tokens, at)];
    for pair in group.windows(2) {
        match pair[0].text {
            "{" => depth += 1,
            "}" => depth -= 1,
            _ => {}
        }
        let begins = depth == 1 && matches!(pair[0].text, "{" | ",");
        if begins && pair[1].kind == Kind::Word {
            found.push((pair[1].text, pair[1].line));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOUSE: &[(&str, &[&str])] = &[("sinew_math", &["cellar", "hall", "attic"])];

    fn check_files(files: &[(&str, &str)], exceptions: &[(&str, &str)]) -> Vec<String> {
        let mut planted =
            vec![("crates/sinew_math/src/lib.rs", "pub use attic::Roof;\npub use hall::{Door, self};")];
        planted.extend(files);
        let found = check_rooms(&Repo::planted(&planted), HOUSE, exceptions);
        found.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn planted_upward_dependency_is_found() {
        let up = "crates/sinew_math/src/hall/door.rs:1: `hall` must not name `attic`, which stands above it";
        for code in [
            "use crate::attic::Beam;",
            "use crate::{cellar, attic::Beam};",
            "use crate::Roof;",
            "fn f() { crate::attic::f() }",
            "use super::super::attic;",
        ] {
            assert_eq!(check_files(&[("crates/sinew_math/src/hall/door.rs", code)], &[]), [up], "{code}");
        }
        let of_mod = check_files(&[("crates/sinew_math/src/hall/mod.rs", "use super::attic;")], &[]);
        assert_eq!(of_mod.len(), 1);
        let of_flat =
            check_files(&[("crates/sinew_math/src/cellar.rs", "use super::{hall, attic::X};")], &[]);
        assert_eq!(of_flat.len(), 2);
    }

    #[test]
    fn downward_and_test_dependencies_are_allowed() {
        for code in [
            "use crate::cellar::{Wine, attic};\nuse super::attic;",
            "#[cfg(test)]\nmod tests { use crate::attic; }",
            "use crate::Door;",
            "// crate::attic",
        ] {
            assert_eq!(check_files(&[("crates/sinew_math/src/hall/door.rs", code)], &[]), [""; 0], "{code}");
        }
        let files = [
            ("crates/sinew_math/src/hall/mod.rs", "#[cfg(test)]\nmod check;"),
            ("crates/sinew_math/src/hall/check.rs", "use crate::attic;"),
        ];
        assert_eq!(check_files(&files, &[]), [""; 0]);
    }

    #[test]
    fn exception_is_accepted_only_while_needed() {
        let path = "crates/sinew_math/src/hall/door.rs";
        assert_eq!(check_files(&[(path, "use crate::attic;")], &[(path, "attic")]), [""; 0]);
        assert_eq!(check_files(&[(path, "")], &[(path, "attic")]).len(), 1);
    }

    #[test]
    fn unlisted_module_is_found() {
        assert_eq!(check_files(&[("crates/sinew_math/src/shed.rs", "")], &[]).len(), 1);
    }
}
