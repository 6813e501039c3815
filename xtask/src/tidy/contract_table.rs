//! `docs/contract.md` can be read by machines.

use super::{Finding, Repo};
use crate::contract::{PATH, parse};

/// The table can be read, and no command has a key twice.
pub fn check(repo: &Repo) -> Vec<Finding> {
    let Some(file) = repo.file(PATH) else { return Vec::new() };
    let rows = match parse(&file.text) {
        Ok(rows) => rows,
        Err((line, what)) => return vec![Finding::new(PATH, line, what)],
    };
    let mut findings = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        if rows[..index].iter().any(|other| row.repeats(other)) {
            findings.push(Finding::new(PATH, row.line, format!("`{}` is there twice", row.key)));
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "| command | key | type | unit | meaning |\n|---|---|---|---|---|\n\
        | `demo`, `bake` | `nan` | integer | – | a count |\n";

    #[test]
    fn a_malformed_table_is_found() {
        let found = |text: &str| {
            check(&Repo::planted(&[(PATH, text)])).iter().map(ToString::to_string).collect::<Vec<_>>()
        };
        assert!(found(TABLE).is_empty());
        let twice = format!("{TABLE}| `bake` | `nan` | integer | – | again |\n");
        assert_eq!(found(&twice), ["docs/contract.md:4: `nan` is there twice"]);
        assert_eq!(found("| command | key |\n| a | b |"), ["docs/contract.md:2: 2 columns, not 5"]);
        assert_eq!(found("| command |\n| a | b | float | c | d |").len(), 1);
    }
}
