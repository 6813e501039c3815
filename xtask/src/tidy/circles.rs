//! Dependency cycles among the files of a crate, which a reader must understand together; and the number of files
//! in one folder.
//!
//! A file depends on another if one of its paths leads to an item of the other, through any re-exports; a re-export
//! alone is no dependency. Methods do not count, because tokens do not show their types.

use super::lexer::{self, Kind, Token};
use super::rooms::is_test;
use super::{File, Finding, Repo};
use std::collections::{BTreeMap, BTreeSet};

/// Limit on the number of files of one dependency cycle.
const CIRCLE_FILES_MAX: usize = 10;
/// Limit on the number of files directly in `src/`, `lib.rs` included.
const FLAT_FILES_MAX: usize = 12;

/// Checks the sizes of dependency cycles, and the number of files directly in `src/`.
pub fn check(repo: &Repo) -> Vec<Finding> {
    let crates: BTreeSet<&str> = repo.rust_files().filter_map(File::crate_of_source).collect();
    let mut findings = Vec::new();
    for name in crates {
        let source = Source::read(repo, name);
        for circle in circles(&source.arrows()).into_iter().filter(|circle| circle.len() > CIRCLE_FILES_MAX) {
            let names: Vec<&str> = circle.iter().map(|&at| source.modules[at].inside).collect();
            let message = format!(
                "{} files form a dependency cycle, at most {CIRCLE_FILES_MAX}: {}",
                names.len(),
                names.join(", ")
            );
            findings.push(Finding::new(&format!("crates/{name}/src/{}", names[0]), 1, message));
        }
        let flat = repo.rust_files().filter(|file| file.crate_of_source() == Some(name));
        let flat = flat.filter(|file| file.path.matches('/').count() == 3).count();
        if flat > FLAT_FILES_MAX {
            let message =
                format!("{flat} files beside each other, at most {FLAT_FILES_MAX}: give them folders");
            findings.push(Finding::new(&format!("crates/{name}/src/lib.rs"), 1, message));
        }
    }
    findings
}

/// Metrics of a crate's files and names: a row of the table.
pub struct House<'a> {
    pub name: &'a str,
    /// Number of source files, without tests.
    pub files: usize,
    /// Number of files in `src/` itself.
    pub flat: usize,
    /// Number of files of the largest dependency cycle; 1 if there is none.
    pub circle: usize,
}

/// Returns the crates, by name.
pub fn houses(repo: &Repo) -> Vec<House<'_>> {
    let crates: BTreeSet<&str> = repo.rust_files().filter_map(File::crate_of_source).collect();
    let house = |name| {
        let source = Source::read(repo, name);
        let circle = circles(&source.arrows()).iter().map(Vec::len).max().unwrap_or(1);
        let flat = source.modules.iter().filter(|module| !module.inside.contains('/')).count();
        House { name, files: source.modules.len(), flat, circle }
    };
    crates.into_iter().map(house).collect()
}

/// The modules of one crate, without tests.
struct Source<'a> {
    modules: Vec<Module<'a>>,
    /// Numbers of modules by their paths from the root.
    places: BTreeMap<Vec<&'a str>, usize>,
}

/// A file as a module.
struct Module<'a> {
    /// File of the module, from `src/`.
    inside: &'a str,
    path: Vec<&'a str>,
    /// Code of the module without imports.
    code: Vec<Token<'a>>,
    /// Names that the module defines.
    items: BTreeSet<&'a str>,
    /// Names that the module imports, each with its path, and glob imports.
    imports: Vec<Import<'a>>,
}

/// One name of a `use`.
pub struct Import<'a> {
    /// Imported name; `*` for all names.
    pub name: &'a str,
    /// Path as written.
    pub path: Vec<&'a str>,
    /// True if the import has any `pub`.
    pub is_public: bool,
}

/// Result of resolving a path: the module, and whether the name was found there or is only expected there.
type Found = Option<(usize, bool)>;

