//! Grid of full and empty cells between planes, covered by few boxes.

use core::ops::Range;

/// Cells between planes along three axes.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    /// Ascending coordinates, metres; cell i of an axis is between planes i and i + 1.
    pub planes: [Vec<f32>; 3],
    /// True for full cells; cell (i, j, k) has index `(i * ny + j) * nz + k`.
    pub full: Vec<bool>,
}

/// A box of cells: a range of cells per axis.
pub(super) type CellBox = [Range<usize>; 3];

impl Grid {
    /// Creates the cells between planes; `is_full` decides from the low and the high corner of a cell.
    pub fn new(planes: [Vec<f32>; 3], mut is_full: impl FnMut([f32; 3], [f32; 3]) -> bool) -> Self {
        let mut grid = Self { planes, full: Vec::new() };
        let [nx, ny, nz] = grid.counts();
        for i in 0..nx {
            for j in 0..ny {
                for k in 0..nz {
                    let (low, high) = grid.corners(&[i..i + 1, j..j + 1, k..k + 1]);
                    grid.full.push(is_full(low, high));
                }
            }
        }
        grid
    }

    fn counts(&self) -> [usize; 3] {
        [0, 1, 2].map(|axis| self.planes[axis].len() - 1)
    }

    /// Returns the low and the high corner of a box of cells.
    pub fn corners(&self, cells: &CellBox) -> ([f32; 3], [f32; 3]) {
        let at = |axis: usize, i: usize| self.planes[axis][i];
        ([0, 1, 2].map(|a| at(a, cells[a].start)), [0, 1, 2].map(|a| at(a, cells[a].end)))
    }

    /// Returns at most `most` boxes of full cells that cover all full cells except for a share `left_out` of their
    /// volume. Boxes may overlap, because each is as large as possible.
    pub fn cover(&self, left_out: f32, most: usize) -> Vec<CellBox> {
        let filled = Sums::new(self.counts(), |cell| if self.full[cell] { 1.0 } else { 0.0 });
        let volumes = self.volumes();
        let mut bare: Vec<bool> = self.full.clone();
        let total: f32 = (0..bare.len()).filter(|&i| bare[i]).map(|i| volumes[i]).sum();
        let depth = self.depths();
        let mut left = total;
        let mut boxes = Vec::new();
        while left > left_out * total && boxes.len() < most {
            let deepest = (0..bare.len()).filter(|&i| bare[i]).max_by(|&a, &b| {
                (depth[a], volumes[a])
                    .partial_cmp(&(depth[b], volumes[b]))
                    .unwrap_or(core::cmp::Ordering::Equal)
            });
            let Some(seed) = deepest else { break };
            let gains = Sums::new(self.counts(), |cell| if bare[cell] { volumes[cell] } else { 0.0 });
            let grown = ORDERS.map(|order| self.grow(seed, order, &filled));
            let gain = |cells: &CellBox| gains.over(cells);
            let best = grown.into_iter().reduce(|a, b| if gain(&b) > gain(&a) { b } else { a });
            let Some(best) = best else { break };
            for cell in self.cells_of(&best) {
                if bare[cell] {
                    left -= volumes[cell];
                }
                bare[cell] = false;
            }
            boxes.push(best);
        }
        boxes
    }

    fn volumes(&self) -> Vec<f32> {
        let [nx, ny, nz] = self.counts();
        let width = |axis: usize, i: usize| self.planes[axis][i + 1] - self.planes[axis][i];
        let mut volumes = Vec::with_capacity(nx * ny * nz);
        for i in 0..nx {
            for j in 0..ny {
                volumes.extend((0..nz).map(|k| width(0, i) * width(1, j) * width(2, k)));
            }
        }
        volumes
    }

    fn cells_of(&self, cells: &CellBox) -> impl Iterator<Item = usize> {
        let [_, ny, nz] = self.counts();
        let [x, y, z] = cells.clone();
        x.flat_map(move |i| {
            let (y, z) = (y.clone(), z.clone());
            y.flat_map(move |j| z.clone().map(move |k| (i * ny + j) * nz + k))
        })
    }

    /// Distance of each full cell from the nearest empty cell along an axis, in cells.
    fn depths(&self) -> Vec<u32> {
        let counts = self.counts();
        let strides = [counts[1] * counts[2], counts[2], 1];
        let mut depth: Vec<u32> = self.full.iter().map(|&full| if full { u32::MAX } else { 0 }).collect();
        for axis in 0..3 {
            for line in 0..self.full.len() {
                // Start at the first cell of each line along the axis.
                if !(line / strides[axis]).is_multiple_of(counts[axis]) {
                    continue;
                }
                let cell = |i: usize| line + i * strides[axis];
                let mut pass = |order: &mut dyn Iterator<Item = usize>| {
                    let mut run = 0;
                    for i in order {
                        run = if self.full[cell(i)] { run + 1 } else { 0 };
                        depth[cell(i)] = u32::min(depth[cell(i)], run);
                    }
                };
                pass(&mut (0..counts[axis]));
                pass(&mut (0..counts[axis]).rev());
            }
        }
        depth
    }

