//! Error for a definition with invalid numbers.

/// Error for an invalid definition, shape or setting: the reason why its first invalid number is rejected. The text is
/// one line in lower case without a full stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DefError {
    what: &'static str,
}

impl DefError {
    /// Creates an error from the reason, in lower case: "a radius must be positive and finite".
    pub const fn new(what: &'static str) -> Self {
        Self { what }
    }

    /// Returns the reason, in lower case.
    pub const fn what(&self) -> &'static str {
        self.what
    }
}

impl core::fmt::Display for DefError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.what)
    }
}

impl core::error::Error for DefError {}
