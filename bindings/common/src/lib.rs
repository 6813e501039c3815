//! Code shared by the bindings to C and Python: files by name, characters with motions, random falls.
#![forbid(unsafe_code)]

mod character_file;
mod panics;
mod random_fall;

pub use character_file::{CharacterFile, Corrections, Motions, Wishes, embedded, load_ragdoll};
pub use panics::caught;
pub use random_fall::{FallOptions, RandomFall, random_fall};

/// Error of a call: one line that names the file and the position.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// True if a file could not be read or written, or is invalid; false if an argument is wrong.
    pub is_of_file: bool,
    /// Description of what is wrong.
    pub what: String,
}

impl Failure {
    /// Makes an error for an invalid argument.
    pub fn argument(what: impl Into<String>) -> Self {
        Self { is_of_file: false, what: what.into() }
    }

    /// Makes an error for a file, with its name.
    pub fn file(name: &str, what: impl core::fmt::Display) -> Self {
        Self { is_of_file: true, what: format!("{name}: {what}") }
    }
}

impl From<sinew::formats::Error> for Failure {
    fn from(error: sinew::formats::Error) -> Self {
        Self { is_of_file: true, what: error.to_string() }
    }
}
