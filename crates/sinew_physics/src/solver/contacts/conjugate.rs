//! Faster sweeps where loads have far to go or masses are unequal: each sweep's change of all impulses is a step downhill, and steps
//! downhill are made conjugate (nonsmooth nonlinear conjugate gradients: Silcowitz, Niebe and Erleben 2010).

use super::block::{Block, Bounce, Eight, Memory, packed};
use super::chunks::{Parted, shared};
use super::{Contacts, Visitor, visitor};
use crate::runner::TaskRunner;
use crate::slices::{MOST_NEAR, SharedRows, for_each_near};
use crate::solver::split_off;
use crate::spatial::{Vec6, ZERO6, largest};
use sinew_math::dispatch::{self, Kernel};
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
        self.blocks.reserve(blocks.saturating_sub(self.blocks.len()));
        self.velocities.reserve(bodies);
    }

    /// Blocks stay: they are written over.
    fn clear(&mut self) {
        self.limits.clear();
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
    Note<'a> { list: SharedRows<'a, [Eight; NUMBERS]>, at: usize },
    |self, block, _memory, _bounces| {
        *self.list.get_mut(self.at) = impulses(block);
        self.at += 1;
    }
);

visitor!(
    /// The change of each block's impulses since they were written down.
    Difference<'a> { was: SharedRows<'a, [Eight; NUMBERS]>, at: usize },
    |self, block, _memory, _bounces| {
        let (now, was) = (impulses(block), self.was.get_mut(self.at));
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
        direction: SharedRows<'a, [Eight; NUMBERS]>,
        change: &'a [[Eight; NUMBERS]],
        share: f32,
        at: usize
    },
    |self, block, _memory, _bounces| {
        let (direction, change) = (self.direction.get_mut(self.at), &self.change[self.at]);
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

/// Bodies go on by a share of the direction so far, if any; then the direction is that share and the change of the sweep.
struct GoOnBodies<'a> {
    velocities: &'a mut [Vec6],
    /// Velocities before the sweep.
    was: &'a [Vec6],
    direction: &'a mut [Vec6],
    share: f32,
    /// Largest component by which each body goes on.
    changes: &'a mut [f32],
}

/// Bodies that a thread takes at once, at least.
const BODIES: usize = 256;

impl<'a> GoOnBodies<'a> {
    /// Divides it where there is much to do.
    fn run_on(self, runner: &dyn TaskRunner) {
        let count = usize::min(self.velocities.len() / BODIES, MOST_NEAR);
        if count < 2 {
            return dispatch::run(self);
        }
        let mut parts = [const { None }; MOST_NEAR];
        let mut rest = self;
        for (number, part) in parts[..count].iter_mut().enumerate() {
            *part = Some(rest.take(rest.velocities.len() / (count - number)));
        }
        for_each_near(runner, &mut parts[..count], |part| {
            if let Some(part) = part.take() {
                dispatch::run(part);
            }
        });
    }

    /// Takes so many bodies from its front.
    fn take(&mut self, count: usize) -> Self {
        let (was, rest) = self.was.split_at(count);
        self.was = rest;
        let velocities = split_off(&mut self.velocities, count);
        let direction = split_off(&mut self.direction, count);
        Self { velocities, was, direction, share: self.share, changes: split_off(&mut self.changes, count) }
    }
}

impl Kernel for GoOnBodies<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { velocities, was, direction, share, changes } = self;
        if share == 0.0 {
            for (i, v) in velocities.iter().enumerate() {
                (L::load(v) - L::load(&was[i])).store(&mut direction[i]);
            }
            return;
        }
        let share = L::splat(share);
        for (i, v) in velocities.iter_mut().enumerate() {
            let now = L::load(v);
            let change = now - L::load(&was[i]);
            let by = L::load(&direction[i]) * share;
            (now + by).store(v);
            (change + by).store(&mut direction[i]);
            let mut sizes = ZERO6;
            by.abs().store(&mut sizes);
            changes[i] = largest(&sizes);
        }
    }
}

/// Declares parts of visitors that go through lists in the order of the blocks.
macro_rules! numbered {
    ($($name:ident)*) => {$(
        impl Parted for $name<'_> {
            fn part(&self, first: usize) -> Self {
                Self { at: first, ..*self }
            }

            fn join(&mut self, part: &Self) {
                self.at = part.at;
            }
        }
    )*};
}

numbered!(Note Difference GoOn);

impl Contacts {
    /// For the blocks of the island, and so many bodies.
    pub(super) fn make_room_for_conjugate(&mut self, bodies: usize) {
        let blocks = self.block_count() + super::prepare::SPARE_BLOCKS;
        self.conjugate.was.make_room(blocks, bodies);
        self.conjugate.direction.make_room(blocks, bodies);
        self.changes.reserve(bodies.saturating_sub(self.changes.len()));
    }

    fn block_count(&self) -> usize {
        self.one.count + self.two.count + self.four.count
    }

    /// Before the first sweep of a pass.
    pub(in crate::solver) fn start_conjugate(&mut self) {
        self.conjugate.energy = 0.0;
    }

    /// Before a sweep. `limits` are impulses of other rows that take part.
    pub(in crate::solver) fn before_conjugate(
        &mut self,
        velocities: &[Vec6],
        limits: &[f32],
        runner: &dyn TaskRunner,
    ) {
        let mut was = core::mem::take(&mut self.conjugate.was);
        was.clear();
        was.blocks.resize(self.block_count(), [[0.0; 8]; NUMBERS]);
        self.each_at_once(runner, Note { list: shared(&mut was.blocks), at: 0 });
        was.velocities.extend_from_slice(velocities);
        was.limits.extend_from_slice(limits);
        self.conjugate.was = was;
    }

    /// After a sweep whose changes had this energy: goes on in the direction so far. What it asks too much of rows, the next sweep
    /// takes back. Tells `moved` of the bodies, in order, and by how much.
    pub(in crate::solver) fn after_conjugate(
        &mut self,
        energy: f32,
        (velocities, limits): (&mut [Vec6], &mut [f32]),
        runner: &dyn TaskRunner,
        mut moved: impl FnMut(usize, f32),
    ) {
        let Conjugate { mut was, mut direction, energy: last } = core::mem::take(&mut self.conjugate);
        self.each_at_once(runner, Difference { was: shared(&mut was.blocks), at: 0 });
        for (was, now) in was.limits.iter_mut().zip(limits.iter()) {
            *was = now - *was;
        }
        let share = if energy > 0.0 && energy < last { energy / last } else { 0.0 };
        direction.velocities.resize(velocities.len(), ZERO6);
        let mut changes = core::mem::take(&mut self.changes);
        changes.resize(velocities.len(), 0.0);
        let bodies = GoOnBodies {
            velocities,
            was: &was.velocities,
            direction: &mut direction.velocities,
            share,
            changes: &mut changes,
        };
        bodies.run_on(runner);
        if share == 0.0 {
            core::mem::swap(&mut direction.blocks, &mut was.blocks);
            core::mem::swap(&mut direction.limits, &mut was.limits);
        } else {
            let go_on = GoOn { direction: shared(&mut direction.blocks), change: &was.blocks, share, at: 0 };
            self.each_at_once(runner, go_on);
            for (i, &change) in changes.iter().enumerate() {
                self.stir(i, change);
                moved(i, change);
            }
            for (i, limit) in limits.iter_mut().enumerate() {
                let by = direction.limits[i] * share;
                *limit += by;
                direction.limits[i] = was.limits[i] + by;
            }
        }
        self.changes = changes;
        self.conjugate = Conjugate { was, direction, energy };
    }
}
