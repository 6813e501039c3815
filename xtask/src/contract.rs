//! `docs/contract.md`, the table of the command line's JSON keys, as data. The tests of `sinew_cli` read it with this too.

use serde_json::Value;

/// Where the table is.
pub const PATH: &str = "docs/contract.md";

/// A row of the table: one key of one or more commands.
#[derive(Debug, PartialEq, Eq)]
pub struct Row {
    commands: Vec<String>,
    /// Path to the value: names with dots between; `[]` after a name goes into each element.
    pub key: String,
    kind: String,
    presence: Presence,
    /// Where it stands, from 1.
    pub line: usize,
}

impl Row {
    /// Whether both rows give the same key to one command.
    pub fn repeats(&self, other: &Self) -> bool {
        other.key == self.key && other.commands.iter().any(|command| self.commands.contains(command))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Presence {
    Always,
    /// Present, but may be null.
    Nullable,
    /// May be absent.
    Optional,
}

const KINDS: &[&str] = &["number", "integer", "string", "boolean", "array", "object"];

/// All rows, or the line and reason of the first that is malformed.
///
/// # Errors
/// If a row of a table that starts with `| command |` has not five columns, or a type that is not known.
pub fn parse(text: &str) -> Result<Vec<Row>, (usize, String)> {
    let mut rows = Vec::new();
    let mut in_table = false;
    for (index, content) in text.lines().enumerate() {
        let line = index + 1;
        in_table = content.starts_with('|') && (in_table || content.starts_with("| command |"));
        if in_table && !content.starts_with("| command |") && !content.starts_with("|-") {
            rows.push(row(content, line).map_err(|what| (line, what))?);
        }
    }
    Ok(rows)
}

fn row(content: &str, line: usize) -> Result<Row, String> {
    let cells: Vec<&str> = content.trim_matches('|').split('|').map(str::trim).collect();
    let [commands, key, kind, _unit, _meaning] = cells[..] else {
        return Err(format!("{} columns, not 5", cells.len()));
    };
    let (kind, presence) = match (kind.strip_suffix(" or null"), kind.strip_suffix(", optional")) {
        (Some(kind), _) => (kind, Presence::Nullable),
        (_, Some(kind)) => (kind, Presence::Optional),
        _ => (kind, Presence::Always),
    };
    if !KINDS.contains(&kind) {
        return Err(format!("type `{kind}` is none of {}", KINDS.join(", ")));
    }
    Ok(Row {
        commands: commands.split(", ").map(|command| command.trim_matches('`').to_owned()).collect(),
        key: key.trim_matches('`').to_owned(),
        kind: kind.to_owned(),
        presence,
        line,
    })
}

/// What in `output`, the JSON of `command`, does not keep the contract.
pub fn violations(rows: &[Row], command: &str, output: &Value) -> Vec<String> {
    let mut violations = Vec::new();
    for row in rows.iter().filter(|row| row.commands.iter().any(|name| name == command)) {
        let parents_and_leaf = row.key.rsplit_once('.');
        let (parents, leaf) = parents_and_leaf
            .map_or((Vec::new(), row.key.as_str()), |(parents, leaf)| (parents.split('.').collect(), leaf));
        for parent in descend(vec![output], &parents) {
            match parent.get(leaf) {
                None if row.presence == Presence::Optional => {}
                None => violations.push(format!("{command}: key `{}` is missing", row.key)),
                Some(Value::Null) if row.presence == Presence::Nullable => {}
                Some(value) if is_kind(value, &row.kind) => {}
                Some(value) => {
                    violations.push(format!("{command}: `{}` is {value}, not {}", row.key, row.kind));
                }
            }
        }
    }
    violations
}

/// The values reached from `values` along `path`. Absent ones are skipped: they have a row of their own.
fn descend<'a>(values: Vec<&'a Value>, path: &[&str]) -> Vec<&'a Value> {
    path.iter().fold(values, |values, step| match step.strip_suffix("[]") {
        Some(name) => values.iter().filter_map(|value| value[name].as_array()).flatten().collect(),
        None => values.iter().filter_map(|value| value.get(step)).collect(),
    })
}

fn is_kind(value: &Value, kind: &str) -> bool {
    match kind {
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "array" => value.is_array(),
        _ => value.is_object(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    const TABLE: &str = "# Contract\n\n| command | key | type | unit | meaning |\n|---|---|---|---|---|\n\
        | `demo`, `bake` | `nan` | integer | – | a count |\n\
        | `demo` | `up_s` | number or null | s | up again |\n\
        | `build` | `bodies` | array | – | bodies |\n\
        | `build` | `bodies[].bone` | string | – | name |\n\
        | `build` | `bodies[].radius_m` | number, optional | m | of a capsule |\n";

    fn check_output(command: &str, output: &Value, expected: &[&str]) {
        let rows = parse(TABLE).expect("the table is well formed");
        assert_eq!(violations(&rows, command, output), expected);
    }

    #[test]
    fn keys_and_types_are_held_against_the_table() {
        check_output("bake", &json!({ "nan": 0 }), &[]);
        check_output("demo", &json!({ "nan": 0, "up_s": null }), &[]);
        check_output(
            "demo",
            &json!({ "nan": 0.5 }),
            &["demo: `nan` is 0.5, not integer", "demo: key `up_s` is missing"],
        );
        check_output(
            "build",
            &json!({ "bodies": [{ "bone": "hip", "radius_m": 0.1 }, { "bone": "" }] }),
            &[],
        );
        check_output("build", &json!({ "bodies": [{}] }), &["build: key `bodies[].bone` is missing"]);
    }
}
