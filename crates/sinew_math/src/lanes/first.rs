//! Lane 0 alone, for a single item.

use super::{LaneMask, Lanes, Mask, Real, WIDTH};
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// One `f32` in place of eight: reads and writes lane 0, with the same bits as in a full register.
#[derive(Clone, Copy, Debug)]
pub struct First(f32);

/// Mask of lane 0; the other lanes repeat its value.
#[derive(Clone, Copy, Debug)]
pub struct FirstMask(bool);

macro_rules! operators {
    ($($operator:ident $method:ident $of:ident),*) => {$(
        impl $operator for $of {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($operator::$method(self.0, other.0))
            }
        }
    )*};
}

operators!(Add add First, Sub sub First, Mul mul First, Div div First, BitAnd bitand FirstMask, BitOr bitor FirstMask);

impl Neg for First {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Not for FirstMask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Mask for FirstMask {}

impl LaneMask for FirstMask {
    #[inline(always)]
    fn bits(self) -> u8 {
        if self.0 { u8::MAX } else { 0 }
    }
}

impl Real for First {
    type Mask = FirstMask;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(value)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(Real::sqrt(self.0))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(Real::abs(self.0))
    }

    #[inline(always)]
    fn lt(a: Self, b: Self) -> FirstMask {
        FirstMask(a.0 < b.0)
    }

    #[inline(always)]
    fn le(a: Self, b: Self) -> FirstMask {
        FirstMask(a.0 <= b.0)
    }

    #[inline(always)]
    fn eq(a: Self, b: Self) -> FirstMask {
        FirstMask(Real::eq(a.0, b.0))
    }

    #[inline(always)]
    fn select(mask: FirstMask, a: Self, b: Self) -> Self {
        if mask.0 { a } else { b }
    }

    #[inline(always)]
    fn masked(self, mask: FirstMask) -> Self {
        Self(self.0.masked(mask.0))
    }

    #[inline(always)]
    fn nan_where(self, mask: FirstMask) -> Self {
        Self(self.0.nan_where(mask.0))
    }
}

impl Lanes for First {
    type Wide = f64;

    #[inline(always)]
    fn widen(self) -> f64 {
        f64::from(self.0)
    }

    #[inline(always)]
    fn narrow(wide: f64) -> Self {
        Self(wide as f32)
    }

    #[inline(always)]
    fn load(from: &[f32; WIDTH]) -> Self {
        Self(from[0])
    }

    #[inline(always)]
    fn store(self, to: &mut [f32; WIDTH]) {
        to[0] = self.0;
    }
}
