//! Pairs of bodies that do not collide.

use crate::arena::Arena;
use crate::contact::filter::{PairFilter, PairFunctions};
use crate::contact::ordered;
use crate::joint::Joint;

/// Pairs of bodies that do not collide: those disabled by the user, and those of joints whose bodies do not collide.
#[derive(Clone, Debug, Default)]
pub(crate) struct DisabledPairs {
    /// Pairs disabled by the user: body indices, smaller first, ascending.
    pub disabled: Vec<(u32, u32)>,
    /// Union of the user's and the joints' pairs: body indices, smaller first, ascending.
    all: Vec<(u32, u32)>,
    /// True if `all` is out of date.
    stale: bool,
    /// Version of `all`, which changes with the list.
    version: u64,
    /// User functions that filter pairs.
    pub functions: PairFunctions,
}

impl DisabledPairs {
    /// Restores the pairs and the number of the user function from a snapshot.
    pub fn restore(&mut self, disabled: Vec<(u32, u32)>, function: Option<u32>) {
        (self.disabled, self.functions.chosen, self.stale) = (disabled, function, true);
    }

    /// Marks the list as out of date after joints were added, removed or changed.
    pub fn invalidate(&mut self) {
        self.stale = true;
    }

    pub fn disable(&mut self, a: u32, b: u32) {
        let pair = ordered(a, b);
        if let Err(place) = self.disabled.binary_search(&pair) {
            self.disabled.insert(place, pair);
        }
        self.stale = true;
    }

    pub fn enable(&mut self, a: u32, b: u32) {
        if let Ok(place) = self.disabled.binary_search(&ordered(a, b)) {
            self.disabled.remove(place);
        }
        self.stale = true;
    }

    /// Removes the pairs of a removed body.
    pub fn forget(&mut self, body: u32) {
        self.disabled.retain(|&(a, b)| a != body && b != body);
        self.stale = true;
    }

    /// The current filter of shape pairs.
    pub fn filter(&mut self, joints: &Arena<Joint>) -> PairFilter<'_> {
        if core::mem::take(&mut self.stale) {
            let jointed = joints.iter().filter(|(_, joint)| joint.parts_bodies());
            self.all.clear();
            self.all.extend_from_slice(&self.disabled);
            self.all.extend(jointed.map(|(_, joint)| ordered(joint.a, joint.b)));
            self.all.sort_unstable();
            self.all.dedup();
            self.version += 1;
        }
        PairFilter { parted: &self.all, function: self.functions.function(), version: self.version }
    }
}
