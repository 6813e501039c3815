//! Limits in blocks of up to eight rows of one tree, rows with an impulse first. The rates of a block are computed in lanes. Rows that push
//! are solved among each other by a dense response matrix, and the bodies then receive all impulses at once: the change of one row
//! updates eight rates instead of all links of the tree.

use crate::solver::IslandSolver;
use crate::solver::articulation::response_cache::ResponseCache;
use crate::solver::articulation::tree::NONE;
use crate::solver::body::add_row;
use crate::solver::limits::row::LimitRow;
use crate::solver::pass::{Coupling, Pass};
use crate::solver::tuning::LIMIT_ROUNDS;
use crate::spatial::{Vec6, ZERO6};
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{LaneMask, Lanes, WIDTH};
use sinew_math::max;

/// The blocks of an island.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct LimitBlocks {
    blocks: Vec<Block>,
    /// Last block of the rows of each tree.
    last: Vec<u32>,
    /// Number of rows that are in a block: the first rows of the list.
    placed: usize,
}

/// Rows of one tree, or one row between two trees, one in each lane.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
struct Block {
    /// Jacobians on A, then on B.
    rows: [[f32; WIDTH]; 12],
    /// Rate of each row below which the row pushes.
    threshold: [f32; WIDTH],
    /// Change of all rates by a unit impulse of each row.
    response: [[f32; WIDTH]; WIDTH],
    bodies: [[u32; WIDTH]; 2],
    /// Index of each row in the island's list of limits.
    limits: [u32; WIDTH],
    /// Column of each row, and the positions of its bodies in columns.
    columns: [usize; WIDTH],
    places: [[Option<usize>; 2]; WIDTH],
    count: usize,
    /// Bit mask of rows that begin the pass with an impulse.
    warm: u8,
    /// Bit mask of rows that push or pushed at this pose, and so have columns.
    pushing: u8,
}

/// Lanes whose bits are set.
fn lanes(bits: u8) -> impl Iterator<Item = usize> {
    (0..WIDTH).filter(move |k| bits & 1 << k != 0)
}

impl Block {
    const EMPTY: Self = Self {
        rows: [ZERO6; 12],
        threshold: ZERO6,
        response: [ZERO6; WIDTH],
        bodies: [[0; WIDTH]; 2],
        limits: [0; WIDTH],
        columns: [0; WIDTH],
        places: [[None; 2]; WIDTH],
        count: 0,
        warm: 0,
        pushing: 0,
    };

    /// Adds row number `limit` of the island, which acts on two bodies.
    fn push(&mut self, limit: usize, bodies: [u32; 2], row: &LimitRow) {
        let k = self.count;
        for (row, number) in self.rows.iter_mut().zip(row.row.a[..6].iter().chain(&row.row.b[..6])) {
            row[k] = *number;
        }
        (self.bodies[0][k], self.bodies[1][k]) = (bodies[0], bodies[1]);
        self.limits[k] = limit as u32;
        self.count += 1;
    }

    /// Bodies of a row.
    fn ends(&self, k: usize) -> [u32; 2] {
        [self.bodies[0][k], self.bodies[1][k]]
    }

    /// Visits the rows that push until their rates change by less than `tolerance`. Returns the changes of their impulses, the sum of the
    /// energies of these changes, and the largest change of a rate in the last round.
    fn solve(
        &self,
        limits: &mut [LimitRow],
        mut rates: [f32; WIDTH],
        (pass, h, tolerance): (Pass, f32, f32),
    ) -> ([f32; WIDTH], f32, f32) {
        let (mut given, mut energy, mut most) = ([0.0; WIDTH], 0.0, 0.0);
        for _ in 0..LIMIT_ROUNDS {
            most = 0.0;
            for k in lanes(self.pushing) {
                let row = &mut limits[self.limits[k] as usize];
                let threshold = self.threshold[k];
                if threshold == f32::NEG_INFINITY || row.impulse == 0.0 && rates[k] >= threshold {
                    continue;
                }
                let change = row.change(pass, rates[k], h);
                given[k] += change;
                for (rate, response) in rates.iter_mut().zip(&self.response[k]) {
                    *rate += response * change;
                }
                let of_rate = change * self.response[k][k];
                energy += change * of_rate;
                most = max(most, of_rate.abs());
            }
            if most < tolerance {
                break;
            }
        }
        (given, energy, most)
    }
}

/// Computes the rates of the rows of a block and the mask of those below their thresholds.
struct Look<'a> {
    block: &'a Block,
    velocities: &'a [Vec6],
}

impl Kernel for Look<'_> {
    type Output = ([f32; WIDTH], u8);

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        let Self { block, velocities } = self;
        let mut rate = L::splat(0.0);
        for (bodies, rows) in block.bodies.iter().zip([&block.rows[..6], &block.rows[6..]]) {
            let mut of_bodies = [rate; WIDTH];
            for k in 0..WIDTH {
                of_bodies[k] = L::load(&velocities[bodies[k] as usize]);
            }
            let v = L::transpose(of_bodies);
            for (row, v) in rows.iter().zip(v) {
                rate = rate + L::load(row) * v;
            }
        }
        let mut rates = ZERO6;
        rate.store(&mut rates);
        (rates, !L::ge(rate, L::load(&block.threshold)).bits())
    }
}

impl LimitBlocks {
    /// Removes all blocks, for an island of `trees` trees.
    pub fn clear(&mut self, trees: usize) {
        self.blocks.clear();
        self.last.clear();
        self.last.resize(trees, NONE);
        self.placed = 0;
    }

