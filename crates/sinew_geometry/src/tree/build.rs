//! Builds a tree from the root down, with splits by the binned surface area heuristic (Wald, "On fast construction of
//! SAH-based bounding volume hierarchies", RT 2007).

use super::node::{Child, Node, half_area};
use super::{Place, Tree};
use crate::boxes::Aabb;
use core::ops::Range;
use sinew_math::Vec3;
use sinew_math::lanes::WIDTH;

/// A leaf for the build.
#[derive(Clone, Copy, Debug)]
pub struct Item {
    /// Bounds of the leaf.
    pub bounds: Aabb,
    /// Number of the leaf.
    pub leaf: u32,
}

impl Item {
    /// Twice the centre of the bounds, metres; the factor does not matter for comparisons.
    fn middle(&self) -> Vec3 {
        self.bounds.min + self.bounds.max
    }
}

/// Number of candidate split positions per axis.
const BINS: usize = 16;

impl Tree {
    /// Builds a tree of these leaves; their numbers must differ. Reorders the items.
    pub fn build(&mut self, items: &mut [Item]) {
        self.nodes.clear();
        self.parents.clear();
        self.free.clear();
        self.places.fill(Place::NOWHERE);
        (self.root, self.levels, self.len, self.inserted) = (None, 0, items.len(), 0);
        if items.is_empty() {
            return;
        }
        let most = items.iter().fold(0, |most, item| u32::max(most, item.leaf)) as usize;
        self.places.reserve_exact((most + 1).saturating_sub(self.places.len()));
        self.make_room(most as u32);
        // Nodes of the lowest level are full; the nodes of the levels above are about a fifth as many.
        let nodes = items.len() / WIDTH + items.len() / (5 * WIDTH) + 1;
        self.nodes.reserve_exact(nodes);
        self.parents.reserve_exact(nodes);
        self.levels = 1;
        while WIDTH.pow(self.levels as u32) < items.len() {
            self.levels += 1;
        }
        self.root = Some(self.build_node(items, self.levels - 1, Place::NOWHERE));
    }

    /// Rebuilds the tree with the same leaves. `scratch` is a buffer.
    pub fn rebuild(&mut self, scratch: &mut Vec<Item>) {
        scratch.clear();
        self.collect(scratch);
        self.build(scratch);
    }

    /// Appends all leaves to `items`.
    pub fn collect(&self, items: &mut Vec<Item>) {
        let leaves = self.places.iter().enumerate().filter(|(_, place)| **place != Place::NOWHERE);
        items.extend(leaves.map(|(leaf, place)| {
            let (node, slot) = place.split();
            Item { bounds: self.nodes[node as usize].bounds(slot), leaf: leaf as u32 }
        }));
    }

    /// Builds a node with `below` levels below it; returns its index.
    fn build_node(&mut self, items: &mut [Item], below: usize, parent: Place) -> u32 {
        let index = self.nodes.len() as u32;
        self.nodes.push(Node::EMPTY);
        self.parents.push(parent);
        if below == 0 {
            for (slot, item) in items.iter().enumerate() {
                self.put(index, slot, Child::leaf(item.leaf), &item.bounds);
            }
            return index;
        }
        let (parts, count) = partition(items, WIDTH.pow(below as u32));
        for (slot, part) in parts[..count].iter().enumerate() {
            let child = self.build_node(&mut items[part.clone()], below - 1, Place::new(index, slot));
            let total = self.nodes[child as usize].total();
            self.put(index, slot, Child::node(child), &total);
        }
        index
    }
}

/// Orders items into up to eight compact ranges of at most `most` items each; returns the ranges and their number.
fn partition(items: &mut [Item], most: usize) -> ([Range<usize>; WIDTH], usize) {
    let mut parts: [Range<usize>; WIDTH] = core::array::from_fn(|_| 0..0);
    parts[0] = 0..items.len();
    let mut count = 1;
    loop {
        let largest = (0..count).max_by_key(|&i| (parts[i].len(), WIDTH - i)).unwrap_or(0);
        let part = parts[largest].clone();
        if part.len() <= most {
            return (parts, count);
        }
        let needed: usize = parts[..count].iter().map(|part| part.len().div_ceil(most)).sum();
        // While slots are spare, a range may be split at any multiple of eight; otherwise only at multiples of `most`,
        // so that the ranges fit into the slots.
        let unit = if needed < WIDTH { WIDTH } else { most };
        let first = split(&mut items[part.clone()], unit);
        parts[largest] = part.start..part.start + first;
        parts[count] = part.start + first..part.end;
        count += 1;
    }
}

/// Splits items into two groups by the surface area heuristic and orders them by group; returns the size of the first
/// group, a multiple of `unit`.
fn split(items: &mut [Item], unit: usize) -> usize {
    let (axis, count) = best_split(items);
    let most = (items.len() - 1) / unit * unit;
    let first = usize::clamp((count + unit / 2) / unit * unit, unit, most);
    let middle = |item: &Item| item.bounds.min[axis] + item.bounds.max[axis];
    items.select_nth_unstable_by(first, |a, b| {
        middle(a).total_cmp(&middle(b)).then(u32::cmp(&a.leaf, &b.leaf))
    });
    first
}

/// Returns the axis, and the number of items before the best split across it.
fn best_split(items: &[Item]) -> (usize, usize) {
    let (low, high) = items.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), item| {
        (sinew_math::min3(low, item.middle()), sinew_math::max3(high, item.middle()))
    });
    let extent = high - low;
    let mut bins = [[Bin::EMPTY; BINS]; 3];
    let scale = Vec3::splat(BINS as f32 * 0.999) / extent;
    for item in items {
        let at = (item.middle() - low) * scale;
        for axis in 0..3 {
            // Infinite or NaN values go into the first or the last bin.
            let bin = usize::min(at[axis] as usize, BINS - 1);
            bins[axis][bin].add(&item.bounds);
        }
    }
    let mut best = (f32::INFINITY, crate::boxes::placed::largest_axis(extent), items.len() / 2);
    for axis in 0..3 {
        let mut rest = [0.0; BINS];
        let mut sum = Bin::EMPTY;
        for i in (1..BINS).rev() {
            sum.merge(&bins[axis][i]);
            rest[i] = sum.cost();
        }
        let mut sum = Bin::EMPTY;
        for i in 1..BINS {
            sum.merge(&bins[axis][i - 1]);
            let cost = sum.cost() + rest[i];
            if cost < best.0 && sum.count > 0 && sum.count < items.len() {
                best = (cost, axis, sum.count);
            }
        }
    }
    (best.1, best.2)
}

/// Items between two split planes: their bounds and number.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Aabb,
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Aabb { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY }, count: 0 };

    fn add(&mut self, bounds: &Aabb) {
        self.bounds = self.bounds.merge(bounds);
        self.count += 1;
    }

    fn merge(&mut self, other: &Self) {
        self.bounds = self.bounds.merge(&other.bounds);
        self.count += other.count;
    }

    fn cost(&self) -> f32 {
        half_area(&self.bounds) * self.count as f32
    }
}
