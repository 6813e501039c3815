//! Grows joint trees over the bodies of an island: their order, their extent, and the remaining loop joints.

use super::faces::Faces;
use crate::island::Island;
use crate::solver::articulation::tree::NONE;
use crate::solver::tuning::MAX_TREE;
use crate::solver::view::View;
use core::ops::Range;

/// Work memory for building the trees.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct Scratch {
    /// Bodies in the order in which the trees reached them.
    pub(super) seeds: Vec<Seed>,
    /// Number of loop rows of each tree.
    pub(super) loop_rows: Vec<usize>,
    /// Number of seeds whose neighbours have been visited.
    pub(super) grown: usize,
    /// Number of bodies in each tree.
    pub(super) sizes: Vec<usize>,
    /// World indices of the moving bodies, in tree order.
    pub(super) order: Vec<u32>,
    /// Local index of each body of the island, by index in the island; while trees grow, only whether it is `NONE`.
    pub(super) local: Vec<u32>,
    /// World indices of the fixed bodies, ascending.
    pub(super) fixed: Vec<u32>,
    /// By slot of the world's bodies: index in the island while trees grow, then the local index. Valid for bodies in
    /// the island.
    pub(super) local_of: Vec<u32>,
    /// True for each joint of the island that a tree uses.
    pub(super) used: Vec<bool>,
    /// Joint indices of each body, ascending, body after body; and the end of each body's part.
    pub(super) adjacent: Vec<u32>,
    pub(super) adjacent_ends: Vec<u32>,
    pub(super) faces: Faces,
}

/// Order in which the trees of an island grow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Roots {
    /// Each tree grows as far as it can before the next one starts.
    InTurn,
    /// All trees on fixed bodies grow at the same time.
    AtOnce,
}

/// A body reached by a tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seed {
    pub(super) tree: u32,
    /// Index of the body in the order of discovery.
    pub(super) found: u32,
    /// Indices in the island of the body, its parent, and the joint between them.
    pub(super) place: u32,
    pub(super) parent: u32,
    pub(super) joint: u32,
}

impl Scratch {
    /// Starts a new tree at `root`, held by the joint `ground` or free.
    pub(super) fn plant(&mut self, root: u32, ground: u32) {
        let tree = self.sizes.len() as u32;
        self.sizes.push(0);
        self.add(tree, root, NONE, ground);
    }

    pub(super) fn add(&mut self, tree: u32, place: u32, parent: u32, joint: u32) {
        let found = self.seeds.len() as u32;
        self.sizes[tree as usize] += 1;
        self.local[place as usize] = found;
        if joint != NONE {
            self.used[joint as usize] = true;
        }
        self.seeds.push(Seed { tree, found, place, parent, joint });
    }

    /// Grows all trees as far as possible.
    pub(super) fn grow(&mut self, island: &Island<'_>, view: &View<'_>) {
        while let Some(&Seed { tree, place, .. }) = self.seeds.get(self.grown) {
            self.grown += 1;
            let body = island.bodies[place as usize];
            for k in self.adjacent_of(place) {
                if self.sizes[tree as usize] >= MAX_TREE {
                    break;
                }
                let j = self.adjacent[k];
                let joint = view.joints.at(island.joints[j as usize]);
                let other = if joint.a == body { joint.b } else { joint.a };
                let Some(other) = self.place_of(island, other) else { continue };
                if self.local[other as usize] == NONE {
                    self.add(tree, other, place, j);
                }
            }
        }
    }

    /// Index in the island of a world body, if the island moves it.
    pub(super) fn place_of(&self, island: &Island<'_>, body: u32) -> Option<u32> {
        let place = self.local_of[body as usize];
        (island.bodies.get(place as usize) == Some(&body)).then_some(place)
    }

    /// Lists the joints of each body by a counting sort.
    pub(super) fn list_adjacent(&mut self, island: &Island<'_>, view: &View<'_>) {
        if self.local_of.len() < view.bodies.slot_count() {
            self.local_of.resize(view.bodies.slot_count(), NONE);
        }
        for (place, &body) in island.bodies.iter().enumerate() {
            self.local_of[body as usize] = place as u32;
        }
        let mut ends = core::mem::take(&mut self.adjacent_ends);
        ends.clear();
        ends.resize(island.bodies.len(), 0);
        let places = |s: &Self, joint: u32| {
            let joint = view.joints.at(joint);
            [joint.a, joint.b].map(|body| s.place_of(island, body)).into_iter().flatten()
        };
        for &joint in island.joints {
            places(self, joint).for_each(|place| ends[place as usize] += 1);
        }
        let mut start = 0;
        for end in &mut ends {
            // `end` is the start of a body's part until the part is filled.
            start += core::mem::replace(end, start);
        }
        self.adjacent.clear();
        self.adjacent.resize(start as usize, 0);
        for (j, &joint) in island.joints.iter().enumerate() {
            for place in places(self, joint) {
                let end = &mut ends[place as usize];
                self.adjacent[*end as usize] = j as u32;
                *end += 1;
            }
        }
        self.adjacent_ends = ends;
    }

    pub(super) fn adjacent_of(&self, place: u32) -> Range<usize> {
        let place = place as usize;
        let start = if place == 0 { 0 } else { self.adjacent_ends[place - 1] };
        start as usize..self.adjacent_ends[place] as usize
    }
}

impl Scratch {
    /// True if a body of a joint or a contact moves with the island.
    pub(super) fn moves(&self, body: u32) -> bool {
        self.order.get(self.local_of[body as usize] as usize) == Some(&body)
    }

    /// Lists the bodies of joints and contacts that do not move with the island.
    pub(super) fn list_fixed(&mut self, island: &Island<'_>, view: &View<'_>) {
        let mut fixed = core::mem::take(&mut self.fixed);
        fixed.clear();
        for &index in island.joints {
            let joint = view.joints.at(index);
            fixed.extend([joint.a, joint.b].into_iter().filter(|&body| !self.moves(body)));
        }
        // Contacts with fixed bodies are last in the list.
        for &index in island.contacts.iter().rev() {
            let key = view.contacts[index as usize].key;
            let before = fixed.len();
            fixed.extend([key.a, key.b].into_iter().filter(|&body| !self.moves(body)));
            if fixed.len() == before {
                break;
            }
        }
        fixed.sort_unstable();
        fixed.dedup();
        self.fixed = fixed;
    }
}
