//! The text object format: class declarations, then objects as the values of their members, one per line.
//!
//! ```text
//! TOS 1.00
//! declare CLASS COUNT          then COUNT lines `  NAME TYPE`
//! object CLASS ID              then a line for each number, word or vector, in the order of the declaration
//! ```
//! A member of type `instance` is either an inline object, whose lines are indented further, or the id of another
//! object: eight hexadecimal digits, 0 for none. An array starts with its length.

use crate::error::{Error, Result, quoted};
use sinew_math::{Rotation, Vec3};
use std::collections::BTreeMap;

/// Indentation of the elements of an array relative to the array, in characters.
const STEP: usize = 2;
/// Deepest nesting of objects.
const DEEPEST: usize = 16;

/// Type of a member.
#[derive(Clone, Debug, PartialEq)]
enum Kind {
    /// This many numbers on a line.
    Numbers(usize),
    /// A number or a truth value.
    Word,
    Text,
    Instance(String),
    Array(Box<Kind>),
}

#[derive(Clone, Debug, PartialEq)]
enum Value {
    Word(String),
    Text(String),
    Numbers(Vec<f32>),
    Id(u32),
    List(Vec<At>),
    Object(Object),
}

/// A value and the number of its first line.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct At {
    line: usize,
    value: Value,
}

/// Members of an object, by name.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Object {
    pub class: String,
    pub line: usize,
    members: BTreeMap<String, At>,
}

/// All objects of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct Objects {
    by_id: BTreeMap<u32, Object>,
}

fn place(line: usize) -> String {
    format!("line {line}")
}

impl Objects {
    /// Reads a file.
    pub fn read(bytes: &[u8]) -> Result<Self> {
        let text = core::str::from_utf8(bytes)
            .map_err(|error| Error::malformed("not UTF-8 text", format!("byte {}", error.valid_up_to())))?;
        let mut lines = Lines::new(text);
        let (first, line) = lines.next()?;
        if !line.starts_with("TOS ") {
            return Err(Error::malformed("not a text object file: does not begin with `TOS`", place(first)));
        }
        let mut classes = BTreeMap::new();
        let mut objects = Self::default();
        while let Some((number, line)) = lines.next_or_end() {
            let words: Vec<&str> = line.split_whitespace().collect();
            match words[..] {
                ["declare", name, count] => {
                    let members = declaration(&mut lines, number, count)?;
                    classes.insert(name.to_owned(), members);
                }
                ["object", class, id] => {
                    let id = identifier(id)
                        .ok_or_else(|| Error::malformed("an object without a number", place(number)))?;
                    let mut reader = Values { lines: &mut lines, classes: &classes };
                    let object = reader.object(class, number, STEP, DEEPEST)?;
                    if objects.by_id.insert(id, object).is_some() {
                        return Err(Error::malformed("a second object of the same number", place(number)));
                    }
                }
                _ => {
                    let what = format!("neither a declaration nor an object: {}", quoted(line.trim()));
                    return Err(Error::malformed(what, place(number)));
                }
            }
        }
        Ok(objects)
    }

    /// Returns the object of a class with the smallest id.
    pub fn of_class(&self, class: &str) -> Option<&Object> {
        self.by_id.values().find(|object| object.class == class)
    }

    /// Returns the object that a member references or contains; `None` if it references none.
    pub fn follow<'a>(&'a self, at: &'a At) -> Result<Option<&'a Object>> {
        match &at.value {
            Value::Object(object) => Ok(Some(object)),
            Value::Id(0) => Ok(None),
            Value::Id(id) => match self.by_id.get(id) {
                Some(object) => Ok(Some(object)),
                None => Err(at.malformed(format!("names object {id:08X}, which does not exist"))),
            },
            _ => Err(at.malformed("not an object")),
        }
    }

    /// Returns the object that a member references or contains; fails if there is none.
    pub fn need<'a>(&'a self, at: &'a At) -> Result<&'a Object> {
        self.follow(at)?.ok_or_else(|| at.malformed("names no object"))
    }
}

impl Object {
    /// Returns a required member.
    pub fn member(&self, name: &str) -> Result<&At> {
        self.members
            .get(name)
            .ok_or_else(|| self.malformed(format!("a {} without {}", quoted(&self.class), quoted(name))))
    }

    /// Returns a member that newer or older files may lack.
    pub fn get(&self, name: &str) -> Option<&At> {
        self.members.get(name)
    }

