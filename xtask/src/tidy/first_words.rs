//! First lines of documentation stand alone in an editor's hover: they begin with a sentence or a noun, not with a fragment.

use super::{File, Finding, Repo};

/// Words that a first line cannot stand on: "Of the moving bodies, kg" says nothing where the name of the item is not seen.
const FRAGMENTS: &[&str] = &["What", "How", "Of", "Where", "Whether", "Which", "Likewise", "Those"];

/// How many such lines a crate still has, at most. May only be lowered; crates that are not listed have none.
const LIMITS: &[(&str, usize)] = &[
    ("sinew", 30),
    ("sinew_anim", 240),
    ("sinew_cli", 110),
    ("sinew_formats", 100),
    ("sinew_math", 50),
    ("sinew_physics", 610),
    ("sinew_picture", 50),
    ("sinew_ragdoll", 260),
    ("sinew_scenes", 240),
];

/// No crate has more first lines that are fragments than its limit.
pub fn check(repo: &Repo) -> Vec<Finding> {
    check_up_to(repo, LIMITS)
}

fn check_up_to(repo: &Repo, limits: &[(&str, usize)]) -> Vec<Finding> {
    let mut crates: Vec<&str> = repo.files.iter().filter_map(File::crate_of_source).collect();
    crates.sort_unstable();
    crates.dedup();
    let mut findings = Vec::new();
    for name in crates {
        let limit = limits.iter().find(|&&(of, _)| of == name).map_or(0, |&(_, limit)| limit);
        let files = repo.rust_files().filter(|file| file.crate_of_source() == Some(name));
        let found: Vec<Finding> = files.flat_map(fragments).collect();
        if found.len() <= limit {
            continue;
        }
        if limit > 0 {
            let message = format!("{} first lines of docs are fragments, at most {limit}", found.len());
            findings.push(Finding::new(&format!("crates/{name}/src/lib.rs"), 1, message));
        } else {
            findings.extend(found);
        }
    }
    findings
}

/// First lines of documentation that begin with such a word.
fn fragments(file: &File) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut is_first = true;
    for (index, line) in file.text.lines().enumerate() {
        let line = line.trim_start();
        let doc = line.strip_prefix("///").or_else(|| line.strip_prefix("//!"));
        if let Some(text) = doc.filter(|_| is_first) {
            let word = text.trim_start().split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
            if FRAGMENTS.contains(&word) {
                let message =
                    format!("a first line of docs does not begin with `{word}`: it stands alone in a hover");
                findings.push(Finding::new(&file.path, index + 1, message));
            }
        }
        is_first = doc.is_none();
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "crates/sinew_math/src/lib.rs";

    fn lines(text: &str, limits: &[(&str, usize)]) -> Vec<usize> {
        check_up_to(&Repo::planted(&[(FILE, text)]), limits).iter().map(|finding| finding.line).collect()
    }

    #[test]
    fn a_planted_fragment_is_found() {
        let text = "//! What is added.\n\n/// Total mass of the moving bodies, kg.\n/// Of all of them.\nfn f() {}\n\n    /// Of the moving bodies, kg.\n    /// More.\n";
        assert_eq!(lines(text, &[]), [1, 7]);
        assert!(
            lines("/// Offset.\n/// Offset of what is known.\n// What it is.\nlet a = 1;", &[]).is_empty()
        );
    }

    #[test]
    fn a_limit_excuses_as_many() {
        let text = "/// How.\nfn f() {}\n/// Which.\nfn g() {}";
        assert_eq!(lines(text, &[("sinew_math", 2)]), [0; 0]);
        assert_eq!(lines(text, &[("sinew_math", 1)]), [1]);
    }
}
