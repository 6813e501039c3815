//! Merges small boxes before the search for good merges, which takes quadratic time.

use super::fitted::around;
use crate::boxes::{Cuboid, Obb};
use sinew_math::max;

/// Returns about `most` boxes at most. Keeps the `most / 2` largest boxes, and merges the others that are in the same
/// cell of a grid. The cells are the smallest cubes that leave few enough boxes.
pub(super) fn at_most(most: usize, mut blocks: Vec<Obb>, thinnest: f32) -> Vec<Obb> {
    if blocks.len() <= most {
        return blocks;
    }
    blocks.sort_by(|a, b| b.volume().total_cmp(&a.volume()));
    let small = blocks.split_off(most / 2);
    let farthest = small.iter().flat_map(|block| block.center.to_array()).map(f32::abs).fold(0.0, max);
    let mut size = max(farthest / 1024.0, thinnest);
    let mut cells = by_cell(&small, size);
    // Once the cells are larger than `farthest`, only the eight cells around the origin remain.
    while cells.len() > usize::max(most - most / 2, 8) {
        size *= 1.25;
        cells = by_cell(&small, size);
    }
    blocks.extend(cells.iter().map(|cell| {
        let corners = cell.iter().flat_map(|block| block.corners());
        // Boxes are sorted by volume, so the first of a cell is the largest.
        around(corners, cell[0].rotation, thinnest)
    }));
    blocks
}

/// Groups boxes by the grid cell that contains their centre, in the order of cells.
fn by_cell(blocks: &[Obb], size: f32) -> Vec<Vec<&Obb>> {
    let key = |block: &Obb| block.center.to_array().map(|x| (x / size).floor() as i64);
    let mut keyed: Vec<_> = blocks.iter().map(|block| (key(block), block)).collect();
    keyed.sort_by_key(|(key, _)| *key);
    let cells = keyed.chunk_by(|a, b| a.0 == b.0);
    cells.map(|cell| cell.iter().map(|(_, block)| *block).collect()).collect()
}
