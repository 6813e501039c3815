//! Blocks by number of points, and kernels that visit all of them colour by colour.

use super::block::{Block, Bounce, Memory};
use core::ops::Range;
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::Lanes;

/// Blocks of manifolds with up to `N` points.
#[derive(Clone, Debug, Default)]
pub(super) struct Class<const N: usize, const T: usize> {
    pub(super) blocks: Vec<Block<N, T>>,
    pub(super) memory: Vec<Memory<N>>,
    pub(super) bounces: Vec<Bounce<N>>,
    /// Number of blocks in use; the memory of unused blocks is kept for the next island.
    pub(super) count: usize,
}

/// Blocks of one colour, in each class.
#[derive(Clone, Debug, Default)]
pub(super) struct Color {
    pub(super) one: Range<usize>,
    pub(super) two: Range<usize>,
    pub(super) four: Range<usize>,
}

impl<const N: usize, const T: usize> Class<N, T> {
    /// Size of the blocks that a sweep reads, bytes, without their stored impulses.
    pub(super) fn swept_bytes(&self) -> usize {
        self.count * size_of::<Block<N, T>>()
    }

    pub(super) fn bytes(&self) -> usize {
        self.count * (size_of::<Block<N, T>>() + size_of::<Memory<N>>())
    }
}

/// An operation on each block.
pub(super) trait Visitor {
    fn visit<L: Lanes, const N: usize, const T: usize>(
        &mut self,
        block: &mut Block<N, T>,
        memory: &mut Memory<N>,
        bounces: &mut [Bounce<N>],
    );
}

/// Visits all blocks of one class.
#[inline(always)]
pub(super) fn each<L: Lanes, V: Visitor, const N: usize, const T: usize>(
    class: &mut Class<N, T>,
    range: &Range<usize>,
    visitor: &mut V,
) {
    let Class { blocks, memory, bounces, .. } = class;
    for i in range.clone() {
        visitor.visit::<L, N, T>(&mut blocks[i], &mut memory[i], bounces);
    }
}

/// Visits all blocks, colour by colour.
pub(super) struct Each<'a, V> {
    pub(super) one: &'a mut Class<1, 1>,
    pub(super) two: &'a mut Class<2, 3>,
    pub(super) four: &'a mut Class<4, 10>,
    pub(super) colors: &'a [Color],
    pub(super) visitor: V,
}

impl<V: Visitor> Kernel for Each<'_, V> {
    type Output = V;

    #[inline(always)]
    fn run<L: Lanes>(mut self) -> V {
        for color in self.colors {
            each::<L, V, 1, 1>(self.one, &color.one, &mut self.visitor);
            each::<L, V, 2, 3>(self.two, &color.two, &mut self.visitor);
            each::<L, V, 4, 10>(self.four, &color.four, &mut self.visitor);
        }
        self.visitor
    }
}
