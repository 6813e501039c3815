//! Solves the blocks of one colour on several threads. No two of them push the same body, so threads may take them in any order.
//!
//! DETERMINISM: colours are divided in the same way for every number of threads, and the sums of the parts are added in their order.
#![allow(unsafe_code)]

use super::Contacts;
use super::block::{Block, Memory, ZERO8};
use super::visit::Sweep;
use crate::runner::TaskRunner;
use crate::slices::{MOST_NEAR, SharedRows, for_each_near};
use crate::solver::contacts::classes::{Class, Color, Visitor};
use crate::solver::sweep::policy::Order;
use core::ops::Range;
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{Lanes, WIDTH};
use sinew_math::max;

/// Number of blocks in a chunk: a few µs of work, several times the cost of scheduling it on a thread.
const CHUNK: usize = 12;
/// Number of blocks below which a colour is not divided.
const DIVIDED: usize = 3 * CHUNK;
/// Largest number of chunks of a colour; a colour with more blocks has larger chunks.
const MOST_CHUNKS: usize = MOST_NEAR;

/// A visitor that can be split into parts, which visit blocks of one colour at the same time. It does not use bounces.
pub(super) trait Parted: Visitor + Send {
    /// Creates a visitor for a part of the blocks.
    fn part(&self) -> Self;
    /// Adds the sums of a part.
    fn join(&mut self, part: &Self);
}

/// Makes rows that visitors share: those of bodies, or data of one block.
pub(super) fn shared<T>(rows: &mut [T]) -> SharedRows<'_, T> {
    // SAFETY: a visit writes rows of moving bodies, which no two blocks of a colour share (`Coloring`), and data of its own block. It also
    // reads rows of fixed bodies, which no visit writes. A reference to a row ends within the visit, and a colour within `for_each_near`.
    unsafe { SharedRows::new(rows) }
}

/// A run of neighbouring blocks of a class.
#[derive(Default)]
pub(super) struct Run<'a, const N: usize, const T: usize> {
    pub blocks: &'a mut [Block<N, T>],
    pub memory: &'a mut [Memory<N>],
}

impl<'a, const N: usize, const T: usize> Run<'a, N, T> {
    fn of(class: &'a mut Class<N, T>, range: &Range<usize>) -> Self {
        Self { blocks: &mut class.blocks[range.clone()], memory: &mut class.memory[range.clone()] }
    }

    pub fn all(class: &'a mut Class<N, T>) -> Self {
        let all = 0..class.count;
        Self::of(class, &all)
    }

    /// Takes `count` blocks from the front.
    pub fn take(&mut self, count: usize) -> Self {
        let (blocks, rest) = core::mem::take(&mut self.blocks).split_at_mut(count);
        let (memory, of_rest) = core::mem::take(&mut self.memory).split_at_mut(count);
        (self.blocks, self.memory) = (rest, of_rest);
        Self { blocks, memory }
    }

    #[inline(always)]
    fn visit<L: Lanes, V: Visitor>(&mut self, visitor: &mut V) {
        for (block, memory) in self.blocks.iter_mut().zip(self.memory.iter_mut()) {
            visitor.visit::<L, N, T>(block, memory, &mut []);
        }
    }
}

/// All or some of the blocks of one colour.
struct Chunk<'a> {
    one: Run<'a, 1, 1>,
    two: Run<'a, 2, 3>,
    four: Run<'a, 4, 10>,
}

impl Chunk<'_> {
    fn len(&self) -> usize {
        self.one.blocks.len() + self.two.blocks.len() + self.four.blocks.len()
    }

    /// Takes the first of `parts` equal parts of each class. Contacts of a class are in the order of their bodies, so the same part of each
    /// colour uses mostly the same bodies.
    fn take_part_of(&mut self, parts: usize) -> Self {
        let of = |blocks: usize| blocks.div_ceil(parts);
        let (one, two, four) = (self.one.blocks.len(), self.two.blocks.len(), self.four.blocks.len());
        Self { one: self.one.take(of(one)), two: self.two.take(of(two)), four: self.four.take(of(four)) }
    }
}

/// Visits the blocks of a chunk.
struct Visit<'a, 'b, V> {
    chunk: &'a mut Chunk<'b>,
    visitor: &'a mut V,
}

impl<V: Visitor> Kernel for Visit<'_, '_, V> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { chunk, visitor } = self;
        chunk.one.visit::<L, V>(visitor);
        chunk.two.visit::<L, V>(visitor);
        chunk.four.visit::<L, V>(visitor);
    }
}

/// Visits all blocks of a chunk that is at least as large as a colour.
fn visit_all<V: Parted>(mut all: Chunk<'_>, visitor: &mut V, runner: &dyn TaskRunner) {
    let blocks = all.len();
    if blocks < DIVIDED {
        dispatch::run(Visit { chunk: &mut all, visitor });
        return;
    }
    let count = usize::min(blocks / CHUNK, MOST_CHUNKS);
    let mut parts: [_; MOST_CHUNKS] = core::array::from_fn(|number| {
        let left = count.checked_sub(number).filter(|&left| left > 0)?;
        Some((all.take_part_of(left), visitor.part()))
    });
    for_each_near(runner, &mut parts[..count], |part| {
        if let Some((chunk, visitor)) = part {
            dispatch::run(Visit { chunk, visitor });
        }
    });
    for (_, part) in parts[..count].iter().flatten() {
        visitor.join(part);
    }
}

impl Contacts {
    /// Visits every block, colour by colour, on all threads.
    pub(super) fn each_parted<V: Parted>(
        &mut self,
        runner: &dyn TaskRunner,
        order: Order,
        mut visitor: V,
    ) -> V {
        let Self { one, two, four, colors, .. } = self;
        let count = colors.len();
        for turn in 0..count {
            let Color { one: ones, two: twos, four: fours } =
                &colors[if order == Order::ToAndFro { count - 1 - turn } else { turn }];
            let color =
                Chunk { one: Run::of(one, ones), two: Run::of(two, twos), four: Run::of(four, fours) };
            visit_all(color, &mut visitor, runner);
        }
        visitor
    }

    /// Visits every block in the order of classes, on all threads. The visitor must not read body data that other visits write.
    pub(super) fn each_at_once<V: Parted>(&mut self, runner: &dyn TaskRunner, mut visitor: V) -> V {
        let Self { one, two, four, .. } = self;
        let chunk = Chunk { one: Run::all(one), two: Run::all(two), four: Run::all(four) };
        visit_all(chunk, &mut visitor, runner);
        visitor
    }
}

/// Implements [`Parted`] for visitors whose parts are copies and that sum up nothing.
macro_rules! parted {
    ($name:ty) => {
        impl Parted for $name {
            fn part(&self) -> Self {
                Self { ..*self }
            }

            fn join(&mut self, _part: &Self) {}
        }
    };
}

pub(super) use parted;

impl Parted for Sweep<'_> {
    fn part(&self) -> Self {
        Self { largest: ZERO8, energy: ZERO8, ..*self }
    }

    fn join(&mut self, part: &Self) {
        for lane in 0..WIDTH {
            self.largest[lane] = max(self.largest[lane], part.largest[lane]);
            self.energy[lane] += part.energy[lane];
        }
    }
}
