//! Elements and attributes of an XML text, with their locations for errors.

use crate::error::{Error, Result, quoted};
use roxmltree::{Attribute, Document, Node};

/// An element. Has the lifetime of the document and of its text.
pub(crate) type Element<'a> = Node<'a, 'a>;

/// Largest text that is read, bytes. Models without meshes are far smaller; the XML parser needs about 20 times as much
/// memory.
const MOST_BYTES: usize = 4 << 20;
/// Largest number of attributes per element, because the XML parser compares every pair.
const MOST_ATTRIBUTES: usize = 1000;
/// Largest number that is read; keeps sums and squares finite.
const LARGEST: f32 = 1e9;

/// Parses bytes as XML.
pub(crate) fn parse(bytes: &[u8]) -> Result<Document<'_>> {
    if bytes.len() > MOST_BYTES {
        let what = format!("{} bytes are more than the {MOST_BYTES} that are read", bytes.len());
        return Err(Error::unsupported(what, "top level"));
    }
    let text = core::str::from_utf8(bytes)
        .map_err(|e| Error::malformed("not UTF-8", format!("byte {}", e.valid_up_to())))?;
    if let Some(at) = text.find("xmlns") {
        return Err(Error::unsupported("XML namespaces are not read", line_of(text, at)));
    }
    // A tag contains no `<`, so the text between two `<` has at most one tag.
    for tag in text.split('<') {
        let quotes = tag.bytes().filter(|byte| matches!(byte, b'"' | b'\'')).count();
        if quotes > 2 * MOST_ATTRIBUTES {
            let at = tag.as_ptr() as usize - text.as_ptr() as usize;
            let what = format!("more than {MOST_ATTRIBUTES} attributes");
            return Err(Error::unsupported(what, line_of(text, at)));
        }
    }
    Document::parse(text).map_err(|e| {
        let pos = e.pos();
        let said = e.to_string();
        let what = said.split(" at ").next().unwrap_or_default();
        Error::malformed(format!("not XML: {}", one_line(what)), position(pos.row, pos.col))
    })
}

/// Converts another parser's message, which may quote the text, to one line of limited length.
fn one_line(text: &str) -> String {
    text.chars().take(120).map(|c| if c.is_control() { ' ' } else { c }).collect()
}

fn line_of(text: &str, at: usize) -> String {
    format!("line {}", text[..at].bytes().filter(|&byte| byte == b'\n').count() + 1)
}

fn position(row: u32, column: u32) -> String {
    format!("line {row} column {column}")
}

/// Returns line and column of an element.
pub(crate) fn place(element: Element<'_>) -> String {
    place_at(element, element.range().start)
}

fn place_at(element: Element<'_>, byte: usize) -> String {
    let pos = element.document().text_pos_at(byte);
    position(pos.row, pos.col)
}

/// Iterates over the child elements, with their tags.
pub(crate) fn children<'a>(element: Element<'a>) -> impl DoubleEndedIterator<Item = (&'a str, Element<'a>)> {
    element.children().filter(Element::is_element).map(|child| (child.tag_name().name(), child))
}

/// Creates an error: the element breaks the rules of its format.
pub(crate) fn malformed(element: Element<'_>, what: impl Into<String>) -> Error {
    Error::malformed(what, place(element))
}

/// Creates an error: the element uses an unsupported feature.
pub(crate) fn unsupported(element: Element<'_>, what: impl Into<String>) -> Error {
    Error::unsupported(what, place(element))
}

/// An attribute with its element.
#[derive(Clone, Copy)]
pub(crate) struct Value<'a> {
    element: Element<'a>,
    attribute: Attribute<'a, 'a>,
}

impl<'a> Value<'a> {
    pub fn new(element: Element<'a>, attribute: Attribute<'a, 'a>) -> Self {
        Self { element, attribute }
    }

    /// Returns the attribute of that name, if the element has it.
    pub fn of(element: Element<'a>, key: &str) -> Option<Self> {
        element.attribute_node(key).map(|attribute| Self { element, attribute })
    }

    pub fn key(self) -> &'a str {
        self.attribute.name()
    }

    pub fn text(self) -> &'a str {
        self.attribute.value()
    }

    pub fn malformed(self, what: impl core::fmt::Display) -> Error {
        Error::malformed(format!("`{}`: {what}", self.key()), self.place())
    }

    pub fn unsupported(self, what: impl core::fmt::Display) -> Error {
        Error::unsupported(format!("`{}`: {what}", self.key()), self.place())
    }

    fn place(self) -> String {
        place_at(self.element, self.attribute.range().start)
    }

    /// Parses any number of numbers, separated by white space.
    pub fn list(self) -> Result<Vec<f32>> {
        self.text().split_ascii_whitespace().map(|word| self.parse(word)).collect()
    }

    /// Parses exactly `N` numbers.
    pub fn numbers<const N: usize>(self) -> Result<[f32; N]> {
        let list = self.list()?;
        let count = list.len();
        list.try_into().map_err(|_| self.malformed(format!("takes {N} numbers, not {count}")))
    }

    /// Parses one number.
    pub fn number(self) -> Result<f32> {
        Ok(self.numbers::<1>()?[0])
    }

    /// Parses one number, 0 or more.
    pub fn not_negative(self) -> Result<f32> {
        let number = self.number()?;
        if number < 0.0 { Err(self.malformed("must not be negative")) } else { Ok(number) }
    }

    /// Returns the meaning of the word, which must be one of `meanings`.
    pub fn word<T: Copy>(self, meanings: &[(&str, T)]) -> Result<T> {
        let found = meanings.iter().find(|(word, _)| *word == self.text());
        found.map(|&(_, meaning)| meaning).ok_or_else(|| {
            let words: Vec<_> = meanings.iter().map(|(word, _)| *word).collect();
            self.malformed(format!("{} is none of {}", quoted(self.text()), words.join(", ")))
        })
    }

    fn parse(self, word: &str) -> Result<f32> {
        let number: f32 =
            word.parse().map_err(|_| self.malformed(format!("{} is no number", quoted(word))))?;
        if (-LARGEST..=LARGEST).contains(&number) {
            Ok(number)
        } else {
            Err(self.malformed(format!("{} is not within ±{LARGEST:e}", quoted(word))))
        }
    }
}
