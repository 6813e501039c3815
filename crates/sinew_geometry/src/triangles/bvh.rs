//! Binary tree of bounds over triangles.

use super::triangle::bounds;
use crate::boxes::{Aabb, Overlap};
use core::ops::Range;
use sinew_math::{Vec3, max, max3, min};

/// Largest number of triangles in a leaf.
const LEAF: usize = 4;
/// Stack size, larger than the number of levels of a balanced tree with 2³² leaves.
pub(crate) const DEPTH: usize = 40;

/// Binary tree of the bounds of triangles. Leaves hold index ranges in the order of triangles after [`Tree::new`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    bounds: Aabb,
    /// First triangle of a leaf, or index of the second child of an inner node; the first child follows its parent.
    next: u32,
    /// Number of triangles of a leaf; 0 for an inner node.
    count: u32,
}

/// Children of a node.
pub(crate) enum Branch {
    /// Two nodes, by index.
    Nodes([u32; 2]),
    /// Range of triangles, in leaf order.
    Leaf(Range<u32>),
}

impl Tree {
    /// Builds a tree over at least one triangle; sorts the indices into leaf order.
    pub fn new(numbers: &mut [u32], corners: &impl Fn(u32) -> [Vec3; 3]) -> Self {
        let mut nodes = Vec::with_capacity(numbers.len());
        grow(numbers, 0, corners, &mut nodes);
        nodes.shrink_to_fit();
        Self { nodes }
    }

    /// Bounds of all triangles.
    pub fn bounds(&self) -> Aabb {
        self.bounds_below(0)
    }

    /// Memory use, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
    }

    /// Number of nodes. The first is the root; children have higher numbers than their parent.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Bounds of the triangles below a node.
    pub fn bounds_below(&self, node: u32) -> Aabb {
        self.nodes[node as usize].bounds
    }

    /// Content of a node.
    pub fn branch(&self, node: u32) -> Branch {
        match self.nodes[node as usize] {
            Node { next, count: 0, .. } => Branch::Nodes([node + 1, next]),
            Node { next, count, .. } => Branch::Leaf(next..next + count),
        }
    }

    /// Calls `visit` with the leaves whose bounds overlap `region`, in a deterministic order.
    pub fn overlapping(&self, region: &Aabb, mut visit: impl FnMut(Range<u32>)) {
        let meets = |bounds: &Aabb| if bounds.overlaps(region) { 0.0 } else { f32::INFINITY };
        self.walk(f32::MAX, meets, |places| {
            visit(places);
            f32::MAX
        });
    }

    /// Calls `visit` with the leaves that may be within a squared distance of `p`, nearer leaves first. The limit of
    /// the squared distance is `square` (m²) at first, then the last result of `visit`.
    pub fn nearest(&self, p: Vec3, square: f32, visit: impl FnMut(Range<u32>) -> f32) {
        let away = |bounds: &Aabb| max3(max3(bounds.min - p, p - bounds.max), Vec3::ZERO).length_squared();
        self.walk(square, away, visit);
    }

    /// Calls `visit` with the leaves that a line from `origin` may enter before a limit, nearer leaves first. The limit
    /// is a share of `direction`: `share` at first, then the last result of `visit`.
    pub fn along(&self, origin: Vec3, direction: Vec3, share: f32, visit: impl FnMut(Range<u32>) -> f32) {
        self.walk(share, |bounds| enter(bounds, origin, direction), visit);
    }

    /// Visits the leaves whose key is at most `limit`; each visit may lower the limit. The key of a node must not be
    /// below that of its parent; leaves with an infinite key are not visited.
    fn walk(&self, mut limit: f32, key: impl Fn(&Aabb) -> f32, mut visit: impl FnMut(Range<u32>) -> f32) {
        let key = |index: u32| (index, key(&self.nodes[index as usize].bounds));
        let mut open = [(0, 0.0); DEPTH];
        open[0] = key(0);
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (index, least) = open[count];
            // The comparison is false for NaN, so NaN is skipped.
            if !(least <= limit && least < f32::INFINITY) {
                continue;
            }
            let (first, second) = match self.branch(index) {
                Branch::Nodes([first, second]) => (key(first), key(second)),
                Branch::Leaf(places) => {
                    limit = visit(places);
                    continue;
                }
            };
            let (near, far) = if second.1 < first.1 { (second, first) } else { (first, second) };
            open[count] = far;
            open[count + 1] = near;
            count += 2;
        }
    }
}

/// Share of `direction` at which a line enters the bounds: 0 if it starts inside, infinite if it misses. The bounds are
/// widened to cover rounding errors.
fn enter(bounds: &Aabb, origin: Vec3, direction: Vec3) -> f32 {
    let (mut first, mut last) = (0.0, f32::INFINITY);
    for k in 0..3 {
        let (low, high) = (bounds.min[k] - origin[k], bounds.max[k] - origin[k]);
        if direction[k] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return f32::INFINITY;
            }
            continue;
        }
        let (t0, t1) = (low / direction[k], high / direction[k]);
        first = max(min(t0, t1), first);
        last = min(max(t0, t1), last);
    }
    const ROUNDING: f32 = 1e-6;
    if first * (1.0 - ROUNDING) <= last * (1.0 + ROUNDING) { first * (1.0 - ROUNDING) } else { f32::INFINITY }
}

/// Appends the tree over the triangles `numbers` to `nodes`; `offset` is the index of the first triangle.
fn grow(numbers: &mut [u32], offset: u32, corners: &impl Fn(u32) -> [Vec3; 3], nodes: &mut Vec<Node>) {
    let place = nodes.len();
    let around = numbers.iter().map(|&i| bounds(&corners(i))).reduce(|a, b| a.merge(&b)).unwrap_or_default();
    nodes.push(Node { bounds: around, next: offset, count: numbers.len() as u32 });
    if numbers.len() <= LEAF {
        return;
    }
    let axis = longest_axis(around.max - around.min);
    let middle = |i: &u32| {
        let [a, b, c] = corners(*i);
        a[axis] + b[axis] + c[axis]
    };
    // Both halves have the same number of triangles, so that the tree is balanced for every mesh.
    let half = numbers.len() / 2;
    numbers.select_nth_unstable_by(half, |i, j| middle(i).total_cmp(&middle(j)).then(i.cmp(j)));
    let (low, high) = numbers.split_at_mut(half);
    grow(low, offset, corners, nodes);
    nodes[place].next = nodes.len() as u32;
    nodes[place].count = 0;
    grow(high, offset + half as u32, corners, nodes);
}

fn longest_axis(extent: Vec3) -> usize {
    let longer = |a: usize, b: usize| if extent[b] > extent[a] { b } else { a };
    longer(longer(0, 1), 2)
}
