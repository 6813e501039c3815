//! Trees that lie nearly still. Within a step, rows, factor, limits and answers of a batch stand as long as none of its links has turned
//! by more than a hundredth of a radian since they were written: of a heap at rest that is most of what a substep would do anew.
//!
//! Only directions stand. Positions of joints are corrected at the poses that the velocities lead to, contacts are placed where bodies
//! are, and room of limits goes on along their rows.

use super::tree::Link;
use super::tree_joints::POSITION_TOLERANCE;
use super::{IslandSolver, SolverJoint};
use crate::spatial::ZERO6;
use core::ops::Range;

/// Links of an island whose rows and factors follow their poses.
#[derive(Clone, Debug, Default)]
pub(super) struct Followed {
    ranges: Vec<Range<usize>>,
    /// These are all links.
    all: bool,
    /// Per tree: it may not stand.
    barred: Vec<bool>,
}

impl Followed {
    /// For so many trees.
    pub fn make_room(&mut self, trees: usize) {
        self.ranges.clear();
        self.ranges.reserve(trees + 1);
        self.barred.clear();
        self.barred.reserve(trees);
    }

    /// Links, range by range.
    pub fn ranges(&self) -> &[Range<usize>] {
        &self.ranges
    }

    /// True if no tree stands.
    pub fn are_all(&self) -> bool {
        self.all
    }

    /// Calls `act` for the joints of these links, and where no tree stands for all others, too.
    pub fn each_joint(&self, joints: &mut [SolverJoint], links: &[Link], mut act: impl FnMut(&mut SolverJoint)) {
        if self.all {
            joints.iter_mut().for_each(act);
            return;
        }
        for link in self.ranges.iter().flat_map(|range| &links[range.clone()]) {
            if let Some(joint) = joints.get_mut(link.joint as usize) {
                act(joint);
            }
        }
    }
}

impl IslandSolver {
    /// All trees follow their poses.
    pub(super) fn follow_all(&mut self) {
        self.followed.ranges.clear();
        self.followed.ranges.push(0..self.links.len());
        self.followed.all = true;
        self.batches.let_none_stand();
    }

    /// Before bodies move as their velocities say: which trees stand then. Their joints hold, and their limits have so much room less.
    pub(super) fn choose_followed(&mut self) {
        if self.batches.are_none() {
            return;
        }
        let Self { batches, followed, limits, joints, links, trees, velocities, scratch, h, .. } = self;
        let Followed { ranges, all, barred } = followed;
        barred.clear();
        barred.extend(scratch.errors.iter().map(|error| *error >= POSITION_TOLERANCE));
        for row in limits.iter().filter(|row| !row.may_stand()) {
            barred[row.tree_among(joints, links)] = true;
        }
        batches.choose_standing(trees, velocities, *h, barred);
        ranges.clear();
        for (_, tree) in trees.iter().enumerate().filter(|(tree, _)| !batches.stand(*tree)) {
            match ranges.last_mut() {
                Some(last) if last.end == tree.start => last.end = tree.end,
                _ => ranges.push(tree.clone()),
            }
        }
        *all = ranges.first().is_some_and(|range| *range == (0..links.len()));
        if *all {
            return;
        }
        for row in limits.iter_mut() {
            if batches.stand(row.tree_among(joints, links)) {
                row.advance(&joints[row.joint as usize], velocities, *h);
            }
        }
        for (_, range) in trees.iter().enumerate().filter(|(tree, _)| batches.stand(*tree)) {
            for link in &links[range.clone()] {
                if let Some(joint) = joints.get_mut(link.joint as usize) {
                    (joint.rows.error, joint.left_open) = (ZERO6, ZERO6);
                }
            }
        }
    }
}
