//! This crate's error: the problem, the file and the place in it.

use core::fmt;

/// Kind of trouble that a file is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The operating system refused to read or write.
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
    /// Sort of trouble.
    pub kind: ErrorKind,
    /// Name of the file as the user gave it, or `""` for bytes without a name.
    pub file: String,
    /// One-line description of the problem.
    pub what: String,
    /// Place in the file: a JSON path (`nodes[3].children`), a byte offset, a line; or `""`.
    pub where_: String,
}

/// Shorthand of this crate.
pub type Result<T, E = Error> = core::result::Result<T, E>;

impl Error {
    /// An error of the operating system. `what` is one line.
    pub fn io(what: impl Into<String>) -> Self {
        Self { kind: ErrorKind::Io, file: String::new(), what: what.into(), where_: String::new() }
    }

    /// Invalid bytes at `place`.
    pub fn malformed(what: impl Into<String>, place: impl Into<String>) -> Self {
        Self { kind: ErrorKind::Malformed, file: String::new(), what: what.into(), where_: place.into() }
    }

    /// The file needs an unsupported feature at `place`.
    pub fn unsupported(what: impl Into<String>, place: impl Into<String>) -> Self {
        Self { kind: ErrorKind::Unsupported, file: String::new(), what: what.into(), where_: place.into() }
    }

    /// The same error with the name of its file, unless it has one already.
    #[must_use]
    pub fn with_file(mut self, file: impl Into<String>) -> Self {
        if self.file.is_empty() {
            self.file = file.into();
        }
        self
    }
}

/// Text from a file made fit for a message: a single line of limited length.
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
