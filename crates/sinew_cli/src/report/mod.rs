//! Report of a command.

pub(crate) mod garments_report;
pub(crate) mod progress;
pub(crate) mod quality_report;
pub(crate) mod ragdoll_report;
pub(crate) mod skin_report;
pub(crate) mod springs_report;
pub(crate) mod story;
pub(crate) mod table;

use serde_json::Value;

/// The result of a command, as JSON and as text.
#[derive(Debug)]
pub struct Report {
    /// Report for `--json`: an object with the keys of `docs/contract.md`.
    pub json: Value,
    /// Report for a person, with a line feed at the end.
    pub text: String,
}

impl Report {
    /// Returns the text for stdout.
    pub fn shown(&self, as_json: bool) -> String {
        if as_json { one_object(&self.json) } else { self.text.clone() }
    }
}

/// Returns an object as text that ends in a line feed.
pub fn one_object(value: &Value) -> String {
    format!("{value:#}\n")
}

/// Returns the shortest decimal that identifies a number; null for non-finite numbers.
pub fn number(x: f32) -> Value {
    // Uses the decimal digits of the f32, not those of its f64 value.
    x.to_string().parse::<f64>().map_or(Value::Null, Value::from)
}

/// Returns [`number`] of each element.
pub fn numbers(xs: &[f32]) -> Value {
    xs.iter().map(|&x| number(x)).collect()
}
