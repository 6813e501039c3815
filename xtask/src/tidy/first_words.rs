//! First lines of documentation stand alone in an editor's hover: they begin with a sentence or a noun, not with a
//! fragment.

use super::{File, Finding, Repo};

/// Words that cannot start a first line: "Of the moving bodies, kg" has no meaning without the name of the item.
const FRAGMENTS: &[&str] = &["What", "How", "Of", "Where", "Whether", "Which", "Likewise", "Those"];

/// Finds each first line in a crate that is a fragment.
pub fn check(repo: &Repo) -> Vec<Finding> {
    repo.rust_files().filter(|file| file.crate_of_source().is_some()).flat_map(fragments).collect()
}

/// Returns findings for first lines of documentation that begin with a word of [`FRAGMENTS`].
fn fragments(file: &File) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut is_first = true;
    for (index, line) in file.text.lines().enumerate() {
        let line = line.trim_start();
        let doc = line.strip_prefix("///").or_else(|| line.strip_prefix("//!"));
        if let Some(text) = doc.filter(|_| is_first) {
            let word = text.trim_start().split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
            if FRAGMENTS.contains(&word) {
                let message = format!(
                    "the first line of a doc comment must not begin with `{word}`: shown alone in a hover, it must name the item"
                );
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

    fn lines(text: &str) -> Vec<usize> {
        check(&Repo::planted(&[(FILE, text)])).iter().map(|finding| finding.line).collect()
    }

    #[test]
    fn a_planted_fragment_is_found() {
        let text = "//! What is added.\n\n/// Total mass of the moving bodies, kg.\n/// Of all of them.\nfn f() {}\n\n    /// Of the moving bodies, kg.\n    /// More.\n";
        assert_eq!(lines(text), [1, 7]);
        assert!(lines("/// Offset.\n/// Offset of what is known.\n// What it is.\nlet a = 1;").is_empty());
    }
}
