//! Checks the list of all Rust names of characters and bakes, each with its name in Python or the reason why it has
//! none.

use super::lexer::{Kind, Token};
use super::{Finding, Repo};
use std::collections::{BTreeMap, BTreeSet};

/// The list. A line is `Rust name = Python name`, or `Rust name - reason`.
const LIST: &str = "bindings/python/rust_names.txt";
/// Python's names: functions, classes with their members, and `function(argument)`.
const STUBS: [&str; 2] = ["bindings/python/python/sinew/_sinew.pyi", "bindings/python/python/sinew/types.py"];
/// Folders with the types below.
const SOURCES: [&str; 2] = ["crates/sinew_ragdoll/src/character/", "crates/sinew_ragdoll/src/bake/"];
/// Types whose public functions and fields are listed.
const TYPES: [&str; 13] = [
    "Character",
    "CharacterDef",
    "InWorld",
    "MotionSet",
    "Limb",
    "Grip",
    "Grab",
    "BakeInput",
    "BakeHit",
    "BakeDrive",
    "BakeReturn",
    "BakeMover",
    "Baked",
];
/// Functions of bakes.
const FUNCTIONS: [&str; 2] = ["bake", "bake_together"];

/// Checks that the list has all Rust names and no others, and that Python has the names given in it.
pub fn check(repo: &Repo) -> Vec<Finding> {
    let Some(list) = repo.file(LIST) else { return Vec::new() };
    let offered = rust_names(repo);
    let python = python_names(repo);
    let (mut findings, mut listed) = (Vec::new(), BTreeSet::new());
    for (index, line) in list.text.lines().enumerate() {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let mut add = |message: String| findings.push(Finding::new(LIST, index + 1, message));
        let Some((rust, (sign, rest))) = parsed(line) else {
            add("not `Rust name = Python name` or `Rust name - reason`".into());
            continue;
        };
        if !offered.contains(rust) {
            add(format!("`{rust}` is not offered by Rust"));
        }
        listed.insert(rust.to_owned());
        for name in rest.split(", ").filter(|name| sign == '=' && !python.contains(*name)) {
            add(format!("`{name}` is not in the stubs"));
        }
    }
    let missing = offered.difference(&listed).map(|name| {
        Finding::new(
            LIST,
            1,
            format!("`{name}` is missing: name its form in Python, or the reason why it has none"),
        )
    });
    findings.extend(missing);
    findings
}

fn parsed(line: &str) -> Option<(&str, (char, &str))> {
    [('=', " = "), ('-', " - ")].into_iter().find_map(|(sign, text)| {
        let (rust, rest) = line.split_once(text)?;
        (!rust.contains(' ') && !rest.trim().is_empty()).then_some((rust, (sign, rest)))
    })
}

/// Returns `Type::function`, `Type::field` and functions of bakes.
fn rust_names(repo: &Repo) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for file in repo.rust_files().filter(|file| SOURCES.iter().any(|folder| file.path.starts_with(folder))) {
        let tokens = file.tokens_without_tests();
        let mut at = 0;
        while at < tokens.len() {
            match block(&tokens, at) {
                Some((owner, begin)) if TYPES.contains(&owner) => {
                    names.extend(members(&tokens, begin).map(|name| format!("{owner}::{name}")));
                }
                _ => {}
            }
            let is_function = texts(&tokens, at, ["pub", "fn"]);
            names.extend(
                tokens
                    .get(at + 2)
                    .filter(|name| is_function && FUNCTIONS.contains(&name.text) && depth(&tokens[..at]) == 0)
                    .map(|name| name.text.to_owned()),
            );
            at += 1;
        }
    }
    names
}

fn texts<const N: usize>(tokens: &[Token<'_>], at: usize, wanted: [&str; N]) -> bool {
    wanted.iter().enumerate().all(|(i, text)| tokens.get(at + i).is_some_and(|token| token.text == *text))
}

fn depth(tokens: &[Token<'_>]) -> i32 {
    tokens.iter().map(|token| i32::from(token.text == "{") - i32::from(token.text == "}")).sum()
}

/// Returns the type and the first token of a `pub struct` or an inherent `impl` that begins at a token.
fn block<'a>(tokens: &[Token<'a>], at: usize) -> Option<(&'a str, usize)> {
    let is_struct = texts(tokens, at, ["pub", "struct"]);
    let is_impl =
        tokens[at].text == "impl" && at.checked_sub(1).is_none_or(|before| is_end(tokens[before].text));
    if !(is_struct || is_impl) {
        return None;
    }
    let open = at + tokens[at..].iter().position(|token| matches!(token.text, "{" | ";"))?;
    let head = &tokens[at + 1..open];
    if tokens[open].text == ";" || head.iter().any(|token| token.text == "for") {
        return None;
    }
    head.iter().find(|token| TYPES.contains(&token.text)).map(|token| (token.text, open + 1))
}

