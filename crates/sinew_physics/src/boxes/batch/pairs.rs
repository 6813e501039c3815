//! Many pairs of boxes.

use super::separation::{Best, Relative, SeparatingAxis, Separation, record};
use crate::boxes::Obb;
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{Block, Blocks, Lanes};

/// Pairs of boxes, stored so that eight are examined at a time: 80 bytes a pair.
#[derive(Clone, Debug, Default)]
pub struct Pairs(Blocks<20>);

/// What [`Pairs::separations`] finds, in the order of the pairs: 8 bytes a pair.
#[derive(Clone, Debug, Default)]
pub struct Separations(Blocks<2>);

impl Pairs {
    /// No pairs.
    pub fn new() -> Self {
        Self::default()
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Adds the pair of `a` and `b` at the end.
    pub fn push(&mut self, a: &Obb, b: &Obb) {
        let (a, b) = (record(a), record(b));
        self.0.push(core::array::from_fn(|row| if row < 10 { a[row] } else { b[row - 10] }));
    }

    /// Removes all and keeps the memory.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Finds, for each pair, the axis among the fifteen along which the two boxes are furthest apart or overlap least:
    /// [`Separation::between`] of each, to the bit. `found` takes its length from here, and allocates only to grow.
    pub fn separations(&self, found: &mut Separations) {
        dispatch::run(FindSeparations { pairs: self, axes: Axes::Fifteen, found });
    }

    /// Likewise among the six axes of the faces alone, at a third of the cost: never more than the true gap, and at
    /// least where the boxes overlap, so that what it separates is separate.
    pub fn face_separations(&self, found: &mut Separations) {
        dispatch::run(FindSeparations { pairs: self, axes: Axes::Faces, found });
    }
}

/// Which axes are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// The three sides of each box.
    Faces,
    /// Those, and what is at right angles to a side of each.
    Fifteen,
}

impl Separations {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Of pair `index`.
    ///
    /// # Panics
    /// If there are not so many.
    #[inline]
    pub fn get(&self, index: usize) -> Separation {
        let [distance, axis] = self.0.get(index);
        Separation { distance, axis: SeparatingAxis::from_index(axis as u8) }
    }

    /// Of all pairs, in their order.
    pub fn iter(&self) -> impl Iterator<Item = Separation> + '_ {
        (0..self.len()).map(|index| self.get(index))
    }
}

/// The kernel of [`Pairs::separations`], for those who choose the registers.
#[derive(Debug)]
pub struct FindSeparations<'a> {
    /// The boxes.
    pub pairs: &'a Pairs,
    /// What is tried on them.
    pub axes: Axes,
    /// Where the answers go.
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
                    relative::<L>(pair).six_faces().store(found);
                }
            }
            Axes::Fifteen => {
                for (pair, found) in blocks {
                    relative::<L>(pair).fifteen_axes().store(found);
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

#[inline(always)]
fn relative<L: Lanes>(pair: &Block<20>) -> Relative<L> {
    let mut rows = [L::splat(0.0); 20];
    for (row, numbers) in rows.iter_mut().zip(&pair.0) {
        *row = L::load(numbers);
    }
    let [a @ .., _, _, _, _, _, _, _, _, _, _] = rows;
    let [_, _, _, _, _, _, _, _, _, _, b @ ..] = rows;
    Relative::new(&a, &b)
}
