//! Rows that need another visit, as told by how much the velocities of their trees have changed.

use crate::solver::articulation::tree::Link;
use crate::solver::limits::row::LimitRow;

/// Velocity changes of each tree in a pass, summed, m/s or rad/s: rows whose trees lie still need no further visit, and in a
/// heap most of them do after a few sweeps.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct DirtyRows {
    /// A change below it is none.
    tolerance: f32,
    trees: Vec<f32>,
    /// Per manifold and per block of limits: the sum of its trees when it was last visited.
    manifolds: Vec<f32>,
    limits: Vec<f32>,
    /// Per tree: its sum when the pass was resumed.
    corrected: Vec<f32>,
}

impl DirtyRows {
    pub fn start(&mut self, tolerance: f32, trees: usize, manifolds: usize, limits: usize) {
        self.tolerance = tolerance;
        for (list, count, start) in [
            (&mut self.trees, trees, 0.0),
            (&mut self.manifolds, manifolds, f32::NEG_INFINITY),
            (&mut self.limits, limits, f32::NEG_INFINITY),
        ] {
            list.clear();
            list.resize(count, start);
        }
    }

    /// Goes on with a pass in which limits have got rows more, those from `first` on; so many blocks there are now.
    pub fn resume(&mut self, blocks: usize, new: &[LimitRow]) {
        self.limits.resize(blocks, f32::NEG_INFINITY);
        for row in new {
            self.limits[row.block as usize] = f32::NEG_INFINITY;
        }
        self.corrected.clear();
        self.corrected.extend_from_slice(&self.trees);
    }

    /// True of a tree whose velocities have changed since the pass was [resumed](Self::resume).
    pub fn has_changed(&self, tree: usize) -> bool {
        self.trees[tree] != self.corrected[tree]
    }

    /// Sum of the changes of the trees of two bodies.
    pub fn of(&self, links: &[Link], a: u32, b: u32) -> f32 {
        let tree = |body: u32| links.get(body as usize).map_or(0.0, |link| self.trees[link.tree as usize]);
        tree(a) + tree(b)
    }

    /// A tree's velocities have changed by this much.
    #[inline(always)]
    pub fn mark(&mut self, tree: u32, change: f32) {
        if let Some(sum) = self.trees.get_mut(tree as usize) {
            *sum += change;
        }
    }

    /// A row whose impulses have changed what they make of a velocity by this needs a visit, whatever its trees do.
    pub fn mark_manifold(&mut self, i: usize, change: f32) {
        if change >= self.tolerance {
            self.manifolds[i] = f32::NEG_INFINITY;
        }
    }

    /// Marks a block of limits for a visit if its own change asks for one.
    pub fn mark_limits(&mut self, block: u32, change: f32) {
        if change >= self.tolerance {
            self.limits[block as usize] = f32::NEG_INFINITY;
        }
    }

    pub(super) fn wakes_manifold(&mut self, i: usize, now: f32) -> bool {
        wakes(&mut self.manifolds[i], now, self.tolerance)
    }

    pub fn wakes_limits(&mut self, block: usize, now: f32) -> bool {
        wakes(&mut self.limits[block], now, self.tolerance)
    }

    /// A block of limits need not be visited before its trees change again.
    pub fn see_limits(&mut self, block: usize, now: f32) {
        self.limits[block] = now;
    }
}

/// True if enough has happened since the last visit; then this counts as the last one.
fn wakes(seen: &mut f32, now: f32, tolerance: f32) -> bool {
    let wakes = now - *seen >= tolerance;
    if wakes {
        *seen = now;
    }
    wakes
}
