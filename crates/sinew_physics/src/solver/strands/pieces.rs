//! Lanes that hold the pieces of one strand: the last place of each piece, the values passed between pieces, and reductions over the
//! strand.

use super::super::flight::{Eight, ZERO, load, put, store};
use super::link::Link;
use sinew_math::Vec3;
use sinew_math::lanes::{LaneMask, Lanes, Real, Vector3, WIDTH};

/// Last places of a strand's pieces. Where the links do not divide evenly, some last places are empty.
#[derive(Clone, Copy)]
pub(super) struct Tips<L: Lanes> {
    /// Lanes whose last place is filled.
    pub full: L::Mask,
    /// Mask `full` for 64-bit numbers.
    pub full_wide: <L::Wide as Real>::Mask,
    pub place: usize,
}

impl<L: Lanes> Tips<L> {
    /// Creates the tips of pieces with `links` places; `full` is 1 where the last place is filled.
    #[inline(always)]
    pub fn new(full: &Eight, links: usize) -> Self {
        let full = L::load(full);
        let full_wide = L::Wide::lt(L::Wide::splat(0.5), full.widen());
        Self { full: L::lt(L::splat(0.5), full), full_wide, place: links - 1 }
    }

    /// Restricts a mask to the lanes whose place `i` is filled.
    #[inline(always)]
    pub fn within(self, mask: L::Mask, i: usize) -> L::Mask {
        if i == self.place { mask & self.full } else { mask }
    }

    /// Vector passed to link `i` from the link below; the last link of each piece gets `of_cut`.
    #[inline(always)]
    pub fn below(self, i: usize, of_link: Vector3<L>, of_cut: Vector3<L>) -> Vector3<L> {
        if i == self.place {
            of_cut
        } else if i + 1 == self.place {
            select(self.full, of_link, of_cut)
        } else {
            of_link
        }
    }

    /// Links in the last place and in the one before: a lane's last link is one of them. There are at least two places.
    #[inline(always)]
    pub fn of(self, links: &[Link]) -> [&Link; 2] {
        [&links[self.place], &links[self.place - 1]]
    }

    /// Selects the vector of each piece's last link, from the last place and the one before.
    #[inline(always)]
    pub fn pick(self, last: Vector3<L>, before: Vector3<L>) -> Vector3<L> {
        select(self.full, last, before)
    }
}

/// Shifts by one lane: the value of piece `k − 1` goes to lane `k`, and `first` to the first lane.
#[inline(always)]
pub(super) fn handed_down<L: Lanes>(v: Vector3<L>, first: Vec3) -> Vector3<L> {
    let (mut from, mut to) = ([ZERO; 3], [ZERO; 3]);
    store(v, &mut from);
    for (from, to) in from.iter().zip(&mut to) {
        to[1..].copy_from_slice(&from[..WIDTH - 1]);
    }
    put(first, &mut to, 0);
    load(&to)
}

/// Shifts back by one lane: the value of piece `k + 1` goes to lane `k`, and zero to the last lane.
#[inline(always)]
pub(super) fn handed_up<L: Lanes>(v: Vector3<L>) -> Vector3<L> {
    let (mut from, mut to) = ([ZERO; 3], [ZERO; 3]);
    store(v, &mut from);
    for (from, to) in from.iter().zip(&mut to) {
        to[..WIDTH - 1].copy_from_slice(&from[1..]);
    }
    load(&to)
}

/// Returns the mask of all lanes.
#[inline(always)]
pub(super) fn all<L: Lanes>() -> L::Mask {
    L::eq(L::splat(0.0), L::splat(0.0))
}

/// Returns the largest value of the pieces, in all lanes; NaN if one is NaN.
#[inline(always)]
pub(super) fn whole_max<L: Lanes>(of_pieces: L) -> L {
    let (mut numbers, mut most) = (ZERO, 0.0);
    of_pieces.store(&mut numbers);
    for number in numbers {
        if !(number <= most || f32::is_nan(most)) {
            most = number;
        }
    }
    L::splat(most)
}

/// Returns the sum over the pieces, in all lanes.
#[inline(always)]
pub(super) fn whole_sum<L: Lanes>(of_pieces: L) -> L {
    let (mut numbers, mut sum) = (ZERO, 0.0);
    of_pieces.store(&mut numbers);
    for number in numbers {
        sum += number;
    }
    L::splat(sum)
}

/// Returns true in all lanes if the mask is true in every lane.
#[inline(always)]
pub(super) fn whole_all<L: Lanes>(of_pieces: L::Mask) -> L::Mask {
    if of_pieces.all() { of_pieces } else { of_pieces & !of_pieces }
}

#[inline(always)]
pub(super) fn masked<L: Lanes>(v: Vector3<L>, mask: L::Mask) -> Vector3<L> {
    Vector3::new(v.x.masked(mask), v.y.masked(mask), v.z.masked(mask))
}

#[inline(always)]
pub(super) fn select<L: Lanes>(mask: L::Mask, a: Vector3<L>, b: Vector3<L>) -> Vector3<L> {
    Vector3::new(L::select(mask, a.x, b.x), L::select(mask, a.y, b.y), L::select(mask, a.z, b.z))
}