    pub fn malformed(&self, what: impl Into<String>) -> Error {
        Error::malformed(what, place(self.line))
    }

    pub fn unsupported(&self, what: impl Into<String>) -> Error {
        Error::unsupported(what, place(self.line))
    }
}

impl At {
    pub fn malformed(&self, what: impl Into<String>) -> Error {
        Error::malformed(what, place(self.line))
    }

    /// Returns the value as an inline object.
    pub fn object(&self) -> Option<&Object> {
        match &self.value {
            Value::Object(object) => Some(object),
            _ => None,
        }
    }

    /// Returns the value as a finite number.
    pub fn number(&self) -> Result<f32> {
        let Value::Word(word) = &self.value else { return Err(self.malformed("not a number")) };
        match word.parse::<f32>() {
            Ok(x) if x.is_finite() => Ok(x),
            _ => Err(self.malformed(format!("{} is not a finite number", quoted(word)))),
        }
    }

    /// Returns the value as a whole number.
    pub fn count(&self) -> Result<u32> {
        let Value::Word(word) = &self.value else { return Err(self.malformed("not a number")) };
        word.parse().map_err(|_| self.malformed(format!("{} is not a whole number", quoted(word))))
    }

    pub fn text(&self) -> Result<&str> {
        match &self.value {
            Value::Text(text) => Ok(text),
            _ => Err(self.malformed("not a text")),
        }
    }

    pub fn vec3(&self) -> Result<Vec3> {
        match &self.value {
            Value::Numbers(n) if n.len() == 3 => Ok(Vec3::new(n[0], n[1], n[2])),
            _ => Err(self.malformed("not a vector")),
        }
    }

    /// Returns the value as a rotation from a unit quaternion, x y z w; normalised on reading.
    pub fn rotation(&self) -> Result<Rotation> {
        match &self.value {
            Value::Numbers(n) if n.len() == 4 => {
                let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2] + n[3] * n[3]).sqrt();
                if !(0.5..2.0).contains(&length) {
                    return Err(self.malformed("a quaternion far from unit length"));
                }
                Ok(Rotation::from_xyzw(n[0], n[1], n[2], n[3]).normalize())
            }
            _ => Err(self.malformed("not a quaternion")),
        }
    }

    pub fn list(&self) -> Result<&[Self]> {
        match &self.value {
            Value::List(list) => Ok(list),
            _ => Err(self.malformed("not an array")),
        }
    }
}

/// Parses an id: eight hexadecimal digits.
fn identifier(word: &str) -> Option<u32> {
    (word.len() == 8).then(|| u32::from_str_radix(word, 16).ok()).flatten()
}

fn declaration(lines: &mut Lines<'_>, number: usize, count: &str) -> Result<Vec<(String, Kind)>> {
    let count: usize =
        count.parse().map_err(|_| Error::malformed("a class without a number of members", place(number)))?;
    let mut members = Vec::new();
    for _ in 0..count {
        let (number, line) = lines.next()?;
        let mut words = line.split_whitespace();
        let name = words.next().unwrap_or_default().to_owned();
        members.push((name, kind(&mut words, number)?));
    }
    Ok(members)
}

fn kind<'a>(words: &mut impl Iterator<Item = &'a str>, number: usize) -> Result<Kind> {
    let mut arrays = 0;
    let mut inner = loop {
        match words.next() {
            Some("array") if arrays < DEEPEST => arrays += 1,
            Some("vec3" | "double3") => break Kind::Numbers(3),
            Some("vec4" | "quat") => break Kind::Numbers(4),
            Some("mat44" | "dmat44") => break Kind::Numbers(16),
            Some("float" | "double" | "bool" | "int" | "uint8" | "uint16" | "uint32" | "uint64") => {
                break Kind::Word;
            }
            Some("string") => break Kind::Text,
            Some("instance" | "pointer") => {
                break Kind::Instance(words.next().unwrap_or_default().to_owned());
            }
            other => {
                let what = format!("unknown type {} of a member", quoted(other.unwrap_or_default()));
                return Err(Error::unsupported(what, place(number)));
            }
        }
    };
    for _ in 0..arrays {
        inner = Kind::Array(Box::new(inner));
    }
    Ok(inner)
}

/// Reads values by their kinds.
struct Values<'a, 'b> {
    lines: &'a mut Lines<'b>,
    classes: &'a BTreeMap<String, Vec<(String, Kind)>>,
}

