//! Decides which rows need another visit, by the changes of the velocities of their trees.

use crate::solver::articulation::tree::Link;
use crate::solver::limits::row::LimitRow;

/// Sum of the velocity changes of each tree in a pass, m/s or rad/s. Rows whose trees do not change need no further
/// visit; in a heap these are most rows after a few sweeps.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct DirtyRows {
    /// Change below which changes are ignored, m/s or rad/s.
    tolerance: f32,
    trees: Vec<f32>,
    /// For each manifold and each block of limits: sum of the changes of its trees at the last visit.
    manifolds: Vec<f32>,
    limits: Vec<f32>,
    /// Sum of each tree at the time when the pass was resumed.
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

    /// Resumes a pass after limits gained the rows `new`; `blocks` is the new number of blocks.
    pub fn resume(&mut self, blocks: usize, new: &[LimitRow]) {
        self.limits.resize(blocks, f32::NEG_INFINITY);
        for row in new {
            self.limits[row.block as usize] = f32::NEG_INFINITY;
        }
        self.corrected.clear();
        self.corrected.extend_from_slice(&self.trees);
    }

    /// True for a tree whose velocities changed after the pass was [resumed](Self::resume).
    pub fn has_changed(&self, tree: usize) -> bool {
        self.trees[tree] != self.corrected[tree]
    }

    /// Sum of the changes of the trees of two bodies.
    pub fn of(&self, links: &[Link], a: u32, b: u32) -> f32 {
        let tree = |body: u32| links.get(body as usize).map_or(0.0, |link| self.trees[link.tree as usize]);
        tree(a) + tree(b)
    }

    /// Adds a change to the sum of a tree.
    #[inline(always)]
    pub fn mark(&mut self, tree: u32, change: f32) {
        if let Some(sum) = self.trees.get_mut(tree as usize) {
            *sum += change;
        }
    }

    /// Marks a manifold for a visit if its own impulses changed a velocity by at least the tolerance.
    pub fn mark_manifold(&mut self, i: usize, change: f32) {
        if change >= self.tolerance {
            self.manifolds[i] = f32::NEG_INFINITY;
        }
    }

    /// Marks a block of limits for a visit if its own impulses changed a velocity by at least the tolerance.
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

    /// Records that a block of limits needs no visit before its trees change again.
    pub fn see_limits(&mut self, block: usize, now: f32) {
        self.limits[block] = now;
    }
}

/// True if the sum grew by the tolerance since the last visit; then records this visit as the last one.
fn wakes(seen: &mut f32, now: f32, tolerance: f32) -> bool {
    let wakes = now - *seen >= tolerance;
    if wakes {
        *seen = now;
    }
    wakes
}
