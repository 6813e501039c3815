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
/// Size ratio above which two grounds count as similar: then the lower comes first, as a house's floor before its roof.
const ALIKE: f32 = 0.5;
/// Largest number of positions tested per ground, evenly spread.
const MOST_PLACES: usize = 1024;

/// A position on a column.
struct Node {
    cell: usize,
    at: Vec3,
}

/// Returns the grounds by size, largest first, each as its positions, nearest to the centre first. `floors` returns the
/// walkable heights below a position, down to a depth.
pub fn grounds(bounds: &Aabb, height: f32, floors: impl Fn(Vec3, f32) -> Vec<f32>) -> Vec<Vec<Vec3>> {
    let size = bounds.max - bounds.min;
    let count = |length: f32| ((length / (CELL * height)) as usize).clamp(COLUMNS[0], COLUMNS[1]) | 1;
    // An odd count, so that the centre of the world is on a column.
    let (nx, nz) = (count(size.x), count(size.z));
    let cell = Vec3::new(size.x / nx as f32, 0.0, size.z / nz as f32);
    let top = bounds.max.y + height;
    // The ray also finds a half-space below all bodies.
    let depth = size.y + 2.0 * height + 1000.0;
    let mut nodes: Vec<Node> = Vec::new();
    let mut first = Vec::with_capacity(nx * nz + 1);
    for index in 0..nx * nz {
        first.push(nodes.len());
        let (i, k) = (index % nx, index / nx);
        let x = bounds.min.x + (i as f32 + 0.5) * cell.x;
        let z = bounds.min.z + (k as f32 + 0.5) * cell.z;
        let heights = floors(Vec3::new(x, top, z), depth);
        nodes.extend(heights.into_iter().map(|y| Node { cell: index, at: Vec3::new(x, y, z) }));
    }
    first.push(nodes.len());
    let step = STEP * height + SLOPE * max(cell.x, cell.z);
    let parts = connected(&nodes, &first, nx, step);
    by_size(&nodes, parts)
}

/// Returns the groups of nodes that are connected by steps of at most `step`, as indices.
fn connected(nodes: &[Node], first: &[usize], nx: usize, step: f32) -> Vec<Vec<usize>> {
    let mut seen = vec![false; nodes.len()];
    let mut parts = Vec::new();
    let cells = first.len() - 1;
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
                Some(cell + nx).filter(|&cell| cell < cells),
            ];
            for other in beside.into_iter().flatten().flat_map(|cell| first[cell]..first[cell + 1]) {
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

/// Returns the parts by size; of the largest ones of similar size the lowest first.
fn by_size(nodes: &[Node], mut parts: Vec<Vec<usize>>) -> Vec<Vec<Vec3>> {
    parts.sort_by_key(|part| core::cmp::Reverse(part.len()));
    let mean = |part: &[usize]| {
        let sum: Vec3 = part.iter().map(|&node| nodes[node].at).sum();
        sum / part.len() as f32
    };
    let least = parts.first().map_or(0, |part| (ALIKE * part.len() as f32) as usize);
    let alike = parts.iter().take_while(|part| part.len() >= least).count();
    parts[..alike].sort_by(|a, b| mean(a).y.total_cmp(&mean(b).y));
    let places = |part: &Vec<usize>| {
        let middle = mean(part);
        let away = |at: Vec3| (at - middle) * Vec3::new(1.0, 0.0, 1.0);
        let every = part.len().div_ceil(MOST_PLACES);
        let mut places: Vec<Vec3> = part.iter().step_by(every).map(|&node| nodes[node].at).collect();
        places.sort_by(|a, b| away(*a).length_squared().total_cmp(&away(*b).length_squared()));
        places
    };
    parts.iter().map(places).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A field of 20 m with a hut of 4 m, whose roof is at the centre: the field is chosen.
    #[test]
    fn larger_field_comes_before_the_roof() {
        let bounds = Aabb::around(Vec3::ZERO, Vec3::new(10.0, 3.0, 10.0));
        let floors =
            |at: Vec3, _: f32| if at.x.abs() < 2.0 && at.z.abs() < 2.0 { vec![3.0] } else { vec![0.0] };
        let found = grounds(&bounds, 1.75, floors);
        assert_eq!(found.len(), 2);
        assert!(found[0].iter().all(|at| at.y == 0.0) && found[1].iter().all(|at| at.y == 3.0));
    }

    /// Floor and roof of a house, the roof a little larger.
    #[test]
    fn floor_comes_before_a_roof_of_similar_size() {
        let bounds = Aabb::around(Vec3::ZERO, Vec3::new(5.0, 3.0, 5.0));
        let floors = |at: Vec3, _: f32| if at.x.abs() < 4.5 { vec![3.0, 0.0] } else { vec![3.0] };
        assert!(grounds(&bounds, 1.75, floors)[0].iter().all(|at| at.y == 0.0));
    }
}
