//! The one error of this crate: what is wrong, in which file, and where in it.

use core::fmt;

/// Kind of trouble that a file is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The operating system refused to read or write.
    Io,
    /// The bytes break the rules of their format.
    Malformed,
    /// A valid file that asks for something this crate does not do.
    Unsupported,
}

/// Why a file could not be read or written. Displays as `FILE: what is wrong (where)`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{what}{}", Prefix(.file), Suffix(.where_))]
pub struct Error {
    /// Sort of trouble.
    pub kind: ErrorKind,
    /// Name of the file as the user gave it, or `""` when only bytes are known.
    pub file: String,
    /// Description of what is wrong, one line.
    pub what: String,
    /// Place in the file: a JSON path (`nodes[3].children`), a byte offset, a line; or `""`.
    pub where_: String,
}

/// Shorthand of this crate.
pub type Result<T, E = Error> = core::result::Result<T, E>;

impl Error {
    /// The operating system refused. `what` is one line.
    pub fn io(what: impl Into<String>) -> Self {
        Self { kind: ErrorKind::Io, file: String::new(), what: what.into(), where_: String::new() }
    }

    /// The bytes are wrong at `place`.
    pub fn malformed(what: impl Into<String>, place: impl Into<String>) -> Self {
        Self { kind: ErrorKind::Malformed, file: String::new(), what: what.into(), where_: place.into() }
    }

    /// The file asks at `place` for what is not supported.
    pub fn unsupported(what: impl Into<String>, place: impl Into<String>) -> Self {
        Self { kind: ErrorKind::Unsupported, file: String::new(), what: what.into(), where_: place.into() }
    }

    /// The same error, naming the file it was found in, unless it names one already.
    #[must_use]
    pub fn with_file(mut self, file: impl Into<String>) -> Self {
        if self.file.is_empty() {
            self.file = file.into();
        }
        self
    }
}

/// Text from a file, fit for a message: on one line, and not longer than a line.
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
