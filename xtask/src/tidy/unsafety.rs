//! Checks that `unsafe` is only in the modules that may contain it (design §5).

use super::lexer;
use super::{Finding, Repo};

/// Modules that may hold `unsafe`: `MODULE.rs` or the files in `MODULE/`.
const ALLOWED: &[&str] = &[
    "crates/sinew_math/src/lanes",
    "crates/sinew_math/src/dispatch",
    "crates/sinew_physics/src/slices",
    "crates/sinew_physics/src/pool",
    "crates/sinew_physics/src/solver/contacts/chunks",
    "bench/peers/src/ffi",
    "bindings/c/src",
    "bindings/c/tests",
    "bindings/python/src",
    "bindings/web/src",
];

/// Checks that `unsafe` is only in the modules above. Every crate root forbids it, or, where the crate has one of those
/// modules (`forbid` cannot be lifted), denies it.
pub fn check(repo: &Repo) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in repo.rust_files() {
        let tokens = file.tokens();
        if !is_allowed(&file.path) {
            let places = lexer::find(&tokens, "unsafe").map(|at| tokens[at].line);
            findings
                .extend(places.map(|line| Finding::new(&file.path, line, "`unsafe` is not allowed here")));
        }
        let Some(source) = source_of_root(&file.path) else { continue };
        let needs_it =
            repo.rust_files().any(|other| other.path.starts_with(source) && is_allowed(&other.path));
        let level = if needs_it { "deny" } else { "forbid" };
        if lexer::find(&tokens, &format!("# ! [ {level} ( unsafe_code ) ]")).next().is_none() {
            findings.push(Finding::new(
                &file.path,
                1,
                format!("crate root without `#![{level}(unsafe_code)]`"),
            ));
        }
    }
    findings
}

fn is_allowed(path: &str) -> bool {
    let after = ALLOWED.iter().filter_map(|module| path.strip_prefix(module));
    after.into_iter().any(|after| after == ".rs" || after.starts_with('/'))
}

/// Returns the source folder whose crate root is `path`.
fn source_of_root(path: &str) -> Option<&str> {
    let source = path.strip_suffix("lib.rs").or_else(|| path.strip_suffix("main.rs"))?;
    source.ends_with("/src/").then_some(source)
}

#[cfg(test)]
mod tests {
    use super::super::tests::check_lines;
    use super::*;

    #[test]
    fn planted_unsafe_is_found() {
        check_lines(check, "crates/sinew_anim/src/pose.rs", "fn f() {\n unsafe { g() }\n}", &[2]);
        check_lines(check, "crates/sinew_anim/tests/it/main.rs", "unsafe fn f() {}", &[1]);
        check_lines(check, "crates/sinew_physics/src/pool.rs", "unsafe fn f() {}", &[]);
        check_lines(check, "crates/sinew_physics/src/pool_two.rs", "unsafe fn f() {}", &[1]);
        check_lines(check, "crates/sinew_anim/src/pose.rs", "// unsafe", &[]);
    }

    #[test]
    fn crate_root_that_does_not_forbid_unsafe_is_found() {
        check_lines(check, "crates/sinew_anim/src/lib.rs", "pub mod pose;", &[1]);
        check_lines(check, "crates/sinew_anim/src/lib.rs", "#![forbid(unsafe_code)]\npub mod pose;", &[]);
        let root = ("crates/sinew_math/src/lib.rs", "#![deny(unsafe_code)]");
        let lanes = ("crates/sinew_math/src/lanes/sse.rs", "unsafe fn f() {}");
        assert_eq!(check(&Repo::planted(&[root])).len(), 1, "a crate without `unsafe` must forbid it");
        assert!(
            check(&Repo::planted(&[root, lanes])).is_empty(),
            "a crate with allowed `unsafe` must only deny it"
        );
        assert_eq!(check(&Repo::planted(&[("crates/sinew_math/src/lib.rs", ""), lanes])).len(), 1);
    }
}
