//! Height fields as shapes: terrain over a grid.

use super::build::bends_down;
use super::triangle::{Triangle, bounds, closest_on_triangle, enter_triangle};
use super::{Closest, MAX_COORDINATE};
use crate::boxes::{Aabb, Overlap};
use core::fmt;
use core::ops::Range;
use sinew_math::{StableHasher, Vec3, clamp, max, min};

/// Definition of a height field.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HeightFieldDef {
    /// Number of vertices along x, at least 2.
    pub columns: usize,
    /// Number of vertices along z, at least 2.
    pub rows: usize,
    /// Distance between neighbours along x and along z, metres, > 0.
    pub spacing: [f32; 2],
    /// Heights, metres: `columns × rows` values, row by row. The vertex of column i and row j is at x = i × spacing.0
    /// and z = j × spacing.1.
    pub heights: Vec<f32>,
    /// Indices of cells without triangles: `column + row × (columns − 1)`.
    pub holes: Vec<u32>,
}

impl HeightFieldDef {
    /// Returns a field without holes: `columns` × `rows` vertices, `spacing` metres apart along x and z, with heights
    /// in metres, row by row.
    pub fn new(columns: usize, rows: usize, spacing: f32, heights: Vec<f32>) -> Self {
        Self { columns, rows, spacing: [spacing; 2], heights, holes: Vec::new() }
    }

    /// Like [`new`](Self::new), with heights (metres) from a function of column and row.
    pub fn from_fn(columns: usize, rows: usize, spacing: f32, height: impl Fn(usize, usize) -> f32) -> Self {
        let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        Self::new(columns, rows, spacing, cells.map(|(column, row)| height(column, row)).collect())
    }
}

/// Error returned when samples do not form a valid height field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeightFieldError {
    /// Fewer than 2 vertices along an axis, or more than 2²⁶ cells.
    Size,
    /// The number of heights differs from the number of vertices.
    Heights {
        /// Number of given heights.
        heights: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// A spacing is not positive and finite, or makes the field larger than [`MAX_COORDINATE`].
    Spacing,
    /// A height is not finite, or beyond [`MAX_COORDINATE`].
    NotFinite {
        /// Index of the height in the list.
        index: usize,
    },
    /// The index of a hole is out of range.
    Hole {
        /// Index of the cell.
        hole: u32,
        /// Number of cells.
        cells: usize,
    },
    /// All cells are holes.
    Empty,
}

impl fmt::Display for HeightFieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size => f.write_str("a height field has at least 2 × 2 vertices and at most 2²⁶ cells"),
            Self::Heights { heights, vertices } => {
                write!(f, "{heights} heights do not make {vertices} vertices")
            }
            Self::Spacing => {
                f.write_str("the spacing of a height field is positive, and its sides no longer than 10⁶ m")
            }
            Self::NotFinite { index } => write!(f, "height {index} is not finite or beyond 10⁶ m"),
            Self::Hole { hole, cells } => write!(f, "hole {hole} is not a cell: there are {cells}"),
            Self::Empty => f.write_str("all cells are holes"),
        }
    }
}

impl core::error::Error for HeightFieldError {}

/// Terrain: heights on a grid in x and z, solid from above. Each cell is two triangles, split from the corner at lower
/// x and higher z to the corner at higher x and lower z. Edges are active as in a [`Mesh`](super::Mesh).
#[derive(Clone, Debug)]
pub struct HeightField {
    def: HeightFieldDef,
    /// Bits of each cell: active edges of its first triangle in the lowest three bits, of its second triangle in the
    /// next three, and `HOLE`.
    cells: Vec<u8>,
    bounds: Aabb,
    hash: u64,
}

const HOLE: u8 = 1 << 7;
const MAX_CELLS: usize = 1 << 26;

impl HeightField {
    /// Creates the height field from its definition.
    ///
    /// # Errors
    /// If a number of the definition is invalid.
    pub fn new(mut def: HeightFieldDef) -> Result<Self, HeightFieldError> {
        check(&def)?;
        // The holes are sorted, so that their order in the definition does not matter.
        def.holes.sort_unstable();
        def.holes.dedup();
        let lowest = def.heights.iter().fold(f32::INFINITY, |y, &h| min(h, y));
        let highest = def.heights.iter().fold(f32::NEG_INFINITY, |y, &h| max(h, y));
        let [width, depth] = sides(&def);
        let bounds = Aabb { min: Vec3::new(0.0, lowest, 0.0), max: Vec3::new(width, highest, depth) };
        let mut cells = vec![0; (def.columns - 1) * (def.rows - 1)];
        for &hole in &def.holes {
            cells[hole as usize] = HOLE;
        }
        if cells.iter().all(|&cell| cell == HOLE) {
            return Err(HeightFieldError::Empty);
        }
        let hash = hash(&def, &cells);
        let mut field = Self { def, cells, bounds, hash };
        field.find_active_edges();
        Ok(field)
    }