    /// Returns the box grown from a cell as far as possible along one axis after the other.
    fn grow(&self, seed: usize, order: [usize; 3], filled: &Sums) -> CellBox {
        let counts = self.counts();
        let place = [seed / (counts[1] * counts[2]), seed / counts[2] % counts[1], seed % counts[2]];
        let mut cells = place.map(|i| i..i + 1);
        for axis in order {
            let is_full = |cells: &CellBox, from: usize, to: usize| {
                let mut layer = cells.clone();
                layer[axis] = from..to;
                let size: usize = layer.iter().map(ExactSizeIterator::len).product();
                filled.over(&layer) > size as f32 - 0.5
            };
            while cells[axis].start > 0 && is_full(&cells, cells[axis].start - 1, cells[axis].start) {
                cells[axis].start -= 1;
            }
            while cells[axis].end < counts[axis] && is_full(&cells, cells[axis].end, cells[axis].end + 1) {
                cells[axis].end += 1;
            }
        }
        cells
    }
}

const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

/// Sums over boxes of cells in constant time (Crow 1984, in three dimensions).
struct Sums {
    counts: [usize; 3],
    /// Prefix sums over all cells below a corner; in f64, whose differences are exact for whole numbers.
    sums: Vec<f64>,
}

impl Sums {
    fn new(counts: [usize; 3], value: impl Fn(usize) -> f32) -> Self {
        let mut sums = Self { counts, sums: vec![0.0; (counts[0] + 1) * (counts[1] + 1) * (counts[2] + 1)] };
        for i in 0..counts[0] {
            for j in 0..counts[1] {
                let mut row = 0.0;
                for k in 0..counts[2] {
                    row += f64::from(value((i * counts[1] + j) * counts[2] + k));
                    let beside = sums.at(i, j + 1, k + 1) + sums.at(i + 1, j, k + 1) - sums.at(i, j, k + 1);
                    let index = sums.index(i + 1, j + 1, k + 1);
                    sums.sums[index] = beside + row;
                }
            }
        }
        sums
    }

    fn index(&self, i: usize, j: usize, k: usize) -> usize {
        (i * (self.counts[1] + 1) + j) * (self.counts[2] + 1) + k
    }

    fn at(&self, i: usize, j: usize, k: usize) -> f64 {
        self.sums[self.index(i, j, k)]
    }

    fn over(&self, [x, y, z]: &CellBox) -> f32 {
        let column = |i: usize, j: usize| self.at(i, j, z.end) - self.at(i, j, z.start);
        let plane = |i: usize| column(i, y.end) - column(i, y.start);
        (plane(x.end) - plane(x.start)) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_grid(counts: [usize; 3], is_full: impl Fn([f32; 3]) -> bool) -> Grid {
        let planes = counts.map(|n| (0..=n).map(|i| i as f32).collect());
        Grid::new(planes, |low, _| is_full(low))
    }

    #[test]
    fn stairs_become_one_box_per_step() {
        let stairs = unit_grid([6, 6, 4], |[x, y, _]| y <= x);
        let boxes = stairs.cover(0.0, 100);
        assert_eq!(boxes.len(), 6, "{boxes:?}");
        for step in 0..6 {
            let top = |cells: &CellBox| cells[1].end == step + 1 && cells[0].end == 6 && cells[2] == (0..4);
            assert!(boxes.iter().any(top), "step {step} has no box on top: {boxes:?}");
        }
    }

    #[test]
    fn cover_contains_every_full_cell_and_no_empty_one() {
        let mut random = sinew_math::Random::new(3);
        for _ in 0..50 {
            let bits: Vec<bool> = (0..5 * 6 * 7).map(|_| random.unit() < 0.7).collect();
            let grid = unit_grid([5, 6, 7], |[x, y, z]| bits[(x as usize * 6 + y as usize) * 7 + z as usize]);
            let mut covered = vec![false; bits.len()];
            for cells in grid.cover(0.0, usize::MAX) {
                for cell in grid.cells_of(&cells) {
                    covered[cell] = true;
                }
            }
            assert_eq!(covered, bits);
        }
    }
}
