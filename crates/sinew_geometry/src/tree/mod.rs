//! Bounding-volume tree with eight boxes per node. It finds the leaves that overlap a box, lie along a line, or are
//! closest to a point.
//!
//! All leaves have the same depth. [`build`](Tree::build) makes a tree by the surface area heuristic with full nodes at
//! the lowest level; single leaves are inserted and removed as in an R-tree (Guttman, "R-trees: a dynamic index
//! structure for spatial searching", SIGMOD 1984). The order of query results depends on the tree's structure; the set
//! of results does not.

mod build;
mod node;
mod query;
#[cfg(test)]
mod tests;
mod traversal;
mod waiting;

use crate::boxes::Aabb;
pub use build::Item;
pub use node::PAD;
use node::{Child, Node, half_area};
pub use query::Sweep;
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{Lanes, WIDTH};
pub use traversal::{Stop, Traversal};

/// Largest number of levels of nodes; it sets the size of the queries' stacks. With full nodes, 11 levels hold 2³²
/// leaves.
const MOST_LEVELS: usize = 14;

/// Position of a child: index of the node times eight, plus slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Place(u32);

impl Place {
    /// Value for a leaf that is not in the tree, and for the root, which has no parent.
    const NOWHERE: Self = Self(u32::MAX);

    fn new(node: u32, slot: usize) -> Self {
        Self(node * WIDTH as u32 + slot as u32)
    }

    fn split(self) -> (u32, usize) {
        (self.0 / WIDTH as u32, self.0 as usize % WIDTH)
    }
}

/// Tree of leaves; the user chooses the leaf numbers, from 0 on.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    nodes: Vec<Node>,
    /// Position of each node in its parent.
    parents: Vec<Place>,
    free: Vec<u32>,
    /// Position of each leaf, by its number.
    places: Vec<Place>,
    root: Option<u32>,
    /// Number of levels of nodes.
    levels: usize,
    len: usize,
    /// Number of leaves inserted one by one since the tree was built.
    inserted: usize,
}

impl Tree {
    /// Number of leaves.
    #[inline]
    pub fn len(&self) -> usize {
        self.len
    }

    /// True if there are no leaves.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// True if the tree has a leaf with this number.
    #[inline]
    pub fn contains(&self, leaf: u32) -> bool {
        self.places.get(leaf as usize).is_some_and(|&place| place != Place::NOWHERE)
    }

    /// Bounds of an existing leaf.
    #[inline]
    pub fn bounds(&self, leaf: u32) -> Aabb {
        let (node, slot) = self.places[leaf as usize].split();
        self.nodes[node as usize].bounds(slot)
    }

    /// Adds a leaf.
    pub fn insert(&mut self, leaf: u32, bounds: &Aabb) {
        self.make_room(leaf);
        self.len += 1;
        self.inserted += 1;
        let Some(root) = self.root else {
            let root = self.new_node(Place::NOWHERE);
            (self.root, self.levels) = (Some(root), 1);
            self.put(root, 0, Child::leaf(leaf), bounds);
            return;
        };
        let node = dispatch::run(Descent { tree: self, root, bounds });
        self.add(node, Child::leaf(leaf), *bounds);
        if self.levels > MOST_LEVELS {
            self.rebuild(&mut Vec::new());
        }
    }

    /// Removes an existing leaf.
    pub fn remove(&mut self, leaf: u32) {
        let place = core::mem::replace(&mut self.places[leaf as usize], Place::NOWHERE);
        self.len -= 1;
        let (mut node, mut slot) = place.split();
        loop {
            self.nodes[node as usize].clear(slot);
            if !self.nodes[node as usize].is_empty() {
                self.refit(node);
                return;
            }
            self.free.push(node);
            let parent = self.parents[node as usize];
            if parent == Place::NOWHERE {
                (self.root, self.levels) = (None, 0);
                return;
            }
            (node, slot) = parent.split();
        }
    }

    /// Changes the bounds of an existing leaf. The leaf stays in its node while the new bounds fit; otherwise it is
    /// inserted again.
    pub fn update(&mut self, leaf: u32, bounds: &Aabb) {
        let (node, slot) = self.places[leaf as usize].split();
        let parent = self.parents[node as usize];
        let stays = parent == Place::NOWHERE || {
            let (node, slot) = parent.split();
            self.nodes[node as usize].bounds(slot).contains(bounds)
        };
        if stays {
            self.nodes[node as usize].set_bounds(slot, bounds);
            self.refit(node);
        } else {
            self.remove(leaf);
            self.insert(leaf, bounds);
        }
    }

    /// True if a rebuild would make queries notably faster: many leaves were inserted one by one, or many nodes are
    /// nearly empty.
    pub fn is_worn(&self) -> bool {
        let used = self.nodes.len() - self.free.len();
        (self.inserted > 64 && self.inserted > self.len) || used > self.len / 2 + MOST_LEVELS
    }

    /// Reserves memory for this many leaves, enough for any structure of the tree.
    pub fn reserve(&mut self, leaves: usize) {
        let nodes = leaves + MOST_LEVELS;
        self.nodes.reserve(nodes.saturating_sub(self.nodes.len()));
        self.parents.reserve(nodes.saturating_sub(self.parents.len()));
        self.free.reserve(nodes.saturating_sub(self.free.len()));
    }

