//! Finds paths of one machine, unfinished code, and markers of merge conflicts.

use super::{Finding, Repo, lexer};

/// Home folders, each split in two, so that this file does not contain them.
const PATHS: &[(&str, &str)] = &[("/wo", "rk/"), ("/ro", "ot/"), ("/t", "mp/")];

const MACROS: &[&str] = &["dbg !", "todo !", "unimplemented !"];

/// Starts of lines that a merge leaves behind, each a character and its count.
const CONFLICTS: &[(char, usize)] = &[('<', 7), ('>', 7)];

/// Checks that no text has a path of one machine or a merge conflict, and no code is unfinished.
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
    for file in &repo.files {
        for mark in CONFLICTS.iter().map(|&(mark, count)| String::from(mark).repeat(count) + " ") {
            for (index, _) in file.text.lines().enumerate().filter(|(_, line)| line.starts_with(&mark)) {
                findings.push(Finding::new(&file.path, index + 1, "an unresolved merge conflict"));
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
        let conflict = format!("fine\n{} HEAD\na\n=======\nb\n{} w1\n", "<".repeat(7), ">".repeat(7));
        check_lines(check, "docs/python.md", &conflict, &[2, 6]);
        check_lines(check, "crates/sinew/src/lib.rs", "fn f() { todo!() }\nfn g() { dbg!(1); }", &[2, 1]);
        check_lines(check, "crates/sinew/src/lib.rs", "// todo!\nlet todo = 1;", &[]);
    }
}
