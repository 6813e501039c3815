//! Limits on the lengths of functions and files.

use super::lexer::{self, Kind};
use super::{File, Finding, Repo};

const FUNCTION_LINES_MAX: usize = 70;
const FILE_LINES_MAX: usize = 1_000;

/// Lines of `path function-name lines` or `path file lines`; `#` starts a comment.
const EXCEPTIONS: &str = "xtask/exceptions.txt";

/// Number of exceptions. May only be lowered.
const EXCEPTIONS_MAX: usize = 0;

/// A piece of code with a length: a file, or a function in one.
struct Piece {
    path: String,
    name: String,
    line: usize,
    lines: usize,
}

struct Exception {
    path: String,
    name: String,
    lines: usize,
    /// Line of the exception in the list.
    line: usize,
}

/// Checks that no piece exceeds its limit, except for the exceptions, each with its exact length; and that every
/// exception is needed.
pub fn check(repo: &Repo) -> Vec<Finding> {
    check_up_to(repo, EXCEPTIONS_MAX)
}

fn check_up_to(repo: &Repo, exceptions_max: usize) -> Vec<Finding> {
    let long: Vec<Piece> =
        repo.rust_files().flat_map(pieces).filter(|piece| limit(piece) < piece.lines).collect();
    let exceptions = match repo.file(EXCEPTIONS).map(|file| parse(&file.text)).transpose() {
        Ok(exceptions) => exceptions.unwrap_or_default(),
        Err(line) => return vec![Finding::new(EXCEPTIONS, line, "not `path name lines`")],
    };
    let mut findings = Vec::new();
    for piece in &long {
        let excused = exceptions.iter().any(|exception| {
            exception.path == piece.path && exception.name == piece.name && piece.lines <= exception.lines
        });
        if !excused {
            let message = format!("{}: {} lines, at most {}", piece.name, piece.lines, limit(piece));
            findings.push(Finding::new(&piece.path, piece.line, message));
        }
    }
    for exception in &exceptions {
        let same = |piece: &&Piece| piece.path == exception.path && piece.name == exception.name;
        match long.iter().find(same) {
            None => findings.push(Finding::new(EXCEPTIONS, exception.line, "no longer needed: remove it")),
            Some(piece) if piece.lines < exception.lines => {
                let message = format!("has shrunk: lower it to {}", piece.lines);
                findings.push(Finding::new(EXCEPTIONS, exception.line, message));
            }
            Some(_) => {}
        }
    }
    if exceptions_max < exceptions.len() {
        findings.push(Finding::new(
            EXCEPTIONS,
            1,
            format!("more than {exceptions_max} exceptions: split the code"),
        ));
    }
    findings
}

fn limit(piece: &Piece) -> usize {
    if piece.name == "file" { FILE_LINES_MAX } else { FUNCTION_LINES_MAX }
}

/// Returns the exceptions, or the number of the first malformed line.
fn parse(text: &str) -> Result<Vec<Exception>, usize> {
    let mut exceptions = Vec::new();
    for (index, content) in text.lines().enumerate() {
        let line = index + 1;
        let words: Vec<&str> = content.split('#').next().unwrap_or_default().split_whitespace().collect();
        match words[..] {
            [] => {}
            [path, name, lines] => exceptions.push(Exception {
                path: path.to_owned(),
                name: name.to_owned(),
                lines: lines.parse().map_err(|_| line)?,
                line,
            }),
            _ => return Err(line),
        }
    }
    Ok(exceptions)
}

/// Returns the file and its functions, nested ones included.
fn pieces(file: &File) -> Vec<Piece> {
    let whole =
        Piece { path: file.path.clone(), name: "file".into(), line: 1, lines: file.text.lines().count() };
    let mut pieces = vec![whole];
    let tokens = file.tokens();
    for at in lexer::find(&tokens, "fn") {
        // `fn(f32) -> f32` is a type.
        let Some(name) = tokens.get(at + 1).filter(|token| token.kind == Kind::Word) else { continue };
        let line = tokens[at].line;
        let lines = tokens[lexer::end_of_item(&tokens, at)].line - line + 1;
        pieces.push(Piece { path: file.path.clone(), name: name.text.to_owned(), line, lines });
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::super::tests::check_lines;
    use super::*;

    const FILE: &str = "crates/sinew/src/lib.rs";

    fn function(lines: usize) -> String {
        format!("\nfn long() {{{}}}\n", "\n".repeat(lines - 1))
    }

    fn check_with(exceptions: &str, lines: usize) -> Vec<String> {
        let repo = Repo::planted(&[(FILE, &function(lines)), (EXCEPTIONS, exceptions)]);
        check_up_to(&repo, 1).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_long_function_and_a_long_file_are_found() {
        check_lines(check, FILE, &function(70), &[]);
        check_lines(check, FILE, &function(71), &[2]);
        check_lines(check, FILE, &"\n".repeat(1_000), &[]);
        check_lines(check, FILE, &"\n".repeat(1_001), &[1]);
        check_lines(check, FILE, "trait T { fn f(); } type F = fn(f32);", &[]);
    }

    #[test]
    fn exceptions_are_accepted_and_may_only_shrink() {
        assert!(check_with("crates/sinew/src/lib.rs long 80 # why\n", 80).is_empty());
        assert_eq!(check_with("crates/sinew/src/lib.rs long 80", 81).len(), 1, "an exception must not grow");
        assert_eq!(
            check_with("crates/sinew/src/lib.rs long 80", 75),
            ["xtask/exceptions.txt:1: has shrunk: lower it to 75"]
        );
        assert_eq!(
            check_with("# list\ncrates/sinew/src/lib.rs long 80", 60),
            ["xtask/exceptions.txt:2: no longer needed: remove it"]
        );
        let two = "crates/sinew/src/lib.rs long 80\ncrates/sinew/src/lib.rs long 80";
        assert_eq!(check_with(two, 80), ["xtask/exceptions.txt:1: more than 1 exceptions: split the code"]);
        assert_eq!(
            check_with("crates/sinew/src/lib.rs", 60),
            ["xtask/exceptions.txt:1: not `path name lines`"]
        );
    }
}