    /// Reserves an entry for a leaf with this number in the list of positions.
    fn make_room(&mut self, leaf: u32) {
        if self.places.len() <= leaf as usize {
            self.places.resize(leaf as usize + 1, Place::NOWHERE);
        }
    }

    fn new_node(&mut self, parent: Place) -> u32 {
        if let Some(node) = self.free.pop() {
            self.nodes[node as usize] = Node::EMPTY;
            self.parents[node as usize] = parent;
            return node;
        }
        self.nodes.push(Node::EMPTY);
        self.parents.push(parent);
        self.nodes.len() as u32 - 1
    }

    /// Writes a child into a slot, and stores its position.
    fn put(&mut self, node: u32, slot: usize, child: Child, bounds: &Aabb) {
        self.nodes[node as usize].set(slot, child, bounds);
        let place = Place::new(node, slot);
        match child.get() {
            Ok(leaf) => self.places[leaf as usize] = place,
            Err(node) => self.parents[node as usize] = place,
        }
    }

    /// Adds a child to a node. A full node is split, and the new node is added to the parent in the same way.
    fn add(&mut self, mut node: u32, mut child: Child, mut bounds: Aabb) {
        loop {
            if let Some(slot) = self.nodes[node as usize].free_slot() {
                self.put(node, slot, child, &bounds);
                self.refit(node);
                return;
            }
            let other = self.split(node, child, &bounds);
            let total = self.nodes[node as usize].total();
            let parent = self.parents[node as usize];
            (child, bounds) = (Child::node(other), self.nodes[other as usize].total());
            if parent == Place::NOWHERE {
                let root = self.new_node(Place::NOWHERE);
                self.put(root, 0, Child::node(node), &total);
                self.put(root, 1, child, &bounds);
                self.root = Some(root);
                self.levels += 1;
                return;
            }
            let (up, slot) = parent.split();
            self.nodes[up as usize].set_bounds(slot, &total);
            node = up;
        }
    }

    /// Splits a full node and one more child into the node and a new one; returns the new node.
    fn split(&mut self, node: u32, child: Child, bounds: &Aabb) -> u32 {
        let own = &self.nodes[node as usize];
        let mut all = [(*bounds, child); WIDTH + 1];
        for slot in 0..WIDTH {
            all[slot] = (own.bounds(slot), own.child(slot));
        }
        let first = divide(&mut all);
        let other = self.new_node(Place::NOWHERE);
        self.nodes[node as usize] = Node::EMPTY;
        for (slot, (bounds, child)) in all[..first].iter().enumerate() {
            self.put(node, slot, *child, bounds);
        }
        for (slot, (bounds, child)) in all[first..].iter().enumerate() {
            self.put(other, slot, *child, bounds);
        }
        other
    }

    /// Recomputes the bounds of a node and its ancestors in their parents.
    fn refit(&mut self, mut node: u32) {
        loop {
            let parent = self.parents[node as usize];
            if parent == Place::NOWHERE {
                return;
            }
            let total = self.nodes[node as usize].total();
            let (up, slot) = parent.split();
            if self.nodes[up as usize].bounds(slot) == total {
                return;
            }
            self.nodes[up as usize].set_bounds(slot, &total);
            node = up;
        }
    }
}

/// Kernel that descends from the root to the lowest node that must grow least for new bounds.
struct Descent<'a> {
    tree: &'a mut Tree,
    root: u32,
    bounds: &'a Aabb,
}

impl Kernel for Descent<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u32 {
        let Aabb { min, max } = *self.bounds;
        let bounds = [min.x, min.y, min.z, max.x, max.y, max.z].map(L::splat);
        let mut node = self.root;
        for _ in 1..self.tree.levels {
            let own = &mut self.tree.nodes[node as usize];
            let slot = own.least_growth(&bounds);
            own.set_bounds(slot, &own.bounds(slot).merge(self.bounds));
            node = own.child(slot).get().expect_err("nodes above the lowest level contain nodes");
        }
        node
    }
}

/// Smallest number of children of a node after a split.
const FEWEST: usize = 3;

/// Splits children into two groups with the least total surface area and orders them by group; returns the size of the
/// first group.
fn divide(all: &mut [(Aabb, Child); WIDTH + 1]) -> usize {
    let mut best = (f32::INFINITY, 0, FEWEST);
    for axis in 0..3 {
        order(all, axis);
        let mut rest = [0.0; WIDTH + 1];
        let mut sum = all[WIDTH].0;
        for i in (1..=WIDTH).rev() {
            sum = sum.merge(&all[i].0);
            rest[i] = half_area(&sum);
        }
        let mut sum = all[0].0;
        for first in 1..=WIDTH + 1 - FEWEST {
            if first >= FEWEST {
                let cost = half_area(&sum) * first as f32 + rest[first] * (WIDTH + 1 - first) as f32;
                if cost < best.0 {
                    best = (cost, axis, first);
                }
            }
            sum = sum.merge(&all[first].0);
        }
    }
    order(all, best.1);
    best.2
}

fn order(all: &mut [(Aabb, Child); WIDTH + 1], axis: usize) {
    let middle = |(bounds, _): &(Aabb, Child)| bounds.min[axis] + bounds.max[axis];
    all.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
}
