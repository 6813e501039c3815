//! One of the trees and the owners of its leaves.

use super::{FEW, Owner};
use crate::tree::Tree;
use std::collections::BTreeMap;

/// A leaf of either tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Leaf(u32);

impl Leaf {
    const FIXED: u32 = 1 << 31;

    pub(super) fn new(moves: bool, leaf: u32) -> Self {
        Self(if moves { leaf } else { leaf | Self::FIXED })
    }

    pub(super) fn moves(self) -> bool {
        self.0 & Self::FIXED == 0
    }

    pub(super) fn at(self) -> usize {
        (self.0 & !Self::FIXED) as usize
    }
}

/// A tree with the owners of its leaves.
#[derive(Clone, Debug, Default)]
pub(super) struct Layer {
    pub tree: Tree,
    pub owners: Vec<Owner>,
    /// True for each leaf whose pairs must be searched.
    pub is_pending: Vec<bool>,
    /// Free leaf ranges, by length.
    pub gaps: BTreeMap<u32, Vec<u32>>,
}

/// Leaves of a body: `count` leaves from `first` on, one per shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Home {
    pub first: u32,
    pub count: u32,
    pub moves: bool,
    /// True if the body is pending a search.
    pub dirty: bool,
    /// Last step in which the body could touch something.
    pub active: u64,
}

impl Home {
    pub(super) fn leaf(&self, shape: u32) -> Leaf {
        Leaf::new(self.moves, self.first + shape)
    }
}

impl Layer {
    /// Allocates leaf numbers for the shapes of a body; returns the first.
    pub(super) fn claim(&mut self, body: u32, count: u32) -> u32 {
        let first = match self.gaps.get_mut(&count).and_then(Vec::pop) {
            Some(first) => first,
            None => self.owners.len() as u32,
        };
        let end = (first + count) as usize;
        if self.owners.len() < end {
            if count as usize > FEW {
                self.owners.reserve_exact(count as usize);
            }
            self.owners.resize(end, Owner { body, shape: 0 });
            self.is_pending.resize(end, false);
        }
        for shape in 0..count {
            self.owners[(first + shape) as usize] = Owner { body, shape };
        }
        first
    }
}
