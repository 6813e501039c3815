//! Checks `docs/guide`: its pages are in its contents and among the tests, its links work, and the names in tables of
//! other engines exist in the code.

use super::lexer::{self, Kind};
use super::{Finding, Repo};
use std::collections::BTreeSet;

const PAGES: &str = "docs/guide/src/";
const CONTENTS: &str = "docs/guide/src/SUMMARY.md";
/// Doc tests of pages about the library.
const TESTED: &str = "crates/sinew/src/lib.rs";
/// Doc tests of pages about the plugin.
const TESTED_IN_BEVY: &str = "integrations/bevy_sinew/src/lib.rs";

/// Checks that pages are listed, those with code are tested, links lead to files, and names in tables exist.
pub fn check(repo: &Repo) -> Vec<Finding> {
    let text = |path| repo.file(path).map_or("", |file| file.text.as_str());
    let (contents, tests) = (text(CONTENTS), [text(TESTED), text(TESTED_IN_BEVY)].concat());
    let pages = repo.files.iter().filter(|file| file.path.starts_with(PAGES) && file.path.ends_with(".md"));
    let mut findings = Vec::new();
    let mut known = None;
    for page in pages {
        let name = &page.path[PAGES.len()..];
        if page.path != CONTENTS && !contents.contains(&format!("]({name})")) {
            findings.push(Finding::new(&page.path, 1, format!("not in {CONTENTS}")));
        }
        if page.text.contains("```rust") && !tests.contains(&format!("/{}\"", page.path)) {
            let message = format!("the page's code is tested neither in {TESTED} nor in {TESTED_IN_BEVY}");
            findings.push(Finding::new(&page.path, 1, message));
        }
        for (index, line) in page.text.lines().enumerate() {
            for link in links(line).filter(|link| !has_target(repo, link)) {
                findings.push(Finding::new(&page.path, index + 1, format!("`{link}` is not there")));
            }
            if name.starts_with("from_") && line.starts_with('|') {
                let known = known.get_or_insert_with(|| names(repo));
                for word in words(ours(line)).filter(|word| !known.contains(word)) {
                    let message = format!("`{word}` is not a name in Sinew");
                    findings.push(Finding::new(&page.path, index + 1, message));
                }
            }
        }
    }
    findings
}

/// Returns the targets of a line's links, without anchors and other sites.
fn links(line: &str) -> impl Iterator<Item = &str> {
    let targets = line.split("](").skip(1).filter_map(|rest| rest.split([')', ' ', '#']).next());
    targets.filter(|target| !target.is_empty() && !target.contains("://"))
}

/// Returns true if a link from a page of the guide has a file as its target.
fn has_target(repo: &Repo, link: &str) -> bool {
    let mut path: Vec<&str> = PAGES.trim_end_matches('/').split('/').collect();
    for part in link.split('/') {
        match part {
            ".." => _ = path.pop(),
            part => path.push(part),
        }
    }
    // Pictures are not among the files of [`Repo`].
    link.ends_with(".png") || repo.file(&path.join("/")).is_some()
}

/// Returns the last column of a table's row.
fn ours(line: &str) -> &str {
    line.trim_end().trim_end_matches('|').rsplit(" | ").next().unwrap_or_default()
}

/// Returns the names in the code of a text, without placeholders of one letter and ellipses.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let code = text.split('`').skip(1).step_by(2).filter(|code| !code.starts_with("sinew "));
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let words = code.flat_map(move |code| code.split(move |c| !is_name(c)));
    words.filter(|word| word.len() > 1 && !word.starts_with(|c: char| c.is_ascii_digit()))
}

/// Returns every word of the libraries' and the plugin's code.
fn names(repo: &Repo) -> BTreeSet<&str> {
    let sources = repo.rust_files().filter(|file| {
        file.crate_of_source().is_some() || file.path.starts_with("integrations/bevy_sinew/src/")
    });
    let mut names = BTreeSet::new();
    for file in sources {
        names.extend(
            lexer::tokens(&file.text).iter().filter(|token| token.kind == Kind::Word).map(|t| t.text),
        );
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEST: &str = "pages! { A: \"../../../docs/guide/src/a.md\" }";

    fn found(files: &[(&str, &str)]) -> Vec<String> {
        check(&Repo::planted(files)).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn an_unlisted_or_untested_page_is_found() {
        let page = ("docs/guide/src/a.md", "```rust\nlet x = 1;\n```\n");
        let contents = (CONTENTS, "- [A](a.md)\n");
        assert!(found(&[page, contents, (TESTED, TEST)]).is_empty());
        assert!(found(&[page, contents, (TESTED_IN_BEVY, TEST)]).is_empty());
        assert_eq!(found(&[page, (TESTED, TEST)]).len(), 1);
        assert_eq!(found(&[page, contents]).len(), 1);
    }

    #[test]
    fn a_broken_link_is_found() {
        let contents = (CONTENTS, "- [A](a.md)\n");
        let links =
            "[b](../../b.md#there), [web](https://bevy.org), [here](#here)\n\n[c](c.md) ![p](p.png)\n";
        let found = found(&[("docs/guide/src/a.md", links), contents, ("docs/b.md", "")]);
        assert_eq!(found, ["docs/guide/src/a.md:3: `c.md` is not there"]);
    }

    #[test]
    fn a_name_that_the_code_does_not_have_is_found() {
        let contents = (CONTENTS, "- [A](from_a.md)\n");
        let code = ("crates/sinew/src/world.rs", "/// `invented`\npub fn add_body(def: &Def) {}");
        let table = "| A | Sinew |\n|---|---|\n| `any` | `add_body(&def)`; `x` |\n| `b` | `invented` |\n";
        let found = found(&[("docs/guide/src/from_a.md", table), contents, code]);
        assert_eq!(found, ["docs/guide/src/from_a.md:4: `invented` is not a name in Sinew"]);
    }
}