impl<'a> Source<'a> {
    fn read(repo: &'a Repo, name: &str) -> Self {
        let files = repo.rust_files().filter(|file| file.crate_of_source() == Some(name));
        let files = files.filter(|file| !is_test(file, repo));
        let modules: Vec<Module<'_>> = files.map(Module::read).collect();
        let places = modules.iter().enumerate().map(|(at, module)| (module.path.clone(), at)).collect();
        Self { modules, places }
    }

    /// Returns the modules on which each module depends.
    fn arrows(&self) -> Vec<BTreeSet<usize>> {
        let of = |at: usize| {
            let module = &self.modules[at];
            let imported =
                module.imports.iter().filter(|import| !import.is_public || module.uses(import.name));
            let written = module.paths();
            let paths = imported.map(|import| import.path.clone()).chain(written);
            let named = paths.filter_map(|path| self.resolve(at, &path, 0)).map(|(to, _)| to);
            named.filter(|&to| to != at).collect()
        };
        (0..self.modules.len()).map(of).collect()
    }

    /// Returns the module that defines the end of a path from the module `at`.
    fn resolve(&self, at: usize, path: &[&'a str], depth: usize) -> Found {
        // Stops at a circular import through a name that two macros define.
        if depth > 16 {
            return None;
        }
        let mut place = self.modules[at].path.clone();
        let mut rest = path;
        if rest.first() == Some(&"crate") {
            place.clear();
            rest = &rest[1..];
        }
        while let Some(&first @ ("self" | "super")) = rest.first() {
            if first == "super" {
                place.pop();
            }
            rest = &rest[1..];
        }
        let is_bare = rest.len() == path.len();
        let found = self.descend(&place, rest, depth);
        found.filter(|&(_, is_there)| is_there || !is_bare)
    }

    fn descend(&self, place: &[&'a str], rest: &[&'a str], depth: usize) -> Found {
        let &at = self.places.get(place)?;
        let module = &self.modules[at];
        let Some((&name, after)) = rest.split_first().filter(|(name, _)| **name != "*") else {
            return Some((at, true));
        };
        let below: Vec<&str> = place.iter().copied().chain([name]).collect();
        if self.places.contains_key(&below) {
            return self.descend(&below, after, depth);
        }
        if module.items.contains(name) {
            return Some((at, true));
        }
        if let Some(import) = module.imports.iter().find(|import| import.name == name) {
            let path: Vec<&str> = import.path.iter().chain(after).copied().collect();
            return self.resolve(at, &path, depth + 1);
        }
        let all = module.imports.iter().filter(|import| import.name == "*");
        let within = |import: &Import<'a>| {
            let path: Vec<&str> =
                import.path.iter().copied().filter(|&word| word != "*").chain([name]).collect();
            self.resolve(at, &path, depth + 1).filter(|&(_, is_there)| is_there)
        };
        Some(all.filter_map(within).next().unwrap_or((at, false)))
    }
}

impl<'a> Module<'a> {
    fn read(file: &'a File) -> Self {
        let inside = file.path.splitn(4, '/').nth(3).unwrap_or_default();
        let mut path: Vec<&str> = inside.trim_end_matches(".rs").split('/').collect();
        if matches!(path.last(), Some(&("mod" | "lib" | "main"))) {
            path.pop();
        }
        let tokens = file.tokens_without_tests();
        let (mut items, mut imports, mut code) = (BTreeSet::new(), Vec::new(), Vec::new());
        let (mut at, mut depth) = (0, 0_usize);
        while let Some(token) = tokens.get(at) {
            match token.text {
                "{" => depth += 1,
                "}" => depth = depth.saturating_sub(1),
                "use" => {
                    let is_public = at > 0 && matches!(tokens[at - 1].text, "pub" | ")");
                    let length = tokens[at..].iter().position(|token| token.text == ";");
                    let end = length.map_or(tokens.len(), |length| at + length);
                    import(&tokens[at + 1..end], &mut Vec::new(), is_public, &mut imports);
                    at = end;
                    continue;
                }
                "struct" | "enum" | "trait" | "fn" | "const" | "static" | "type" | "union" if depth == 0 => {
                    items.extend(
                        tokens.get(at + 1).filter(|next| next.kind == Kind::Word).map(|next| next.text),
                    );
                }
                "macro_rules" => items.extend(tokens.get(at + 2).map(|next| next.text)),
                _ => {}
            }
            code.push(*token);
            at += 1;
        }
        Self { inside, path, code, items, imports }
    }

