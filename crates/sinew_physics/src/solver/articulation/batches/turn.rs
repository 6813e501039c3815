//! The solve of a batch's trees within a sweep by turns.

use super::node::Side;
use super::solve::{Noted, Way, begin, down, up};
use super::{Batch, TurnVelocities};
use crate::solver::articulation::elimination::{Symmetric, Twist};
use crate::solver::flight::Eight;
use crate::solver::sweep::dirty::DirtyRows;
use crate::spatial::Vec6;
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::{LaneMask, Lanes, WIDTH};

/// Solves the trees of a batch for the impulses that limits and contacts applied in this sweep, starting from the
/// velocities before it, and records how far the bodies moved. Returns the largest velocity change, without the changes
/// by the contacts.
pub(super) struct TurnOfBatch<'a, 'b> {
    pub batch: &'a Batch,
    pub ways: &'a mut [Way],
    /// Impulses of the limits. The contact impulses, computed from their velocity changes, are added.
    pub impulses: &'a mut [Vec6],
    pub velocities: &'a mut TurnVelocities<'b>,
    pub dirty: &'a mut DirtyRows,
}

impl Kernel for TurnOfBatch<'_, '_> {
    type Output = f32;

    #[inline(always)]
    fn run<L: Lanes>(self) -> f32 {
        let Self { batch, ways, impulses, velocities, dirty } = self;
        let TurnVelocities { before, limited, now: velocities } = velocities;
        if !is_pushed::<L>(batch, impulses, limited, velocities) {
            return 0.0;
        }
        let ways = &mut ways[..batch.nodes.len()];
        begin(ways);
        for (i, node) in batch.nodes.iter().enumerate().rev() {
            let [v, w] = difference(batch.twist::<L>(i, velocities), batch.twist(i, limited));
            let [a, b, c, d, e, f] = &node.tensor;
            let tensor = Symmetric([L::load(a), L::load(b), L::load(c), L::load(d), L::load(e), L::load(f)]);
            let [force, torque] = batch.twist::<L>(i, impulses);
            let impulse = [force + v * L::load(&node.mass), torque + tensor.times(w)];
            batch.store(i, impulse, impulses);
            up(ways, (node, i), Side, impulse, None);
        }
        let (mut most, mut moved) = (L::splat(0.0), L::splat(0.0));
        for (i, node) in batch.nodes.iter().enumerate() {
            let [v, w] = down::<L>(ways, (node, i), Side, Noted::Pushes);
            let [v_before, w_before] = batch.twist::<L>(i, before);
            let now = [v_before + v, w_before + w];
            let change = largest(difference(now, batch.twist(i, velocities)));
            most = L::max(most, change);
            moved = L::max(moved, largest(difference(now, batch.twist(i, limited))));
            batch.store(i, now, velocities);
        }
        let mut all: [Eight; 2] = [[0.0; WIDTH]; 2];
        moved.store(&mut all[0]);
        most.store(&mut all[1]);
        let mut largest = 0.0;
        for lane in 0..batch.lanes {
            dirty.mark(batch.trees[lane], all[0][lane]);
            largest = sinew_math::max(largest, all[1][lane]);
        }
        largest
    }
}

/// Returns true if an impulse acted on any of the trees in this sweep.
#[inline(always)]
fn is_pushed<L: Lanes>(batch: &Batch, impulses: &[Vec6], swept: &[Vec6], velocities: &[Vec6]) -> bool {
    let none = L::splat(0.0);
    batch.first.iter().take(batch.lanes).any(|&first| {
        (first..first + batch.nodes.len()).any(|i| {
            let still =
                L::eq(L::load(&impulses[i]), none) & L::eq(L::load(&velocities[i]), L::load(&swept[i]));
            !still.all()
        })
    })
}

#[inline(always)]
fn difference<L: Lanes>(a: Twist<L>, b: Twist<L>) -> Twist<L> {
    [a[0] - b[0], a[1] - b[1]]
}

/// Returns the largest component of a twist.
#[inline(always)]
fn largest<L: Lanes>([v, w]: Twist<L>) -> L {
    let (v, w) = (v.abs(), w.abs());
    L::max(L::max(v.x, L::max(v.y, v.z)), L::max(w.x, L::max(w.y, w.z)))
}