fn is_end(text: &str) -> bool {
    matches!(text, "}" | ";" | "]")
}

/// Returns the public functions and fields of the block whose first token is at `begin`.
fn members<'a>(tokens: &'a [Token<'a>], begin: usize) -> impl Iterator<Item = &'a str> {
    let mut level = 0;
    let inside = tokens[begin..].iter().enumerate().take_while(move |(_, token)| {
        level += i32::from(token.text == "{") - i32::from(token.text == "}");
        level >= 0
    });
    inside.filter_map(move |(i, _)| {
        let at = begin + i;
        if !texts(tokens, at, ["pub"]) || depth(&tokens[begin..at]) != 0 {
            return None;
        }
        let name = tokens.get(at + 1 + usize::from(texts(tokens, at + 1, ["fn"])))?;
        let is_member = texts(tokens, at + 1, ["fn"]) || texts(tokens, at + 2, [":"]);
        (is_member && name.kind == Kind::Word).then_some(name.text)
    })
}

/// Returns `Class`, `Class.member`, `function`, and each of these with `(argument)`.
fn python_names(repo: &Repo) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    let mut arguments: BTreeMap<String, String> = BTreeMap::new();
    for file in STUBS.iter().filter_map(|path| repo.file(path)) {
        let (mut class, mut open) = (String::new(), None::<String>);
        for line in file.text.lines() {
            let (code, is_inside) = (line.trim_start(), line.starts_with(' '));
            if let Some(name) = line.strip_prefix("class ").and_then(word) {
                name.clone_into(&mut class);
                names.insert(class.clone());
            } else if let Some(name) = code.strip_prefix("def ").and_then(word) {
                let full = match (is_inside, name) {
                    (true, "__new__") => class.clone(),
                    (true, _) => format!("{class}.{name}"),
                    (false, _) => name.to_owned(),
                };
                names.insert(full.clone());
                open = Some(full);
            } else if is_inside && open.is_none() && code.contains(": ") {
                names.extend(word(code).map(|name| format!("{class}.{name}")));
            }
            let Some(owner) = &open else { continue };
            *arguments.entry(owner.clone()).or_default() += code;
            if code.contains("->") {
                open = None;
            }
        }
    }
    for (owner, text) in arguments {
        let given = text.split_once('(').map_or("", |(_, rest)| rest).split(',').filter_map(word);
        names.extend(given.map(|name| format!("{owner}({name})")));
    }
    names
}

/// Returns the identifier at the start of a text.
fn word(text: &str) -> Option<&str> {
    let text = text.trim_start();
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
    (end > 0).then_some(&text[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: &str = "pub struct BakeHit { pub time: f32, body: usize }\nimpl BakeHit { pub fn late(&self) -> bool { \
                          if self.time > 1.0 { true } else { false } } fn own() {} }\nimpl Copy for BakeHit {}\npub fn bake() {}";
    const STUB: &str = "def bake(\n    hits: int,\n    seconds: float = 1.0,\n) -> None: ...\nclass Hit:\n    \
                        @property\n    def late(self) -> bool: ...\nclass Settings(TypedDict):\n    time: float\n";

    fn found(list: &str) -> Vec<String> {
        let files = [(LIST, list), ("crates/sinew_ragdoll/src/bake/mod.rs", SOURCE), (STUBS[0], STUB)];
        check(&Repo::planted(&files)).into_iter().map(|finding| finding.message).collect()
    }

    #[test]
    fn each_rust_name_has_a_python_name_or_a_reason() {
        let all =
            "# Comment\nBakeHit::time = bake(hits), Settings.time\nBakeHit::late = Hit.late\nbake - later";
        assert_eq!(found(all), Vec::<String>::new());
    }

    #[test]
    fn missing_and_wrong_names_are_found() {
        let findings = found("BakeHit::time = bake(speed)\nBakeHit::early - no\nbake = bake\nbake");
        let wanted = [
            "`bake(speed)` is not in the stubs",
            "`BakeHit::early` is not offered",
            "not `Rust",
            "`BakeHit::late` is missing",
        ];
        assert!(findings.len() == wanted.len(), "{findings:?}");
        assert!(findings.iter().zip(wanted).all(|(found, wanted)| found.starts_with(wanted)), "{findings:?}");
    }
}
