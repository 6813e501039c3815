//! Faster sweeps where loads have far to go or masses are unequal: each sweep's change of all impulses is a step downhill, and steps
//! downhill are made conjugate (nonsmooth nonlinear conjugate gradients: Silcowitz, Niebe and Erleben 2010).

use super::block::{Block, Bounce, Eight, Memory, packed};
use super::{Contacts, Visitor, visitor};
use crate::spatial::{Vec6, add_scaled, largest};
use sinew_math::lanes::Lanes;
use sinew_math::max;

/// Numbers of a block's impulses that take part: four points, two of friction, twist.
const NUMBERS: usize = 7;

/// Where a pass stands. What lists hold of a pass before is never used: its first sweep has no energy to go on from.
#[derive(Clone, Debug, Default)]
pub(super) struct Conjugate {
    /// Before the sweep, then its change.
    was: State,
    /// To go on in.
    direction: State,
    /// Energy of the changes of the last sweep, J.
    energy: f32,
}

/// Impulses of all blocks, in the order of their visits, and the velocities of all bodies.
#[derive(Clone, Debug, Default)]
struct State {
    blocks: Vec<[Eight; NUMBERS]>,
    velocities: Vec<Vec6>,
    limits: Vec<f32>,
}

impl State {
    /// For so many blocks and bodies: memory is there when the first pass goes on for so long.
    fn make_room(&mut self, blocks: usize, bodies: usize) {
        self.clear();
        self.blocks.reserve(blocks);
        self.velocities.reserve(bodies);
    }

    fn clear(&mut self) {
        self.limits.clear();
        self.blocks.clear();
        self.velocities.clear();
    }
}

/// The impulses of a block.
#[inline(always)]
fn impulses<const N: usize, const T: usize>(block: &Block<N, T>) -> [Eight; NUMBERS] {
    let mut all = [[0.0; 8]; NUMBERS];
    all[..N].copy_from_slice(&block.impulse);
    all[4..6].copy_from_slice(&block.friction);
    all[6] = block.twist;
    all
}

visitor!(
    /// Writes down the impulses of each block.
    Note<'a> { list: &'a mut Vec<[Eight; NUMBERS]> },
    |self, block, _memory, _bounces| self.list.push(impulses(block))
);

visitor!(
    /// The change of each block's impulses since they were written down.
    Difference<'a> { was: &'a mut [[Eight; NUMBERS]], at: usize },
    |self, block, _memory, _bounces| {
        let (now, was) = (impulses(block), &mut self.was[self.at]);
        for k in 0..NUMBERS {
            (L::load(&now[k]) - L::load(&was[k])).store(&mut was[k]);
        }
        self.at += 1;
    }
);

visitor!(
    /// Adds a share of the direction so far to each block; then the direction is that share and the change. What a row has changed of
    /// its own velocity counts for its next visit, however little at a time: what nobody visits would run away.
    GoOn<'a> {
        direction: &'a mut [[Eight; NUMBERS]],
        change: &'a [[Eight; NUMBERS]],
        share: f32,
        at: usize
    },
    |self, block, _memory, _bounces| {
        let (direction, change) = (&mut self.direction[self.at], &self.change[self.at]);
        let share = L::splat(self.share);
        let mut most = L::splat(0.0);
        for k in 0..NUMBERS {
            let more = L::load(&direction[k]) * share;
            (L::load(&change[k]) + more).store(&mut direction[k]);
            let (to, response) = match k {
                0..4 if k < N => (&mut block.impulse[k], &block.response[packed(k, k)]),
                4..6 => (&mut block.friction[k - 4], &block.tangent_response[2 * (k - 4)]),
                6 => (&mut block.twist, &block.twist_response),
                _ => continue,
            };
            (L::load(to) + more).store(to);
            most = L::max(most, more.abs() * L::load(response));
        }
        let mut by = [0.0; 8];
        most.store(&mut by);
        block.seen -= by.into_iter().fold(0.0, max);
        self.at += 1;
    }
);

impl Contacts {
    /// For the blocks of the island, and so many bodies.
    pub(super) fn make_room_for_conjugate(&mut self, bodies: usize) {
        let blocks = self.one.count + self.two.count + self.four.count;
        let blocks = blocks + super::prepare::SPARE_BLOCKS;
        self.conjugate.was.make_room(blocks, bodies);
        self.conjugate.direction.make_room(blocks, bodies);
    }

    /// Before the first sweep of a pass.
    pub(in crate::solver) fn start_conjugate(&mut self) {
        self.conjugate.energy = 0.0;
    }

    /// Before a sweep. `limits` are impulses of other rows that take part.
    pub(in crate::solver) fn before_conjugate(&mut self, velocities: &[Vec6], limits: &[f32]) {
        let mut was = core::mem::take(&mut self.conjugate.was);
        was.clear();
        self.each(Note { list: &mut was.blocks });
        was.velocities.extend_from_slice(velocities);
        was.limits.extend_from_slice(limits);
        self.conjugate.was = was;
    }

    /// After a sweep whose changes had this energy: goes on in the direction so far. What it asks too much of rows, the next sweep
    /// takes back. Tells `moved` of the bodies, in order, and by how much.
    pub(in crate::solver) fn after_conjugate(
        &mut self,
        energy: f32,
        velocities: &mut [Vec6],
        limits: &mut [f32],
        mut moved: impl FnMut(usize, f32),
    ) {
        let Conjugate { mut was, mut direction, energy: last } = core::mem::take(&mut self.conjugate);
        self.each(Difference { was: &mut was.blocks, at: 0 });
        for (was, now) in was.velocities.iter_mut().zip(velocities.iter()) {
            for (was, now) in was.iter_mut().zip(now) {
                *was = now - *was;
            }
        }
        for (was, now) in was.limits.iter_mut().zip(limits.iter()) {
            *was = now - *was;
        }
        let share = if energy > 0.0 && energy < last { energy / last } else { 0.0 };
        if share == 0.0 {
            core::mem::swap(&mut direction, &mut was);
        } else {
            self.each(GoOn { direction: &mut direction.blocks, change: &was.blocks, share, at: 0 });
            for (i, v) in velocities.iter_mut().enumerate() {
                let by = direction.velocities[i].map(|d| d * share);
                add_scaled(v, &by, 1.0);
                let change = largest(&by);
                self.stir(i, change);
                moved(i, change);
                direction.velocities[i] = was.velocities[i];
                add_scaled(&mut direction.velocities[i], &by, 1.0);
            }
            for (i, limit) in limits.iter_mut().enumerate() {
                let by = direction.limits[i] * share;
                *limit += by;
                direction.limits[i] = was.limits[i] + by;
            }
        }
        self.conjugate = Conjugate { was, direction, energy };
    }
}
