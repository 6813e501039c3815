//! Reads JSON with a path for every error, and writes JSON that people can edit.

use crate::error::{Error, Result, quoted};
use serde_json::Value;

/// Parses bytes as JSON.
pub(crate) fn parse(bytes: &[u8]) -> Result<Value> {
    serde_json::from_slice(bytes).map_err(|e| {
        let text = e.to_string();
        let what = text.split(" at line ").next().unwrap_or_default();
        Error::malformed(format!("not JSON: {what}"), format!("line {} column {}", e.line(), e.column()))
    })
}

/// A value inside a JSON document. An error finds its path by searching the document for the value's address, so the
/// path costs no time without an error.
#[derive(Clone, Copy)]
pub(crate) struct At<'a> {
    root: &'a Value,
    value: &'a Value,
}

impl<'a> At<'a> {
    pub(crate) fn root(root: &'a Value) -> Self {
        Self { root, value: root }
    }

    pub(crate) fn value(self) -> &'a Value {
        self.value
    }

    /// JSON path such as `bodies[3].shapes[0].half_extents`; `top level` for the document itself.
    pub(crate) fn path(self) -> String {
        let mut path = String::new();
        if !find(self.root, self.value, &mut path) || path.is_empty() {
            return "top level".into();
        }
        path
    }

    pub(crate) fn malformed(self, what: impl Into<String>) -> Error {
        Error::malformed(what, self.path())
    }

    pub(crate) fn unsupported(self, what: impl Into<String>) -> Error {
        Error::unsupported(what, self.path())
    }

    /// Returns the value of an optional key. Fails if `self` is no object.
    pub(crate) fn get(self, key: &str) -> Result<Option<At<'a>>> {
        let object = self.value.as_object().ok_or_else(|| self.malformed("must be an object"))?;
        Ok(object.get(key).map(|value| At { root: self.root, value }))
    }

    /// Returns the value of a required key.
    pub(crate) fn need(self, key: &str) -> Result<At<'a>> {
        self.get(key)?.ok_or_else(|| self.malformed(format!("`{key}` is missing")))
    }

    /// Rejects keys outside `known`; otherwise a misspelt key would silently give the default.
    pub(crate) fn only(self, known: &[&str]) -> Result<()> {
        let object = self.value.as_object().ok_or_else(|| self.malformed("must be an object"))?;
        match object.keys().find(|key| !known.contains(&key.as_str())) {
            Some(key) => {
                Err(self.malformed(format!("unknown key {}; known are {}", quoted(key), known.join(", "))))
            }
            None => Ok(()),
        }
    }

    /// Returns the elements of an array.
    pub(crate) fn items(self) -> Result<Vec<At<'a>>> {
        let array = self.value.as_array().ok_or_else(|| self.malformed("must be an array"))?;
        Ok(array.iter().map(|value| At { root: self.root, value }).collect())
    }

    /// Returns the elements of the array under an optional key; empty if the key is absent.
    pub(crate) fn list(self, key: &str) -> Result<Vec<At<'a>>> {
        self.get(key)?.map_or_else(|| Ok(Vec::new()), Self::items)
    }

    pub(crate) fn str(self) -> Result<&'a str> {
        self.value.as_str().ok_or_else(|| self.malformed("must be a string"))
    }

    /// Returns the string under the key `name`, or `""` if it is absent or no string; for names, which need no check.
    pub(crate) fn name(self) -> String {
        self.value.get("name").and_then(Value::as_str).unwrap_or_default().to_owned()
    }

    pub(crate) fn bool(self) -> Result<bool> {
        self.value.as_bool().ok_or_else(|| self.malformed("must be true or false"))
    }

    /// Reads a whole number ≥ 0; `3.0` counts as 3.
    pub(crate) fn usize(self) -> Result<usize> {
        const EXACT: f64 = 9_007_199_254_740_992.0;
        let whole = self.value.as_u64().or_else(|| {
            let x = self.value.as_f64()?;
            ((0.0..EXACT).contains(&x) && x.fract() == 0.0).then_some(x as u64)
        });
        whole
            .and_then(|n| usize::try_from(n).ok())
            .ok_or_else(|| self.malformed("must be a whole number, 0 or more"))
    }

    /// Reads a whole number ≥ 0, up to 64 bits.
    pub(crate) fn u64(self) -> Result<u64> {
        self.value.as_u64().ok_or_else(|| self.malformed("must be a whole number, 0 or more"))
    }

    /// Reads a whole number below `len`, the length of the list named `of`.
    pub(crate) fn index(self, len: usize, of: &str) -> Result<usize> {
        let index = self.usize()?;
        if index >= len {
            return Err(self.malformed(format!("index {index} is out of range: there are {len} {of}")));
        }
        Ok(index)
    }

    /// Reads a number.
    pub(crate) fn f64(self) -> Result<f64> {
        self.value.as_f64().ok_or_else(|| self.malformed("must be a number"))
    }

    /// Reads a number that is finite as `f32`.
    pub(crate) fn f32(self) -> Result<f32> {
        let number = self.f64()? as f32;
        if !number.is_finite() {
            return Err(self.malformed("number is too large"));
        }
        Ok(number)
    }

    /// Reads an array of exactly `N` finite numbers.
    pub(crate) fn numbers<const N: usize>(self) -> Result<[f32; N]> {
        let items = self.items()?;
        if items.len() != N {
            return Err(self.malformed(format!("must have {N} numbers, has {}", items.len())));
        }
        let mut out = [0.0; N];
        for (slot, item) in out.iter_mut().zip(items) {
            *slot = item.f32()?;
        }
        Ok(out)
    }

    /// Reads a finite number above 0.
    pub(crate) fn positive(self) -> Result<f32> {
        let number = self.f32()?;
        if number <= 0.0 {
            return Err(self.malformed("must be more than 0"));
        }
        Ok(number)
    }

    /// Reads a finite number, 0 or more.
    pub(crate) fn not_negative(self) -> Result<f32> {
        let number = self.f32()?;
        if number < 0.0 {
            return Err(self.malformed("must not be negative"));
        }
        Ok(number)
    }

    /// Reads the numbers under an optional key, or returns `default`.
    pub(crate) fn numbers_or<const N: usize>(self, key: &str, default: [f32; N]) -> Result<[f32; N]> {
        self.get(key)?.map_or(Ok(default), Self::numbers)
    }
}