    /// Returns true if a word occurs in the module's code.
    fn uses(&self, word: &str) -> bool {
        self.code.iter().any(|token| token.text == word)
    }

    /// Returns the paths of more than one word in the module's code.
    fn paths(&self) -> Vec<Vec<&'a str>> {
        let text = |at: usize| self.code.get(at).map_or("", |token| token.text);
        let is_word = |at: usize| self.code.get(at).is_some_and(|token| token.kind == Kind::Word);
        let mut paths = Vec::new();
        let mut at = 0;
        while at < self.code.len() {
            // `pub(in path)` uses nothing.
            let is_scope = at > 1 && text(at - 1) == "in" && text(at - 2) == "(";
            let begins = is_word(at) && text(at + 1) == "::" && (at == 0 || text(at - 1) != "::");
            let mut path = vec![text(at)];
            while begins && text(at + 1) == "::" && is_word(at + 2) {
                path.push(text(at + 2));
                at += 2;
            }
            if path.len() > 1 && !is_scope {
                paths.push(path);
            }
            at += 1;
        }
        paths
    }
}

/// Returns the imports of a file.
pub fn imports(file: &File) -> Vec<Import<'_>> {
    Module::read(file).imports
}

/// Adds the imports of a `use` tree, with the path `prefix` before it.
fn import<'a>(tree: &[Token<'a>], prefix: &mut Vec<&'a str>, is_public: bool, imports: &mut Vec<Import<'a>>) {
    let before = prefix.len();
    let mut at = 0;
    let mut name = None;
    while let Some(token) = tree.get(at) {
        match token.text {
            "{" => {
                let close = lexer::closing(tree, at);
                for part in lexer::parts(&tree[at + 1..close]) {
                    import(part, prefix, is_public, imports);
                }
                prefix.truncate(before);
                return;
            }
            "::" => {}
            "as" => {
                name = tree.get(at + 1).map(|next| next.text);
                break;
            }
            ";" => break,
            "self" if at > 0 || before > 0 => {}
            word => prefix.push(word),
        }
        at += 1;
    }
    if let Some(&last) = prefix.last() {
        imports.push(Import { name: name.unwrap_or(last), path: prefix.clone(), is_public });
    }
    prefix.truncate(before);
}

/// Returns dependency cycles of more than one module: strongly connected components (Tarjan 1972).
fn circles(arrows: &[BTreeSet<usize>]) -> Vec<Vec<usize>> {
    let mut search =
        Search { arrows, order: vec![None; arrows.len()], low: vec![0; arrows.len()], ..Search::default() };
    (0..arrows.len()).for_each(|at| search.visit(at));
    search.circles
}

/// A depth-first search.
#[derive(Default)]
struct Search<'a> {
    arrows: &'a [BTreeSet<usize>],
    /// Order in which each module was visited.
    order: Vec<Option<usize>>,
    /// Earliest visited module that is reachable from each module.
    low: Vec<usize>,
    stack: Vec<usize>,
    visited: usize,
    circles: Vec<Vec<usize>>,
}

