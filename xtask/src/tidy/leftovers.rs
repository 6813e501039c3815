//! Paths of one machine, and unfinished code.

use super::{Finding, Repo, lexer};

/// Home folders. Split in two, so that this file does not contain them.
const PATHS: &[(&str, &str)] = &[("/wo", "rk/"), ("/ro", "ot/"), ("/t", "mp/")];

const MACROS: &[&str] = &["dbg !", "todo !", "unimplemented !"];

/// Checks that no text has a path of one machine, and no code is unfinished.
pub fn check(repo: &Repo) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in &repo.files {
        for (start, end) in PATHS {
            let path = format!("{start}{end}");
            for (index, _) in file.text.lines().enumerate().filter(|(_, line)| line.contains(&path)) {
                findings.push(Finding::new(
                    &file.path,
                    index + 1,
                    format!("`{path}` exists on one machine only"),
                ));
            }
        }
    }
    for file in repo.rust_files() {
        let tokens = file.tokens();
        for pattern in MACROS {
            for at in lexer::find(&tokens, pattern) {
                findings.push(Finding::new(
                    &file.path,
                    tokens[at].line,
                    format!("`{pattern}`: unfinished code"),
                ));
            }
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::super::tests::check_lines;
    use super::*;

    #[test]
    fn planted_leftovers_are_found() {
        let (start, end) = PATHS[0];
        check_lines(check, "README.md", &format!("fine\nsee {start}{end}notes"), &[2]);
        check_lines(check, "crates/sinew/src/lib.rs", "fn f() { todo!() }\nfn g() { dbg!(1); }", &[2, 1]);
        check_lines(check, "crates/sinew/src/lib.rs", "// todo!\nlet todo = 1;", &[]);
    }
}
