//! Error of this crate: the problem, the file, and the location in the file.

use core::fmt;

/// Kind of an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The operating system rejected reading or writing.
    Io,
    /// The bytes break the rules of their format.
    Malformed,
    /// A valid file that uses an unsupported feature.
    Unsupported,
}

/// Error of reading or writing a file. Displays as `FILE: what is wrong (where)`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{what}{}", Prefix(.file), Suffix(.where_))]
pub struct Error {
    /// Kind of the error.
    pub kind: ErrorKind,
    /// Name of the file as given by the user, or `""` for bytes without a name.
    pub file: String,
    /// One-line description of the problem.
    pub what: String,
    /// Place in the file: a JSON path (`nodes[3].children`), a byte offset, a line; or `""`.
    pub where_: String,
}

/// Result with this crate's error.
pub type Result<T, E = Error> = core::result::Result<T, E>;

impl Error {
    /// Creates an error of the operating system. `what` is a description in one line.
    pub fn io(what: impl Into<String>) -> Self {
        Self { kind: ErrorKind::Io, file: String::new(), what: what.into(), where_: String::new() }
    }

    /// Creates an error for invalid bytes at `place`.
    pub fn malformed(what: impl Into<String>, place: impl Into<String>) -> Self {
        Self { kind: ErrorKind::Malformed, file: String::new(), what: what.into(), where_: place.into() }
    }

    /// Creates an error for an unsupported feature at `place`.
    pub fn unsupported(what: impl Into<String>, place: impl Into<String>) -> Self {
        Self { kind: ErrorKind::Unsupported, file: String::new(), what: what.into(), where_: place.into() }
    }

    /// Adds the name of the file, unless the error already has one.
    #[must_use]
    pub fn with_file(mut self, file: impl Into<String>) -> Self {
        if self.file.is_empty() {
            self.file = file.into();
        }
        self
    }
}

/// Shortens text from a file to a single line of limited length for a message.
pub(crate) fn quoted(text: &str) -> String {
    const LONGEST: usize = 60;
    let mut out: String = text.chars().take(LONGEST).flat_map(char::escape_debug).collect();
    if text.chars().nth(LONGEST).is_some() {
        out.push('…');
    }
    format!("`{out}`")
}

struct Prefix<'a>(&'a str);

impl fmt::Display for Prefix<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() { Ok(()) } else { write!(f, "{}: ", self.0) }
    }
}

struct Suffix<'a>(&'a str);

impl fmt::Display for Suffix<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() { Ok(()) } else { write!(f, " ({})", self.0) }
    }
}