impl Search<'_> {
    fn visit(&mut self, at: usize) {
        if self.order[at].is_some() {
            return;
        }
        let number = self.visited;
        (self.order[at], self.low[at]) = (Some(number), number);
        self.visited += 1;
        self.stack.push(at);
        for &to in &self.arrows[at] {
            match self.order[to] {
                None => {
                    self.visit(to);
                    self.low[at] = self.low[at].min(self.low[to]);
                }
                Some(order) if self.stack.contains(&to) => self.low[at] = self.low[at].min(order),
                Some(_) => {}
            }
        }
        if self.low[at] == number {
            let from = self.stack.iter().position(|&other| other == at).unwrap_or_default();
            let mut circle = self.stack.split_off(from);
            circle.sort_unstable();
            if circle.len() > 1 {
                self.circles.push(circle);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn planted(files: &[(&str, &str)]) -> Vec<Vec<String>> {
        let files: Vec<(String, &str)> =
            files.iter().map(|&(path, text)| (format!("crates/sinew_math/src/{path}"), text)).collect();
        let files: Vec<(&str, &str)> = files.iter().map(|(path, text)| (path.as_str(), *text)).collect();
        let repo = Repo::planted(&files);
        let source = Source::read(&repo, "sinew_math");
        let names =
            |circle: Vec<usize>| circle.iter().map(|&at| source.modules[at].inside.to_owned()).collect();
        circles(&source.arrows()).into_iter().map(names).collect()
    }

    #[test]
    fn planted_cycles_are_found() {
        let circle = |a: &str, b: &str| {
            planted(&[("lib.rs", "mod a; mod b; pub use b::B;"), ("a.rs", a), ("b.rs", b)])
        };
        let ab = [["a.rs".to_owned(), "b.rs".to_owned()]];
        let back = "use crate::a::A; pub struct B;";
        for there in [
            "use crate::b::B; pub struct A;",
            "use super::{b::{self, B}}; pub struct A;",
            "use crate::B; pub struct A;",
            "pub struct A; fn f() { crate::b::f() }",
            "use super::b; pub struct A; fn f() { b::B::new() }",
            "use crate::*; pub struct A; fn f() { B::new() }",
            "pub use crate::b::B as C; pub struct A(C);",
        ] {
            assert_eq!(circle(there, back), ab, "{there}");
        }
        for there in [
            "pub struct A;",
            "pub use crate::b::B; pub struct A;",
            "// crate::b::B\npub struct A;",
            "pub struct A;\n#[cfg(test)]\nmod tests { use crate::b::B; }",
            "pub(in crate::b) struct A;",
        ] {
            assert!(circle(there, back).is_empty(), "{there}");
        }
    }

    #[test]
    fn re_exports_count_where_they_are_defined() {
        let files = [
            ("lib.rs", "mod room;"),
            ("room/mod.rs", "mod low; mod high; pub use low::Low; pub use high::High;"),
            ("room/low.rs", "pub struct Low;"),
            ("room/high.rs", "use super::Low; pub struct High(Low);"),
        ];
        assert!(planted(&files).is_empty());
    }

    #[test]
    fn large_cycle_and_crowded_folder_are_findings() {
        let ring = |count: usize| {
            let of = |k: usize| {
                (
                    format!("crates/sinew_math/src/r/f{k}.rs"),
                    format!("use super::f{}::f; pub fn f() {{}}", (k + 1) % count),
                )
            };
            let mods: String = (0..count).map(|k| format!("mod f{k};")).collect();
            let mut files: Vec<(String, String)> = (0..count).map(of).collect();
            files.push(("crates/sinew_math/src/r/mod.rs".into(), mods));
            let files: Vec<(&str, &str)> =
                files.iter().map(|(path, text)| (path.as_str(), text.as_str())).collect();
            check(&Repo::planted(&files)).len()
        };
        assert_eq!((ring(CIRCLE_FILES_MAX), ring(CIRCLE_FILES_MAX + 1)), (0, 1));
        let names: Vec<String> =
            (0..=FLAT_FILES_MAX).map(|k| format!("crates/sinew_math/src/{k}.rs")).collect();
        let files: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), "")).collect();
        let found = check(&Repo::planted(&files));
        assert!(found[0].to_string().contains("13 files beside each other"), "{found:?}");
    }
}