    /// Number of rows, from the first on, that are in a block.
    pub fn placed(&self) -> usize {
        self.placed
    }

    /// Number of blocks.
    pub fn len(&self) -> usize {
        self.blocks.len()
    }

    /// Size of the data in use, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.blocks[..])
    }
}

impl IslandSolver {
    /// Prepares the sweeps of a pass: puts new rows into blocks, those with an impulse first, and computes thresholds.
    pub(in crate::solver) fn arrange_limits(&mut self, pass: Pass) {
        for pushing in [true, false] {
            for i in self.limit_blocks.placed..self.limits.len() {
                if (self.limits[i].impulse != 0.0) == pushing {
                    self.place_limit(i);
                }
            }
        }
        self.limit_blocks.placed = self.limits.len();
        for block in &mut self.limit_blocks.blocks {
            block.warm = 0;
            for k in 0..block.count {
                let row = &self.limits[block.limits[k] as usize];
                block.threshold[k] = row.threshold(pass, self.h);
                block.warm |= u8::from(row.impulse != 0.0) << k;
            }
        }
    }

    /// Puts a row into a block of its tree.
    fn place_limit(&mut self, i: usize) {
        let LimitBlocks { blocks, last, .. } = &mut self.limit_blocks;
        let joint = &self.joints[self.limits[i].joint as usize];
        let bodies = [joint.a, joint.b];
        let tree = match bodies.map(|body| self.links.get(body as usize).map(|link| link.tree)) {
            [Some(a), Some(b)] if a != b => None,
            [a, b] => a.or(b),
        };
        let last = tree.and_then(|tree| last.get_mut(tree as usize));
        let mut at = last.as_ref().map_or(NONE, |last| **last) as usize;
        if blocks.get(at).is_none_or(|block| block.count == WIDTH) {
            at = blocks.len();
            blocks.push(Block::EMPTY);
        }
        if let Some(last) = last {
            *last = at as u32;
        }
        blocks[at].push(i, bodies, &self.limits[i]);
        self.limits[i].block = at as u32;
    }

    /// Visits the blocks whose trees changed.
    pub(in crate::solver) fn visit_limits(&mut self, pass: Pass) {
        for at in 0..self.limit_blocks.len() {
            let [a, b] = self.limit_blocks.blocks[at].ends(0);
            let now = self.dirty.of(&self.links, a, b);
            if self.dirty.wakes_limits(at, now) {
                self.visit_limit_block(at, pass);
            }
        }
    }

    /// Solves the rows of a block that push and applies their impulses to the bodies.
    fn visit_limit_block(&mut self, at: usize, pass: Pass) {
        let block = &mut self.limit_blocks.blocks[at];
        let (rates, below) = dispatch::run(Look { block, velocities: &self.velocities });
        let new = (below & (u8::MAX >> (WIDTH - block.count)) | block.warm) & !block.pushing;
        if new != 0 {
            self.respond_to_limits(at, new);
        }
        let block = &self.limit_blocks.blocks[at];
        if block.pushing == 0 {
            return;
        }
        self.tally.visits += u64::from(block.pushing.count_ones());
        let tolerance = self.policy.tolerance;
        let (given, energy, left) = block.solve(&mut self.limits, rates, (pass, self.h, tolerance));
        if given == ZERO6 {
            return;
        }
        let [a, b] = block.ends(0);
        let moved = self.response_cache.push_all(
            &self.response,
            &self.links,
            [a, b],
            (&block.columns, &given),
            &mut self.velocities,
        );
        if self.coupling == Coupling::Turns {
            for k in lanes(block.pushing) {
                let row = &self.limits[block.limits[k] as usize].row;
                add_row(&mut self.impulses, block.bodies[0][k], &row.a, given[k]);
                add_row(&mut self.impulses, block.bodies[1][k], &row.b, given[k]);
            }
        }
        self.change_energy += energy;
        self.largest_change = max(self.largest_change, moved);
        let trees = [a, b].map(|body| self.links.get(body as usize).map(|link| link.tree));
        for tree in [trees[0], trees[1].filter(|_| trees[0] != trees[1])].into_iter().flatten() {
            self.dirty.mark(tree, moved);
        }
        // The block's own change needs no other visit.
        if left < tolerance {
            let now = self.dirty.of(&self.links, a, b);
            self.dirty.see_limits(at, now);
        }
    }

    /// Computes columns for the rows `new` of a block, and the responses between them and the rows that already push.
    fn respond_to_limits(&mut self, at: usize, new: u8) {
        let Self { limits, limit_blocks, joints, bodies, links, batches, response, response_cache, .. } =
            self;
        let block = &mut limit_blocks.blocks[at];
        let mut rows = [([NONE; 2], [&ZERO6; 2]); WIDTH];
        let mut count = 0;
        for k in lanes(new) {
            let row = &limits[block.limits[k] as usize].row;
            rows[count] = (block.ends(k), [&row.a, &row.b]);
            count += 1;
        }
        let (mut column, stride) = response_cache.add_all(response, (links, batches), &rows[..count]);
        for k in lanes(new) {
            block.columns[k] = column;
            block.places[k] = ResponseCache::places(response, links, block.ends(k));
            block.pushing |= 1 << k;
            for l in lanes(block.pushing) {
                let row = &limits[block.limits[l] as usize].row;
                let answer = response_cache.answer(column, block.places[l], row);
                (block.response[k][l], block.response[l][k]) = (answer, answer);
            }
            column += stride;
        }
        for k in lanes(new) {
            let row = &mut limits[block.limits[k] as usize];
            row.take_response(block.response[k][k], &joints[row.joint as usize], bodies, links.len());
        }
    }
}