/// Appends the path from `from` to the value at the address of `target`, and returns true. If `from` does not contain
/// the target, returns false and leaves `path` unchanged.
fn find(from: &Value, target: &Value, path: &mut String) -> bool {
    if core::ptr::eq(from, target) {
        return true;
    }
    let length = path.len();
    match from {
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                path.push_str(&format!("[{i}]"));
                if find(item, target, path) {
                    return true;
                }
                path.truncate(length);
            }
        }
        Value::Object(entries) => {
            for (key, value) in entries {
                if !path.is_empty() {
                    path.push('.');
                }
                // Keys may contain any characters, but the path must be one line.
                path.extend(key.chars().flat_map(char::escape_debug));
                if find(value, target, path) {
                    return true;
                }
                path.truncate(length);
            }
        }
        _ => {}
    }
    false
}

/// Converts a number to the shortest decimal that reads back as the same `f32`.
///
/// # Panics
/// If `x` is not finite: JSON has no such number.
pub(crate) fn number(x: f32) -> Value {
    assert!(x.is_finite(), "a file can only hold finite numbers, not {x}");
    Value::from(x.to_string().parse::<f64>().unwrap_or_default())
}

/// Converts numbers to an array, each by [`number`].
pub(crate) fn numbers(xs: &[f32]) -> Value {
    xs.iter().map(|&x| number(x)).collect()
}

/// Converts to text for people: short values stay on one line.
pub(crate) fn to_text(value: &Value) -> String {
    let mut out = String::new();
    write_value(value, 0, &mut out);
    out.push('\n');
    out
}

fn write_value(value: &Value, indent: usize, out: &mut String) {
    const WIDTH: usize = 100;
    let start = out.rfind('\n').map_or(0, |i| i + 1);
    let flat = one_line(value);
    if out.len() - start + flat.len() <= WIDTH {
        out.push_str(&flat);
        return;
    }
    let (open, close, entries): (_, _, Vec<(Option<&String>, &Value)>) = match value {
        Value::Array(items) => ('[', ']', items.iter().map(|v| (None, v)).collect()),
        Value::Object(map) => ('{', '}', map.iter().map(|(k, v)| (Some(k), v)).collect()),
        _ => return out.push_str(&flat),
    };
    out.push(open);
    for (i, (key, value)) in entries.into_iter().enumerate() {
        out.push_str(if i == 0 { "\n" } else { ",\n" });
        out.push_str(&"  ".repeat(indent + 1));
        if let Some(key) = key {
            out.push_str(&format!("{}: ", Value::from(key.as_str())));
        }
        write_value(value, indent + 1, out);
    }
    out.push('\n');
    out.push_str(&"  ".repeat(indent));
    out.push(close);
}

/// Converts to compact JSON with spaces after commas and colons. Whole numbers lose their `.0`.
fn one_line(value: &Value) -> String {
    let join = |parts: Vec<String>| parts.join(", ");
    match value {
        Value::Array(items) => format!("[{}]", join(items.iter().map(one_line).collect())),
        Value::Object(map) if map.is_empty() => "{}".into(),
        Value::Object(map) => {
            let entry = |(key, value): (&String, &Value)| {
                format!("{}: {}", Value::from(key.as_str()), one_line(value))
            };
            format!("{{ {} }}", join(map.iter().map(entry).collect()))
        }
        Value::Number(n) => {
            let text = n.to_string();
            text.strip_suffix(".0").map_or_else(|| text.clone(), str::to_owned)
        }
        _ => value.to_string(),
    }
}

/// Checks the header of every Sinew file: `{"sinew": kind, "version": version, …}`.
pub(crate) fn check_header(root: At<'_>, kind: &str, version: usize) -> Result<()> {
    let kind_at = root.need("sinew")?;
    let found = kind_at.str()?;
    if found != kind {
        return Err(kind_at.malformed(format!("this is a {} file, not a `{kind}`", quoted(found))));
    }
    check_version(root, version)
}

/// Checks the `version` of an object that Sinew defines.
pub(crate) fn check_version(root: At<'_>, version: usize) -> Result<()> {
    let version_at = root.need("version")?;
    match version_at.usize()? {
        0 => Err(version_at.malformed("versions count from 1")),
        found if found > version => {
            Err(version_at
                .unsupported(format!("version {found} is newer than {version}, the last one known")))
        }
        _ => Ok(()),
    }
}
