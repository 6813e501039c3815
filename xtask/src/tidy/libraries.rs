//! Finds what libraries must not use: files, clocks, logs, globals, the process and its environment.

use super::lexer::{self, Kind, Token};
use super::{File, Finding, Repo};

/// Crates that a user links. Their tests may use anything.
const LIBRARIES: &[&str] = &[
    "sinew_math",
    "sinew_geometry",
    "sinew_physics",
    "sinew_anim",
    "sinew_ragdoll",
    "sinew_formats",
    "sinew",
    "sinew_scenes",
    "sinew_picture",
];

/// The only file that reads and writes files.
const FILE_ACCESS: &str = "crates/sinew_formats/src/fs.rs";

/// Forbidden patterns of tokens, and advice.
const FORBIDDEN: &[(&str, &str)] = &[
    ("Instant", "libraries read no clock; stage times come from a Profiler"),
    ("SystemTime", "libraries read no clock"),
    ("print !", "libraries log nothing"),
    ("println !", "libraries log nothing"),
    ("eprint !", "libraries log nothing"),
    ("eprintln !", "libraries log nothing"),
    ("log ::", "libraries log nothing"),
    ("tracing ::", "libraries log nothing"),
    ("static mut", "libraries hold no globals"),
    ("thread_local !", "libraries hold no globals"),
    ("lazy_static !", "libraries hold no globals"),
    ("OnceLock", "libraries hold no globals"),
    ("LazyLock", "libraries hold no globals"),
];

/// Modules of std that reach outside the process or into its surroundings.
const FORBIDDEN_IN_STD: &[(&str, &str)] = &[
    ("fs", "the only file IO is sinew_formats/src/fs.rs"),
    ("net", "libraries do no network IO"),
    ("env", "libraries read no environment"),
    ("process", "libraries neither end nor start a process"),
];

/// Types whose statics can change.
const CELLS: &[&str] = &["Mutex", "RwLock", "Cell", "RefCell", "OnceCell", "UnsafeCell"];

/// Checks that no library uses the patterns in the tables above.
pub fn check(repo: &Repo) -> Vec<Finding> {
    let is_library = |file: &&File| file.crate_of_source().is_some_and(|name| LIBRARIES.contains(&name));
    repo.rust_files().filter(is_library).flat_map(check_file).collect()
}

fn check_file(file: &File) -> Vec<Finding> {
    let tokens = file.tokens_without_tests();
    let mut findings = Vec::new();
    for &(pattern, why) in FORBIDDEN {
        for at in lexer::find(&tokens, pattern) {
            findings.push(Finding::new(&file.path, tokens[at].line, format!("`{pattern}`: {why}")));
        }
    }
    for module in modules_of_std(&tokens) {
        let forbidden = FORBIDDEN_IN_STD.iter().find(|(name, _)| *name == module.text);
        if let Some((name, why)) = forbidden
            && file.path != FILE_ACCESS
        {
            findings.push(Finding::new(&file.path, module.line, format!("`std::{name}`: {why}")));
        }
    }
    for at in lexer::find(&tokens, "static") {
        let type_and_value = &tokens[at..lexer::end_of_item(&tokens, at)];
        if type_and_value.iter().any(|token| CELLS.contains(&token.text) || token.text.starts_with("Atomic"))
        {
            findings.push(Finding::new(&file.path, tokens[at].line, "`static`: libraries hold no globals"));
        }
    }
    findings
}

/// Returns the modules named in `std::module` and in `std::{module, module::item}`.
fn modules_of_std<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    let mut modules = Vec::new();
    for at in lexer::find(tokens, "std ::") {
        let next = at + 2;
        if tokens.get(next).is_some_and(|token| token.text == "{") {
            let group = &tokens[next..lexer::closing(tokens, next)];
            let heads = group.windows(2).filter(|pair| matches!(pair[0].text, "{" | ","));
            modules.extend(heads.map(|pair| pair[1]));
        } else {
            modules.extend(tokens.get(next));
        }
    }
    modules.retain(|token| token.kind == Kind::Word);
    modules
}

#[cfg(test)]
mod tests {
    use super::super::tests::check_lines;
    use super::*;

    const FILE: &str = "crates/sinew_physics/src/world.rs";

    #[test]
    fn planted_violations_are_found() {
        check_lines(check, FILE, "use std::fs;", &[1]);
        check_lines(check, FILE, "use std::{io,\n fs::File};", &[2]);
        check_lines(check, FILE, "let t = Instant::now();", &[1]);
        check_lines(check, FILE, "fn f() {\n println!(\"x\");\n}", &[2]);
        check_lines(check, FILE, "static COUNT: AtomicU32 = AtomicU32::new(0);", &[1]);
        check_lines(check, FILE, "static X: OnceLock<u8> = OnceLock::new();", &[1, 1]);
    }

    #[test]
    fn allowed_code_is_not_found() {
        check_lines(
            check,
            FILE,
            "// println!\nstatic TABLE: [u8; 2] = [1, 2]; fn f(x: &'static str) {}",
            &[],
        );
        check_lines(check, FILE, "#[cfg(test)] mod tests { use std::fs; }", &[]);
        check_lines(check, FILE_ACCESS, "use std::fs;", &[]);
        check_lines(check, "crates/sinew_cli/src/main.rs", "fn main() { println!(); }", &[]);
        check_lines(check, "crates/sinew_formats/tests/it/main.rs", "use std::fs;", &[]);
    }
}