    /// Returns the definition.
    pub fn def(&self) -> &HeightFieldDef {
        &self.def
    }

    /// Bounds in the field's own frame, metres.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Iterates over the corners of all triangles, counter-clockwise seen from above, cell by cell.
    pub fn triangles(&self) -> impl Iterator<Item = [Vec3; 3]> {
        let cells = (0..self.cells.len()).filter(|&cell| self.cells[cell] & HOLE == 0);
        cells.flat_map(|cell| [self.corners(2 * cell as u32), self.corners(2 * cell as u32 + 1)])
    }

    /// Hash of the content: equal for equal fields on every machine.
    pub fn content_hash(&self) -> u64 {
        self.hash
    }

    fn width(&self) -> usize {
        self.def.columns - 1
    }

    /// Returns column and row of each corner of a triangle.
    fn grid(&self, triangle: u32) -> [[usize; 2]; 3] {
        let cell = triangle as usize / 2;
        let (i, j) = (cell % self.width(), cell / self.width());
        if triangle.is_multiple_of(2) {
            [[i, j], [i, j + 1], [i + 1, j]]
        } else {
            [[i + 1, j], [i, j + 1], [i + 1, j + 1]]
        }
    }

    fn corners(&self, triangle: u32) -> [Vec3; 3] {
        let [width, depth] = self.def.spacing;
        self.grid(triangle).map(|[i, j]| {
            Vec3::new(i as f32 * width, self.def.heights[i + j * self.def.columns], j as f32 * depth)
        })
    }

    fn triangle(&self, number: u32) -> Triangle {
        let vertices = self.grid(number).map(|[i, j]| (i + j * self.def.columns) as u32);
        let active = self.cells[number as usize / 2] >> (3 * (number % 2)) & 7;
        Triangle::new(self.corners(number), vertices, active)
    }

    /// Returns the triangle beyond each edge of a triangle, if there is one.
    fn beyond(&self, triangle: u32) -> [Option<u32>; 3] {
        let cell = triangle as usize / 2;
        let (i, j) = (cell % self.width(), cell / self.width());
        let there = |inside: bool, cell: usize, half: u32| {
            let solid = inside && self.cells[cell] & HOLE == 0;
            solid.then(|| 2 * cell as u32 + half)
        };
        if triangle.is_multiple_of(2) {
            let left = there(i > 0, cell.wrapping_sub(1), 1);
            let back = there(j > 0, cell.wrapping_sub(self.width()), 1);
            [left, Some(triangle + 1), back]
        } else {
            let right = there(i + 1 < self.width(), cell + 1, 0);
            let front = there(j + 2 < self.def.rows, cell + self.width(), 0);
            [Some(triangle - 1), front, right]
        }
    }

    fn find_active_edges(&mut self) {
        for cell in 0..self.cells.len() {
            if self.cells[cell] & HOLE != 0 {
                continue;
            }
            for half in 0..2 {
                let triangle = 2 * cell as u32 + half;
                for (edge, beyond) in self.beyond(triangle).into_iter().enumerate() {
                    let bends = |other| bends_down(&self.corners(triangle), &self.corners(other));
                    if beyond.is_none_or(bends) {
                        self.cells[cell] |= 1 << (3 * half as usize + edge);
                    }
                }
            }
        }
    }

    /// Range of the cells between two positions along an axis.
    fn cells_between(&self, axis: usize, from: f32, to: f32) -> Range<usize> {
        let cells = [self.def.columns - 1, self.def.rows - 1][axis];
        let cell = |x: f32| clamp((x / self.def.spacing[axis]).floor(), -1.0, cells as f32) as i64;
        // Adds a cell on either side: a position on a grid line belongs to both cells.
        let first = i64::max(cell(from) - 1, 0) as usize;
        let end = i64::min(cell(to) + 2, cells as i64);
        first..usize::max(i64::max(end, 0) as usize, first)
    }

    fn solid_cells(&self, columns: Range<usize>, rows: Range<usize>) -> impl Iterator<Item = usize> {
        let width = self.width();
        let cells = rows.flat_map(move |j| columns.clone().map(move |i| i + j * width));
        cells.filter(|&cell| self.cells[cell] & HOLE == 0)
    }

    /// Like [`Surface::overlapping`](super::Surface::overlapping).
    pub(super) fn overlapping(&self, region: &Aabb, mut visit: impl FnMut(Triangle)) {
        if !self.bounds.overlaps(region) {
            return;
        }
        let columns = self.cells_between(0, region.min.x, region.max.x);
        let rows = self.cells_between(1, region.min.z, region.max.z);
        for cell in self.solid_cells(columns, rows) {
            for number in [2 * cell as u32, 2 * cell as u32 + 1] {
                if bounds(&self.corners(number)).overlaps(region) {
                    visit(self.triangle(number));
                }
            }
        }
    }

