//! Splits a text into words with line numbers.

use crate::error::{Error, Result, quoted};

/// Reads a text word by word; braces are separate words.
pub(super) struct Words<'a> {
    lines: core::str::Split<'a, char>,
    rest: &'a str,
    line: usize,
}

impl<'a> Words<'a> {
    /// Starts at the first word. Lines of old files end with a lone carriage return.
    pub fn new(text: &'a str) -> Self {
        let end = if text.contains('\n') { '\n' } else { '\r' };
        Self { lines: text.strip_suffix(end).unwrap_or(text).split(end), rest: "", line: 0 }
    }

    /// Line of the last word, counted from 1.
    pub fn place(&self) -> String {
        format!("line {}", self.line)
    }

    /// Returns the next non-empty line and its number. Skips the rest of the current line.
    pub fn next_line(&mut self) -> Option<(usize, &'a str)> {
        loop {
            let line = self.lines.next()?.trim();
            self.line += 1;
            self.rest = "";
            if !line.is_empty() {
                return Some((self.line, line));
            }
        }
    }

    /// Returns the next word, on any line; `None` at the end of the text.
    pub fn next(&mut self) -> Option<&'a str> {
        while self.rest.is_empty() {
            let (_, line) = self.next_line()?;
            self.rest = line;
        }
        let end = match self.rest.as_bytes()[0] {
            b'{' | b'}' => 1,
            _ => self
                .rest
                .find(|c: char| c.is_whitespace() || matches!(c, '{' | '}'))
                .unwrap_or(self.rest.len()),
        };
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest.trim_start();
        Some(word)
    }

    /// Returns the rest of the line, up to a brace; names may contain blanks.
    pub fn rest_of_line(&mut self) -> &'a str {
        let end = self.rest.find(['{', '}']).unwrap_or(self.rest.len());
        let (name, rest) = self.rest.split_at(end);
        self.rest = rest;
        name.trim()
    }

    /// Returns the next word, or an error that names `expected`.
    pub fn need(&mut self, expected: &str) -> Result<&'a str> {
        self.next().ok_or_else(|| {
            Error::malformed(format!("expected {expected}, found the end of the file"), self.place())
        })
    }

    /// Reads the next word, which must equal `expected`, ignoring case.
    pub fn expect(&mut self, expected: &str) -> Result<()> {
        let word = self.need(&format!("`{expected}`"))?;
        if word.eq_ignore_ascii_case(expected) {
            return Ok(());
        }
        Err(Error::malformed(format!("expected `{expected}`, found {}", quoted(word)), self.place()))
    }

    /// Reads the next word as a finite number. `what` names the number in the error.
    pub fn number(&mut self, what: &str) -> Result<f64> {
        let word = self.need(what)?;
        parse_number(word).map_err(|wrong| Error::malformed(format!("{what}: {wrong}"), self.place()))
    }
}

/// Parses a number that is finite as `f32`; else returns an error text.
pub(super) fn parse_number(word: &str) -> Result<f64, String> {
    let number: f64 = word.parse().map_err(|_| format!("{} is not a number", quoted(word)))?;
    if (number as f32).is_finite() { Ok(number) } else { Err(format!("{} is not finite", quoted(word))) }
}
