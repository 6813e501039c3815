//! Lanes that hold the pieces of one strand: what is in the last place of each, what goes from one to the next, and what counts for all.

use super::super::flight::{Eight, ZERO, load, put, store};
use super::link::Link;
use sinew_math::Vec3;
use sinew_math::lanes::{LaneMask, Lanes, Real, Vector3, WIDTH};

/// Last places of a strand's pieces: not all are filled where the links cannot be shared out evenly.
#[derive(Clone, Copy)]
pub(super) struct Tips<L: Lanes> {
    /// Lanes whose last place is filled.
    pub full: L::Mask,
    /// The same for numbers of 64 bits.
    pub full_wide: <L::Wide as Real>::Mask,
    pub place: usize,
}

impl<L: Lanes> Tips<L> {
    /// Last of so many places; `full` is 1 where the last place is filled.
    #[inline(always)]
    pub fn new(full: &Eight, links: usize) -> Self {
        let full = L::load(full);
        let full_wide = L::Wide::lt(L::Wide::splat(0.5), full.widen());
        Self { full: L::lt(L::splat(0.5), full), full_wide, place: links - 1 }
    }

    /// In the last place those lanes of a mask in which it is filled.
    #[inline(always)]
    pub fn within(self, mask: L::Mask, i: usize) -> L::Mask {
        if i == self.place { mask & self.full } else { mask }
    }

    /// Vector that comes to link `i` from the link below, if `of_cut` comes to the last one of each piece.
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

    /// Links in the last place and in the one before: a lane's last link is in one of them. There are two places at least.
    #[inline(always)]
    pub fn of(self, links: &[Link]) -> [&Link; 2] {
        [&links[self.place], &links[self.place - 1]]
    }

    /// Vector of the last link of each piece, from what is in the last place and in the one before.
    #[inline(always)]
    pub fn pick(self, last: Vector3<L>, before: Vector3<L>) -> Vector3<L> {
        select(self.full, last, before)
    }
}

/// One lane on: what piece `k − 1` has in lane `k`, and something else in the first.
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

/// One lane back: what piece `k + 1` has in lane `k`, and nothing in the last.
#[inline(always)]
pub(super) fn handed_up<L: Lanes>(v: Vector3<L>) -> Vector3<L> {
    let (mut from, mut to) = ([ZERO; 3], [ZERO; 3]);
    store(v, &mut from);
    for (from, to) in from.iter().zip(&mut to) {
        to[..WIDTH - 1].copy_from_slice(&from[1..]);
    }
    load(&to)
}

/// All lanes.
#[inline(always)]
pub(super) fn all<L: Lanes>() -> L::Mask {
    L::eq(L::splat(0.0), L::splat(0.0))
}

/// The largest of the pieces, in each lane; NaN if one is.
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

/// The sum of the pieces, in each lane.
#[inline(always)]
pub(super) fn whole_sum<L: Lanes>(of_pieces: L) -> L {
    let (mut numbers, mut sum) = (ZERO, 0.0);
    of_pieces.store(&mut numbers);
    for number in numbers {
        sum += number;
    }
    L::splat(sum)
}

/// True in each lane where it is so in all of them.
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
