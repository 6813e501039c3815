//! Many pairs of boxes.

use super::record::{NUMBERS, Record};
use super::separation::{Best, Relative, SeparatingAxis, Separation};
use crate::boxes::Obb;
use crate::boxes::fifteen::FifteenAxes;
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{Block, Blocks, LaneMask, Lanes, WIDTH};

/// Pairs of boxes, stored in groups of eight: 80 bytes per pair.
#[derive(Clone, Debug, Default)]
pub struct Pairs(Blocks<{ 2 * NUMBERS }>);

/// Results of [`Pairs::separations`], in the order of the pairs: 8 bytes per pair.
#[derive(Clone, Debug, Default)]
pub struct Separations(Blocks<2>);

impl Pairs {
    /// Creates an empty list.
    pub fn new() -> Self {
        Self::default()
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// True if there are no pairs.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Adds the pair of `a` and `b` at the end.
    pub fn push(&mut self, a: &Obb, b: &Obb) {
        let mut pair = [0.0; 2 * NUMBERS];
        pair[..NUMBERS].copy_from_slice(&Record::of(a).to_array());
        pair[NUMBERS..].copy_from_slice(&Record::of(b).to_array());
        self.0.push(pair);
    }

    /// Removes all pairs and keeps the memory.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Finds the pairs that overlap, by all fifteen axes; the result for each pair is exactly that of
    /// [`Overlap::overlaps`](crate::boxes::Overlap::overlaps). Bit `k` of `overlapping[i]` is set if pair `8 i + k`
    /// overlaps; bits beyond the last pair are 0. A pair with NaN does not overlap.
    ///
    /// # Panics
    /// If `overlapping` does not have one byte for every eight pairs, rounded up.
    pub fn overlaps(&self, overlapping: &mut [u8]) {
        dispatch::run(FindOverlaps { pairs: self, overlapping });
    }

    /// Finds, for each pair, the axis among the fifteen with the largest gap or the least overlap; the result is
    /// exactly that of [`Separation::between`]. Resizes `found` to the number of pairs, and allocates only if `found`
    /// must grow.
    pub fn separations(&self, found: &mut Separations) {
        dispatch::run(FindSeparations { pairs: self, axes: Axes::Fifteen, found });
    }

    /// Like [`separations`](Self::separations), for the six face axes only, at a third of the cost. The distance is at
    /// most that of all fifteen axes: gaps may be underestimated, and depths overestimated.
    pub fn face_separations(&self, found: &mut Separations) {
        dispatch::run(FindSeparations { pairs: self, axes: Axes::Faces, found });
    }
}

/// Set of axes to test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// The three axes of each box.
    Faces,
    /// The three axes of each box, and the cross products of an axis of A and an axis of B.
    Fifteen,
}

impl Separations {
    /// Creates an empty list.
    pub fn new() -> Self {
        Self::default()
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// True if there are no pairs.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Result for pair `index`.
    ///
    /// # Panics
    /// If the index is out of range.
    #[inline]
    pub fn get(&self, index: usize) -> Separation {
        let [distance, axis] = self.0.get(index);
        Separation { distance, axis: SeparatingAxis::from_index(axis as u8) }
    }

    /// Iterates over the results of all pairs, in order.
    pub fn iter(&self) -> impl Iterator<Item = Separation> + '_ {
        (0..self.len()).map(|index| self.get(index))
    }
}

/// Kernel of [`Pairs::overlaps`], for callers that choose the SIMD type.
#[derive(Debug)]
pub struct FindOverlaps<'a> {
    /// Pairs of boxes to test.
    pub pairs: &'a Pairs,
    /// Output: one byte for every eight pairs.
    pub overlapping: &'a mut [u8],
}

impl Kernel for FindOverlaps<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let blocks = self.pairs.0.blocks();
        assert_eq!(
            self.overlapping.len(),
            blocks.len(),
            "`overlapping` must have one byte for every eight pairs"
        );
        for (pair, overlapping) in blocks.iter().zip(&mut *self.overlapping) {
            let (a, b) = load::<L>(pair);
            let boxes = FifteenAxes::new((a.center, a.axes(), a.half), (b.center, b.axes(), b.half));
            let near = boxes.faces();
            *overlapping = if near.any() { (near & boxes.edges()).bits() } else { 0 };
        }
        if let (tail @ 1.., Some(last)) = (self.pairs.len() % WIDTH, self.overlapping.last_mut()) {
            *last &= (1 << tail) - 1;
        }
    }
}

/// Kernel of [`Pairs::separations`], for callers that choose the SIMD type.
#[derive(Debug)]
pub struct FindSeparations<'a> {
    /// Pairs of boxes to test.
    pub pairs: &'a Pairs,
    /// Axes to test.
    pub axes: Axes,
    /// Output: one result per pair.
    pub found: &'a mut Separations,
}

impl Kernel for FindSeparations<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.found.0.resize(self.pairs.len());
        let blocks = self.pairs.0.blocks().iter().zip(self.found.0.blocks_mut());
        match self.axes {
            Axes::Faces => {
                for (pair, found) in blocks {
                    {
                        let (a, b) = load::<L>(pair);
                        Relative::new(&a, &b).six_faces()
                    }
                    .store(found);
                }
            }
            Axes::Fifteen => {
                for (pair, found) in blocks {
                    {
                        let (a, b) = load::<L>(pair);
                        Relative::new(&a, &b).fifteen_axes()
                    }
                    .store(found);
                }
            }
        }
    }
}

impl<L: Lanes> Best<L> {
    #[inline(always)]
    fn store(self, to: &mut Block<2>) {
        let [distance, index] = &mut to.0;
        self.distance.store(distance);
        self.index.store(index);
    }
}

/// Loads the first and the second box of eight pairs.
#[inline(always)]
fn load<L: Lanes>(pair: &Block<{ 2 * NUMBERS }>) -> (Record<L>, Record<L>) {
    let [cx, cy, cz, x, y, z, w, hx, hy, hz, rest @ ..] = &pair.0;
    (Record::load([cx, cy, cz, x, y, z, w, hx, hy, hz]), Record::load(rest.each_ref()))
}
