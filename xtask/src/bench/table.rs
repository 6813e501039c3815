//! Aligned tables in Markdown, which are readable in a terminal and a diff, too.

use std::fmt;

/// A table; its first row is the heading. Text is aligned left, numbers right.
pub struct Table {
    /// Number of text columns, which are the first ones.
    words: usize,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Returns a table with a heading and no rows; the first `words` columns are text.
    pub fn new<S: Into<String>>(words: usize, heading: impl IntoIterator<Item = S>) -> Self {
        Self { words, rows: vec![heading.into_iter().map(Into::into).collect()] }
    }

    /// Adds a row.
    ///
    /// # Panics
    /// If the row is not as wide as the heading.
    pub fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) {
        let row: Vec<String> = cells.into_iter().map(Into::into).collect();
        assert_eq!(row.len(), self.rows[0].len(), "a row must have as many cells as the heading: {row:?}");
        self.rows.push(row);
    }

    fn is_text(&self, column: usize) -> bool {
        column < self.words
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width =
            |column: usize| self.rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.rows[0].len()).map(width).collect();
        for (number, row) in self.rows.iter().enumerate() {
            for (column, (cell, width)) in row.iter().zip(&widths).enumerate() {
                match self.is_text(column) {
                    true => write!(f, "| {cell:<width$} ")?,
                    false => write!(f, "| {cell:>width$} ")?,
                }
            }
            writeln!(f, "|")?;
            if number == 0 {
                for (column, width) in widths.iter().enumerate() {
                    let end = if self.is_text(column) { '-' } else { ':' };
                    write!(f, "|{}{end}", "-".repeat(width + 1))?;
                }
                writeln!(f, "|")?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned() {
        let mut table = Table::new(1, ["scene", "ms"]);
        table.row(["pile", "7.1"]);
        table.row(["a wall", "12.25"]);
        assert_eq!(
            table.to_string(),
            "| scene  |    ms |\n|--------|------:|\n| pile   |   7.1 |\n| a wall | 12.25 |\n"
        );
    }
}
