//! Eight lanes as two registers of four.

use super::scalar::Doubles;
use super::{LaneMask, Lanes, Mask, Real, WIDTH};
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// A register of four `f32`. Each operation corresponds to that of [`Real`] or [`Lanes`] with the same name.
pub(crate) trait Quad: Copy {
    /// Comparison result: all bits of a lane are set, or none.
    type Mask: Copy;

    fn splat(value: f32) -> Self;
    fn load(from: &[f32; 4]) -> Self;
    fn store(self, to: &mut [f32; 4]);
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn neg(self) -> Self;
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    fn min(a: Self, b: Self) -> Self;
    fn max(a: Self, b: Self) -> Self;
    fn lt(a: Self, b: Self) -> Self::Mask;
    fn le(a: Self, b: Self) -> Self::Mask;
    fn eq(a: Self, b: Self) -> Self::Mask;
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    fn masked(self, mask: Self::Mask) -> Self;
    fn nan_where(self, mask: Self::Mask) -> Self;
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn not(mask: Self::Mask) -> Self::Mask;
    /// Returns lane `k` as bit `k`; the upper four bits are clear.
    fn bits(mask: Self::Mask) -> u8;
}

/// Lanes 0 to 3, and 4 to 7.
#[derive(Clone, Copy)]
pub(crate) struct Quads<Q>(Q, Q);

/// Comparison result of [`Quads`].
#[derive(Clone, Copy)]
pub(crate) struct QuadsMask<Q: Quad>(Q::Mask, Q::Mask);

macro_rules! twice {
    ($($operator:ident $method:ident),*) => {$(
        impl<Q: Quad> $operator for Quads<Q> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
    )*};
}

twice!(Add add, Sub sub, Mul mul, Div div);

impl<Q: Quad> Neg for Quads<Q> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.neg(), self.1.neg())
    }
}

impl<Q: Quad> BitAnd for QuadsMask<Q> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(Q::and(self.0, other.0), Q::and(self.1, other.1))
    }
}

impl<Q: Quad> BitOr for QuadsMask<Q> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(Q::or(self.0, other.0), Q::or(self.1, other.1))
    }
}

impl<Q: Quad> Not for QuadsMask<Q> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(Q::not(self.0), Q::not(self.1))
    }
}

impl<Q: Quad> Mask for QuadsMask<Q> {}

impl<Q: Quad> LaneMask for QuadsMask<Q> {
    #[inline(always)]
    fn bits(self) -> u8 {
        Q::bits(self.0) | Q::bits(self.1) << 4
    }
}

impl<Q: Quad> Real for Quads<Q> {
    type Mask = QuadsMask<Q>;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(Q::splat(value), Q::splat(value))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt(), self.1.sqrt())
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs(), self.1.abs())
    }

    #[inline(always)]
    fn lt(a: Self, b: Self) -> Self::Mask {
        QuadsMask(Q::lt(a.0, b.0), Q::lt(a.1, b.1))
    }

    #[inline(always)]
    fn le(a: Self, b: Self) -> Self::Mask {
        QuadsMask(Q::le(a.0, b.0), Q::le(a.1, b.1))
    }

    #[inline(always)]
    fn eq(a: Self, b: Self) -> Self::Mask {
        QuadsMask(Q::eq(a.0, b.0), Q::eq(a.1, b.1))
    }

    #[inline(always)]
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self {
        Self(Q::select(mask.0, a.0, b.0), Q::select(mask.1, a.1, b.1))
    }

    #[inline(always)]
    fn masked(self, mask: Self::Mask) -> Self {
        Self(self.0.masked(mask.0), self.1.masked(mask.1))
    }

    #[inline(always)]
    fn nan_where(self, mask: Self::Mask) -> Self {
        Self(self.0.nan_where(mask.0), self.1.nan_where(mask.1))
    }

    #[inline(always)]
    fn min(a: Self, b: Self) -> Self {
        Self(Q::min(a.0, b.0), Q::min(a.1, b.1))
    }

    #[inline(always)]
    fn max(a: Self, b: Self) -> Self {
        Self(Q::max(a.0, b.0), Q::max(a.1, b.1))
    }
}

impl<Q: Quad> Lanes for Quads<Q> {
    type Wide = Doubles;

    #[inline(always)]
    fn widen(self) -> Doubles {
        let mut numbers = [0.0; WIDTH];
        self.store(&mut numbers);
        Doubles::widened(numbers)
    }

    #[inline(always)]
    fn narrow(wide: Doubles) -> Self {
        Self::load(&wide.narrowed())
    }

    #[inline(always)]
    fn load(from: &[f32; WIDTH]) -> Self {
        let [a, b, c, d, e, f, g, h] = *from;
        Self(Q::load(&[a, b, c, d]), Q::load(&[e, f, g, h]))
    }

    #[inline(always)]
    fn store(self, to: &mut [f32; WIDTH]) {
        let (low, high) = to.split_at_mut(4);
        let halves: (&mut [f32; 4], &mut [f32; 4]) =
            (low.try_into().expect("four of eight"), high.try_into().expect("four of eight"));
        self.0.store(halves.0);
        self.1.store(halves.1);
    }
}
