//! Lines and rows of a sheet between its columns.

use sinew_math::{Vec3, max};

/// Line of particles from the seam to the hem: on a column, or between two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    /// Column to the left of the line, and the fraction of the distance to the next column, 0..1.
    pub column: usize,
    pub share: f32,
}

/// Grid of particles, line by line.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    pub lines: Vec<Line>,
    /// Number of columns.
    pub columns: usize,
    /// Number of steps from the seam to the hem.
    pub rows: usize,
    /// True if the last line is next to the first.
    pub closed: bool,
}

/// Largest number of lines between two columns, and of rows. If a spacing needs more lines, it was meant for a
/// character of another size.
const MOST_SPLITS: usize = 16;
const MOST_ROWS: usize = 64;

impl Grid {
    /// Creates a grid on columns (each a polyline from the seam to the hem, metres) whose neighbouring particles are at
    /// most `spacing` apart.
    pub fn new(columns: &[Vec<Vec3>], closed: bool, spacing: f32) -> Self {
        let parts = |length: f32, most: usize| ((length / spacing).ceil() as usize).clamp(1, most);
        let longest = columns.iter().map(|column| length(column)).fold(0.0, max);
        let rows = parts(longest, MOST_ROWS);
        let gaps = if closed { columns.len() } else { columns.len() - 1 };
        let mut lines = Vec::new();
        for column in 0..gaps {
            let next = &columns[(column + 1) % columns.len()];
            let apart = (0..=rows).map(|row| {
                let share = row as f32 / rows as f32;
                (along(&columns[column], share) - along(next, share)).length()
            });
            let splits = parts(apart.fold(0.0, max), MOST_SPLITS);
            lines.extend((0..splits).map(|k| Line { column, share: k as f32 / splits as f32 }));
        }
        if !closed {
            lines.push(Line { column: columns.len() - 1, share: 0.0 });
        }
        Self { lines, columns: columns.len(), rows, closed }
    }

    /// Returns the index of a particle.
    pub fn particle(&self, line: usize, row: usize) -> usize {
        line * (self.rows + 1) + row
    }

    /// Returns the lines next to a line: the one before and the one after. A line at an edge counts as its own
    /// neighbour.
    pub fn beside(&self, line: usize) -> [usize; 2] {
        let last = self.lines.len() - 1;
        if self.closed {
            [(line + last) % (last + 1), (line + 1) % (last + 1)]
        } else {
            [line.saturating_sub(1), usize::min(line + 1, last)]
        }
    }

    /// Returns the column nearest to a line.
    pub fn nearest_column(&self, line: usize) -> usize {
        let Line { column, share } = self.lines[line];
        if share < 0.5 { column } else { (column + 1) % self.columns }
    }

    /// Computes the positions of all particles on columns, each a polyline from the seam to the hem, metres.
    pub fn places(&self, columns: &[Vec<Vec3>], out: &mut Vec<Vec3>) {
        out.clear();
        for line in &self.lines {
            let next = &columns[(line.column + 1) % self.columns];
            for row in 0..=self.rows {
                let share = row as f32 / self.rows as f32;
                let here = along(&columns[line.column], share);
                out.push(if line.share == 0.0 {
                    here
                } else {
                    here + (along(next, share) - here) * line.share
                });
            }
        }
    }

    /// Returns the position on a line at a fraction of its length from seam to hem, for particles at `places`.
    pub fn on_line(&self, places: &[Vec3], line: usize, share: f32) -> Vec3 {
        let at = share * self.rows as f32;
        let row = usize::min(at as usize, self.rows - 1);
        let (upper, lower) = (places[self.particle(line, row)], places[self.particle(line, row + 1)]);
        upper + (lower - upper) * (at - row as f32)
    }
}

/// Returns the length of a polyline, metres.
pub(super) fn length(way: &[Vec3]) -> f32 {
    way.windows(2).map(|pair| (pair[1] - pair[0]).length()).sum()
}

/// Returns the position at a fraction of a polyline's length.
fn along(way: &[Vec3], share: f32) -> Vec3 {
    let mut left = share * length(way);
    for pair in way.windows(2) {
        let step = pair[1] - pair[0];
        let length = step.length();
        if left <= length && length > 0.0 {
            return pair[0] + step * (left / length);
        }
        left -= length;
    }
    way[way.len() - 1]
}