    /// Like [`Surface::closest`](super::Surface::closest). Searches boxes of growing size around the point until the
    /// closest point is nearer than the sides of the box.
    pub(super) fn closest(&self, p: Vec3, reach: f32) -> Option<Closest> {
        let nearest = sinew_math::max3(sinew_math::min3(p, self.bounds.max), self.bounds.min);
        let least = (nearest - p).length();
        let far = (abs_farthest(&self.bounds, p)).length();
        let mut radius = least + max(self.def.spacing[0], self.def.spacing[1]);
        loop {
            let radius_now = min(radius, reach);
            let mut best = None;
            let limit = radius_now * radius_now;
            let region = Aabb::reaching(p, Vec3::splat(radius_now));
            self.overlapping(&region, |triangle| {
                let found = closest_on_triangle(&triangle.corners, p);
                Closest::improve(&mut best, p, limit, found, || triangle);
            });
            if best.is_some() || radius >= reach || radius > far {
                return best;
            }
            radius *= 2.0;
        }
    }

    /// Like [`Surface::enter`](super::Surface::enter). Visits the columns in order, and in each column the rows that
    /// the line crosses.
    pub(super) fn enter(&self, origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
        let span = |low: f32, high: f32, from: f32, along: f32| {
            if along == 0.0 {
                let inside = (low..=high).contains(&from);
                return if inside { (0.0, f32::INFINITY) } else { (f32::INFINITY, 0.0) };
            }
            let (t0, t1) = ((low - from) / along, (high - from) / along);
            (max(min(t0, t1), 0.0), max(t0, t1))
        };
        let mut best: Option<(f32, u32)> = None;
        let ahead = direction.x >= 0.0;
        for step in 0..self.width() {
            let column = if ahead { step } else { self.width() - 1 - step };
            let low = column as f32 * self.def.spacing[0];
            let (first, last) = span(low, low + self.def.spacing[0], origin.x, direction.x);
            if best.is_some_and(|(share, _)| share < first) {
                break;
            }
            if first > last {
                continue;
            }
            let z = |t: f32| if direction.z == 0.0 { origin.z } else { origin.z + direction.z * t };
            let rows = self.cells_between(1, min(z(first), z(last)), max(z(first), z(last)));
            for cell in self.solid_cells(column..column + 1, rows) {
                for number in [2 * cell as u32, 2 * cell as u32 + 1] {
                    if let Some(share) = enter_triangle(&self.corners(number), origin, direction)
                        && best.is_none_or(|(least, _)| share < least)
                    {
                        best = Some((share, number));
                    }
                }
            }
        }
        best.map(|(share, number)| (share, self.triangle(number).normal))
    }
}

impl PartialEq for HeightField {
    fn eq(&self, other: &Self) -> bool {
        self.hash == other.hash && self.def == other.def
    }
}

fn sides(def: &HeightFieldDef) -> [f32; 2] {
    [(def.columns - 1) as f32 * def.spacing[0], (def.rows - 1) as f32 * def.spacing[1]]
}

/// Absolute distances along each axis from a point to the farthest corner of the bounds, metres.
fn abs_farthest(bounds: &Aabb, p: Vec3) -> Vec3 {
    sinew_math::max3(sinew_math::abs3(bounds.max - p), sinew_math::abs3(bounds.min - p))
}

fn check(def: &HeightFieldDef) -> Result<(), HeightFieldError> {
    let HeightFieldDef { columns, rows, .. } = *def;
    let cells = (columns >= 2 && rows >= 2).then(|| (columns - 1).checked_mul(rows - 1)).flatten();
    let cells = cells.filter(|&cells| cells <= MAX_CELLS).ok_or(HeightFieldError::Size)?;
    let vertices = columns.checked_mul(rows).ok_or(HeightFieldError::Size)?;
    if def.heights.len() != vertices {
        return Err(HeightFieldError::Heights { heights: def.heights.len(), vertices });
    }
    // The comparison is false for NaN, so NaN is rejected.
    if !(def.spacing.iter().all(|&x| x > 0.0) && sides(def).iter().all(|&x| x <= MAX_COORDINATE)) {
        return Err(HeightFieldError::Spacing);
    }
    let sane = |h: &f32| h.abs() <= MAX_COORDINATE;
    if let Some(index) = def.heights.iter().position(|h| !sane(h)) {
        return Err(HeightFieldError::NotFinite { index });
    }
    match def.holes.iter().find(|&&hole| hole as usize >= cells) {
        Some(&hole) => Err(HeightFieldError::Hole { hole, cells }),
        None => Ok(()),
    }
}

/// Hash of the numbers; holes count by their cells, not by their order in the list.
fn hash(def: &HeightFieldDef, cells: &[u8]) -> u64 {
    let mut hasher = StableHasher::default();
    hasher.write(&(def.columns as u64).to_le_bytes());
    hasher.write(&(def.rows as u64).to_le_bytes());
    for x in def.spacing.iter().chain(&def.heights) {
        hasher.write(&x.to_bits().to_le_bytes());
    }
    hasher.write(cells);
    hasher.finish()
}
