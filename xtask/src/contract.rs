//! Parses `docs/contract.md`, the lists of the command line's JSON keys. The tests of `sinew_cli` use it as well.

use serde_json::Value;

/// Path of the page.
pub const PATH: &str = "docs/contract.md";

/// An item of a list: one key of one or more commands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    commands: Vec<String>,
    /// Path to the value: names with dots between; `[]` after a name selects each element.
    pub key: String,
    kind: String,
    presence: Presence,
    /// Command and key of another object that has the same keys.
    like: Option<(String, String)>,
    /// Line number, from 1.
    pub line: usize,
}

impl Row {
    /// Returns true if both rows give the same key to one command.
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

/// Returns all rows, or the line and the reason of the first malformed one.
///
/// # Errors
/// If a line that starts with "- `" below a heading with commands is not "- `key` (type): meaning", or has an unknown type.
pub fn parse(text: &str) -> Result<Vec<Row>, (usize, String)> {
    let mut rows = Vec::new();
    let mut commands = Vec::new();
    for (index, content) in text.lines().enumerate() {
        if let Some(heading) = content.strip_prefix("### ") {
            commands = heading.split(", ").map(|command| command.trim_matches('`').to_owned()).collect();
        } else if !commands.is_empty() && content.starts_with("- `") {
            rows.push(row(content, &commands, index + 1).map_err(|what| (index + 1, what))?);
        }
    }
    let same: Vec<Row> = rows.iter().flat_map(|row| keys_of_like(&rows, row)).collect();
    rows.extend(same);
    Ok(rows)
}

fn row(content: &str, commands: &[String], line: usize) -> Result<Row, String> {
    let item = content.strip_prefix("- `").and_then(|item| item.split_once("` ("));
    let parts = item.and_then(|(key, rest)| Some((key, rest.split_once("): ")?.0)));
    let (key, kind) = parts.ok_or("not \"- `key` (type): meaning\"")?;
    let (kind, like) = match kind.split_once(" as ") {
        Some((kind, like)) => {
            let like = like.trim_matches('`').split_once("` `").ok_or("no command and key after `as`")?;
            (kind, Some((like.0.to_owned(), like.1.to_owned())))
        }
        None => (kind, None),
    };
    let (kind, presence) = match (kind.strip_suffix(" or null"), kind.strip_suffix(", optional")) {
        (Some(kind), _) => (kind, Presence::Nullable),
        (_, Some(kind)) => (kind, Presence::Optional),
        _ => (kind, Presence::Always),
    };
    if !KINDS.contains(&kind) {
        return Err(format!("type `{kind}` is none of {}", KINDS.join(", ")));
    }
    let (key, kind) = (key.to_owned(), kind.to_owned());
    Ok(Row { commands: commands.to_vec(), key, kind, presence, like, line })
}

/// Returns the rows of the object that `row` is like, as keys of `row`.
fn keys_of_like(rows: &[Row], row: &Row) -> Vec<Row> {
    let Some((command, like)) = &row.like else { return Vec::new() };
    let below = |other: &Row| Some(other.key.strip_prefix(like.as_str())?.strip_prefix('.')?.to_owned());
    let others = rows.iter().filter(|other| other.commands.contains(command));
    let keys = others.filter_map(|other| Some((other, below(other)?)));
    keys.map(|(other, leaf)| {
        let key = format!("{}.{leaf}", row.key);
        Row { commands: row.commands.clone(), key, line: row.line, ..other.clone() }
    })
    .collect()
}

/// Returns the violations of the contract in `output`, the JSON of `command`.
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

/// Returns the values reached from `values` along `path`. Skips absent values; other rows check them.
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

    const LISTS: &str = "# Contract\n\n### `demo`, `bake`\n\n- `nan` (integer): a count\n\
        \n### `demo`\n\n- `up_s` (number or null): up again\n\
        - `build` (object as `build` `quality`): the same figures\n\
        \n### `build`\n\n- `bodies` (array): bodies\n\
        - `bodies[].bone` (string): name\n\
        - `bodies[].radius_m` (number, optional): of a capsule\n\
        - `quality` (object, optional): figures\n\
        - `quality.gap_m` (number): a gap\n";

    fn check_output(command: &str, output: &Value, expected: &[&str]) {
        let rows = parse(LISTS).expect("the lists are well formed");
        assert_eq!(violations(&rows, command, output), expected);
    }

    #[test]
    fn violations_name_missing_keys_and_wrong_types() {
        let like = json!({ "gap_m": 0.1 });
        check_output("bake", &json!({ "nan": 0 }), &[]);
        check_output("demo", &json!({ "nan": 0, "up_s": null, "build": like }), &[]);
        check_output(
            "demo",
            &json!({ "nan": 0.5, "build": like }),
            &["demo: `nan` is 0.5, not integer", "demo: key `up_s` is missing"],
        );
        check_output(
            "demo",
            &json!({ "nan": 0, "up_s": null, "build": {} }),
            &["demo: key `build.gap_m` is missing"],
        );
        check_output(
            "build",
            &json!({ "bodies": [{ "bone": "hip", "radius_m": 0.1 }, { "bone": "" }] }),
            &[],
        );
        check_output("build", &json!({ "bodies": [{}] }), &["build: key `bodies[].bone` is missing"]);
    }
}
