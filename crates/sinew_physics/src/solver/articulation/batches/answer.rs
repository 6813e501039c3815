//! Velocity changes of one batched tree from unit impulses of up to eight rows, one row in each lane.

use super::Batch;
use super::node::One;
use super::solve::{Noted, Way, begin, down, up};
use crate::solver::articulation::elimination::zero;
use crate::solver::articulation::response::Push;
use crate::spatial::Vec6;
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::Lanes;

/// Writes columns, `stride` apart: the velocity changes of all links of a tree. Each column is for one row, whose
/// impulse acts on one or two links, given by their indices in the tree.
pub(super) struct AnswerRows<'a> {
    pub batch: &'a Batch,
    /// Lane of the tree in the batch.
    pub lane: usize,
    pub ways: &'a mut [Way],
    pub pushes: &'a [[Push<'a>; 2]],
    pub columns: &'a mut [Vec6],
    pub stride: usize,
}

impl Kernel for AnswerRows<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { batch, lane, ways, pushes, columns, stride } = self;
        let (view, nodes) = (One(lane), &batch.nodes[..]);
        let ways = &mut ways[..nodes.len()];
        begin(ways);
        // Bit set of the links that receive an impulse, directly or on its way to the root.
        let mut pushed = 0_u32;
        for (k, pushes) in pushes.iter().enumerate() {
            for &(place, impulse) in pushes.iter().flatten() {
                pushed |= 1 << place;
                for (row, number) in ways[place].twist.iter_mut().zip(impulse) {
                    row[k] += number;
                }
            }
        }
        for (i, node) in nodes.iter().enumerate().rev() {
            if pushed & 1 << i != 0 {
                up(ways, (node, i), view, [zero::<L>(), zero()], None);
                pushed |= 1_u32.checked_shl(node.site.parent).unwrap_or(0);
            }
        }
        let none = L::splat(0.0);
        for (i, node) in nodes.iter().enumerate() {
            let noted = if pushed & 1 << i == 0 { Noted::Nothing } else { Noted::Pushes };
            let [v, w] = down::<L>(ways, (node, i), view, noted);
            let of_columns = L::transpose([v.x, v.y, v.z, w.x, w.y, w.z, none, none]);
            for (k, column) in of_columns.into_iter().enumerate().take(pushes.len()) {
                column.store(&mut columns[k * stride + i]);
            }
        }
    }
}