impl Values<'_, '_> {
    /// Reads the members of an object, whose lines have indentation `level`.
    fn object(&mut self, class: &str, line: usize, level: usize, depth: usize) -> Result<Object> {
        let Some(members) = self.classes.get(class) else {
            let what = format!("an object of class {}, which is not declared before", quoted(class));
            return Err(Error::malformed(what, place(line)));
        };
        if depth == 0 {
            return Err(Error::unsupported("objects nested deeper than 16", place(line)));
        }
        let mut object = Object { class: class.to_owned(), line, members: BTreeMap::new() };
        for (name, kind) in members {
            let value = self.value(kind, level, depth)?;
            object.members.insert(name.clone(), value);
        }
        Ok(object)
    }

    fn value(&mut self, kind: &Kind, level: usize, depth: usize) -> Result<At> {
        let line = self.lines.ahead()?.0;
        let value = match kind {
            Kind::Word => Value::Word(self.word()?),
            Kind::Text => {
                let (number, line) = self.lines.next()?;
                let text = line.trim().strip_prefix('"').and_then(|text| text.strip_suffix('"'));
                let text = text.ok_or_else(|| Error::malformed("a text without quotes", place(number)))?;
                Value::Text(text.to_owned())
            }
            Kind::Numbers(count) => Value::Numbers(self.numbers(*count)?),
            Kind::Array(inner) => self.array(inner, level, depth)?,
            Kind::Instance(class) => {
                if self.lines.indent() > level {
                    let level = self.lines.indent();
                    Value::Object(self.object(class, line, level, depth - 1)?)
                } else {
                    let word = self.word()?;
                    let id = identifier(&word).ok_or_else(|| {
                        Error::malformed(
                            format!("{} is not the number of an object", quoted(&word)),
                            place(line),
                        )
                    })?;
                    Value::Id(id)
                }
            }
        };
        Ok(At { line, value })
    }

    fn array(&mut self, inner: &Kind, level: usize, depth: usize) -> Result<Value> {
        let (number, _) = self.lines.ahead()?;
        let word = self.word()?;
        let count: usize = word.parse().map_err(|_| {
            Error::malformed(format!("{} is not the length of an array", quoted(&word)), place(number))
        })?;
        let mut list = Vec::new();
        for _ in 0..count {
            let before = self.lines.line;
            list.push(self.value(inner, level + STEP, depth)?);
            if self.lines.line == before {
                // Without this check, a file of a few bytes could make the reader allocate any amount of memory.
                return Err(Error::malformed("elements of an array without a line", place(number)));
            }
        }
        Ok(Value::List(list))
    }

    fn word(&mut self) -> Result<String> {
        Ok(self.lines.next()?.1.trim().to_owned())
    }

    fn numbers(&mut self, count: usize) -> Result<Vec<f32>> {
        let (line, text) = self.lines.next()?;
        let numbers: Vec<f32> = text
            .split_whitespace()
            .map(|word| word.parse::<f32>().ok().filter(|x| x.is_finite()))
            .collect::<Option<_>>()
            .ok_or_else(|| Error::malformed("a line without a finite number", place(line)))?;
        if numbers.len() != count {
            return Err(Error::malformed(format!("{} numbers, not {count}", numbers.len()), place(line)));
        }
        Ok(numbers)
    }
}

/// Iterator over lines that are not empty.
struct Lines<'a> {
    all: core::iter::Enumerate<core::str::Lines<'a>>,
    ahead: Option<(usize, &'a str)>,
    /// Number of the last line read.
    line: usize,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str) -> Self {
        let mut lines = Self { all: text.lines().enumerate(), ahead: None, line: 0 };
        lines.look();
        lines
    }

    fn look(&mut self) {
        self.ahead = self.all.find(|(_, line)| !line.trim().is_empty()).map(|(i, line)| (i + 1, line));
    }

    /// Indentation of the next line, in bytes.
    fn indent(&self) -> usize {
        self.ahead.map_or(0, |(_, line)| line.len() - line.trim_start().len())
    }

    fn ahead(&self) -> Result<(usize, &'a str)> {
        self.ahead.ok_or_else(|| Error::malformed("the file ends within an object", place(self.line)))
    }

    fn next(&mut self) -> Result<(usize, &'a str)> {
        let next = self.ahead()?;
        self.line = next.0;
        self.look();
        Ok(next)
    }

    fn next_or_end(&mut self) -> Option<(usize, &'a str)> {
        self.next().ok()
    }
}
