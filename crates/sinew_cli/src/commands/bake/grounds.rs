//! Walkable grounds of a world: connected positions on a grid of columns.

use sinew::math::{Vec3, max};
use sinew::physics::boxes::Aabb;

/// Width of a column, in heights of the character.
const CELL: f32 = 0.5;
/// Fewest and most columns per side: small worlds need a fine grid, large ones a bounded search.
const COLUMNS: [usize; 2] = [24, 128];
/// Highest step between columns, in heights of the character.
const STEP: f32 = 0.25;
/// Additional height for a slope, in column widths.
const SLOPE: f32 = 0.5;
/// Share of the size of the largest ground below which a ground counts as small: tops of walls, furniture.
const SMALL: f32 = 0.25;
/// Largest number of positions tested per ground, evenly spread.
const MOST_PLACES: usize = 1024;

/// Connected walkable ground.
pub struct Ground {
    /// Positions, nearest to the centre first.
    pub places: Vec<Vec3>,
    /// True for large ground without other walkable ground below it: no roof, no upper floor, no furniture.
    pub is_main: bool,
}

/// A position on a column.
struct Node {
    cell: usize,
    at: Vec3,
}

/// Returns the main grounds, largest first, then the others. `floors` returns the walkable heights below a position,
/// down to a depth, highest first.
pub fn grounds(bounds: &Aabb, height: f32, floors: impl Fn(Vec3, f32) -> Vec<f32>) -> Vec<Ground> {
    let size = bounds.max - bounds.min;
    let count = |length: f32| ((length / (CELL * height)) as usize).clamp(COLUMNS[0], COLUMNS[1]) | 1;
    // An odd count, so that the centre of the world is on a column.
    let (nx, nz) = (count(size.x), count(size.z));
    let cell = Vec3::new(size.x / nx as f32, 0.0, size.z / nz as f32);
    let top = bounds.max.y + height;
    // The ray also finds a half-space below all bodies.
    let depth = size.y + 2.0 * height + 1000.0;
    let (mut lowest, mut upper): (Vec<Node>, Vec<Node>) = (Vec::new(), Vec::new());
    for index in 0..nx * nz {
        let (i, k) = (index % nx, index / nx);
        let x = bounds.min.x + (i as f32 + 0.5) * cell.x;
        let z = bounds.min.z + (k as f32 + 0.5) * cell.z;
        let mut nodes: Vec<Node> = floors(Vec3::new(x, top, z), depth)
            .into_iter()
            .map(|y| Node { cell: index, at: Vec3::new(x, y, z) })
            .collect();
        lowest.extend(nodes.pop());
        upper.extend(nodes);
    }
    let step = STEP * height + SLOPE * max(cell.x, cell.z);
    let mut grounds = Vec::new();
    for (nodes, is_lowest) in [(lowest, true), (upper, false)] {
        let mut parts = connected(&nodes, nx, step);
        parts.sort_by_key(|part| core::cmp::Reverse(part.len()));
        let least = parts.first().map_or(0.0, |part| SMALL * part.len() as f32);
        grounds.extend(parts.iter().map(|part| Ground {
            places: places(&nodes, part),
            is_main: is_lowest && part.len() as f32 >= least,
        }));
    }
    grounds
}

/// Returns the groups of nodes that are connected by steps of at most `step`, as indices. The nodes are in the order of
/// their cells.
fn connected(nodes: &[Node], nx: usize, step: f32) -> Vec<Vec<usize>> {
    let of_cell = |cell: usize| {
        nodes.partition_point(|node| node.cell < cell)..nodes.partition_point(|node| node.cell <= cell)
    };
    let mut seen = vec![false; nodes.len()];
    let mut parts = Vec::new();
    for start in 0..nodes.len() {
        if core::mem::replace(&mut seen[start], true) {
            continue;
        }
        let (mut part, mut at) = (vec![start], 0);
        while at < part.len() {
            let Node { cell, at: place } = nodes[part[at]];
            at += 1;
            let column = cell % nx;
            let beside = [
                (column > 0).then(|| cell - 1),
                (column + 1 < nx).then(|| cell + 1),
                cell.checked_sub(nx),
                Some(cell + nx),
            ];
            for other in beside.into_iter().flatten().flat_map(of_cell) {
                if !seen[other] && (nodes[other].at.y - place.y).abs() <= step {
                    seen[other] = true;
                    part.push(other);
                }
            }
        }
        parts.push(part);
    }
    parts
}

/// Returns positions of a part, evenly spread, nearest to its centre first.
fn places(nodes: &[Node], part: &[usize]) -> Vec<Vec3> {
    let middle = part.iter().map(|&node| nodes[node].at).sum::<Vec3>() / part.len() as f32;
    let away = |at: Vec3| (at - middle) * Vec3::new(1.0, 0.0, 1.0);
    let every = part.len().div_ceil(MOST_PLACES);
    let mut places: Vec<Vec3> = part.iter().step_by(every).map(|&node| nodes[node].at).collect();
    places.sort_by(|a, b| away(*a).length_squared().total_cmp(&away(*b).length_squared()));
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A field of 20 m with a hut of 4 m, whose roof is at the centre: the field is chosen.
    #[test]
    fn larger_ground_is_listed_before_a_roof() {
        let bounds = Aabb::around(Vec3::ZERO, Vec3::new(10.0, 3.0, 10.0));
        let floors =
            |at: Vec3, _: f32| if at.x.abs() < 2.0 && at.z.abs() < 2.0 { vec![3.0] } else { vec![0.0] };
        let found = grounds(&bounds, 1.75, floors);
        assert_eq!(found.len(), 2);
        assert!(found[0].places.iter().all(|at| at.y == 0.0) && found[0].is_main);
        assert!(found[1].places.iter().all(|at| at.y == 3.0) && !found[1].is_main);
    }

    /// A house with a roof over its rooms and walls, and stairs at one end from the floor to the roof.
    #[test]
    fn roof_over_floors_is_no_main_ground() {
        let bounds = Aabb::around(Vec3::ZERO, Vec3::new(5.0, 3.0, 5.0));
        let floors = |at: Vec3, _: f32| match at {
            at if at.x > 4.0 => vec![1.5 * (1.0 - at.z / 5.0)],
            at if (at.x.abs() - 1.0).abs() < 0.4 => vec![3.0],
            _ => vec![3.0, 0.0],
        };
        let found = grounds(&bounds, 1.75, floors);
        let mut main = found.iter().filter(|ground| ground.is_main).flat_map(|ground| &ground.places);
        assert!(main.all(|at| at.y == 0.0 || at.x > 4.0));
        assert!(found[0].places[0].y == 0.0);
    }
}
