//! Checks that `docs/contract.md` can be parsed.

use super::{Finding, Repo};
use crate::contract::{PATH, parse};

/// Reports items that cannot be parsed, and keys that a command has twice.
pub fn check(repo: &Repo) -> Vec<Finding> {
    let Some(file) = repo.file(PATH) else { return Vec::new() };
    let rows = match parse(&file.text) {
        Ok(rows) => rows,
        Err((line, what)) => return vec![Finding::new(PATH, line, what)],
    };
    let mut findings = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        if rows[..index].iter().any(|other| row.repeats(other)) {
            findings.push(Finding::new(PATH, row.line, format!("`{}` is listed twice", row.key)));
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    const LISTS: &str = "### `demo`, `bake`\n\n- `nan` (integer): a count\n";

    #[test]
    fn malformed_lines_are_reported() {
        let found = |text: &str| {
            check(&Repo::planted(&[(PATH, text)])).iter().map(ToString::to_string).collect::<Vec<_>>()
        };
        assert!(found(LISTS).is_empty());
        let twice = format!("{LISTS}\n### `bake`\n\n- `nan` (integer): again\n");
        assert_eq!(found(&twice), ["docs/contract.md:7: `nan` is listed twice"]);
        assert_eq!(found("### `a`\n- `b`: c"), ["docs/contract.md:2: not \"- `key` (type): meaning\""]);
        assert_eq!(found("### `a`\n- `b` (float): c").len(), 1);
    }
}
