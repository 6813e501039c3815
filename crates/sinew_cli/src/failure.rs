//! Errors of commands.

use crate::report::Report;
use serde_json::{Value, json};
use std::fmt;
use std::process::ExitCode;

/// Result of a command, whose error is a [`Failure`].
pub type Result<T, E = Failure> = std::result::Result<T, E>;

/// Error of a command; displays as one line.
#[derive(Debug)]
pub enum Failure {
    /// An error in a file or in processing it. Exit code 1.
    File(sinew::formats::Error),
    /// Invalid use of the program. Exit code 2.
    Usage(String),
    /// The work was done, and its result misses an expectation; the report is still printed. Exit code 1.
    Missed {
        /// Report of the work.
        report: Box<Report>,
        /// Line that describes the miss.
        what: String,
    },
}

impl Failure {
    /// Creates an error in a file without a position.
    pub fn of_file(file: impl Into<String>, what: impl fmt::Display) -> Self {
        Self::File(sinew::formats::Error::unsupported(what.to_string(), "").with_file(file))
    }

    /// Creates an error at a position in a file.
    pub fn at(file: impl Into<String>, what: impl fmt::Display, place: impl Into<String>) -> Self {
        Self::File(sinew::formats::Error::unsupported(what.to_string(), place).with_file(file))
    }

    /// Returns the exit code of the process.
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::File(_) | Self::Missed { .. } => 1,
            Self::Usage(_) => 2,
        })
    }

    /// Returns the JSON of `--json`: the file, the problem, and its position; `None` for usage errors.
    pub fn to_json(&self) -> Option<Value> {
        match self {
            Self::File(error) => {
                Some(json!({"error": {"file": error.file, "what": error.what, "where": error.where_}}))
            }
            Self::Usage(_) | Self::Missed { .. } => None,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = match self {
            Self::File(error) => error.to_string(),
            Self::Usage(what) | Self::Missed { what, .. } => what.clone(),
        };
        // The system's error number repeats its text.
        let line = match line.find(" (os error ") {
            Some(at) => line[..at].to_owned() + line[at..].split_once(')').map_or("", |(_, rest)| rest),
            None => line,
        };
        // Names come from files: a line feed in a name must not split this line.
        line.chars().try_for_each(|c| {
            if c.is_control() { write!(f, "{}", c.escape_default()) } else { write!(f, "{c}") }
        })
    }
}

impl From<sinew::formats::Error> for Failure {
    fn from(error: sinew::formats::Error) -> Self {
        Self::File(error)
    }
}
