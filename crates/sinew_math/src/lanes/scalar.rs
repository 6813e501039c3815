//! One number, and eight numbers in an array for processors without a known register set.

use super::{LaneMask, Lanes, Mask, Real, WIDTH};
use core::array;
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

impl Mask for bool {}

/// One lane; defines the results of all other implementations.
impl Real for f32 {
    type Mask = bool;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        value
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f32::abs(self)
    }

    #[inline(always)]
    fn lt(a: Self, b: Self) -> bool {
        a < b
    }

    #[inline(always)]
    fn le(a: Self, b: Self) -> bool {
        a <= b
    }

    #[inline(always)]
    fn eq(a: Self, b: Self) -> bool {
        a == b
    }

    #[inline(always)]
    fn select(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }

    #[inline(always)]
    fn masked(self, mask: bool) -> Self {
        if mask { self } else { 0.0 }
    }

    #[inline(always)]
    fn nan_where(self, mask: bool) -> Self {
        if mask { f32::NAN } else { self }
    }
}

/// One `f64`, for sums that cancel.
impl Real for f64 {
    type Mask = bool;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        f64::from(value)
    }

    #[inline(always)]
    fn splat_wide(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }

    #[inline(always)]
    fn lt(a: Self, b: Self) -> bool {
        a < b
    }

    #[inline(always)]
    fn le(a: Self, b: Self) -> bool {
        a <= b
    }

    #[inline(always)]
    fn eq(a: Self, b: Self) -> bool {
        a == b
    }

    #[inline(always)]
    fn select(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }

    #[inline(always)]
    fn masked(self, mask: bool) -> Self {
        if mask { self } else { 0.0 }
    }

    #[inline(always)]
    fn nan_where(self, mask: bool) -> Self {
        if mask { f64::NAN } else { self }
    }
}

/// Eight `f32`, each handled like `f32`. Operations are calls: inlined eight times at each use, they would make
/// kernels more than twice as large and no faster. wasm32 without simd128 uses this type: see
/// [`dispatch`](crate::dispatch).
#[derive(Clone, Copy, Debug)]
pub struct Scalar([f32; WIDTH]);

/// Eight `f64`, each handled like `f64`.
#[derive(Clone, Copy, Debug)]
pub struct Doubles([f64; WIDTH]);

impl Doubles {
    #[inline(never)]
    pub(crate) fn widened(from: [f32; WIDTH]) -> Self {
        Self(from.map(f64::from))
    }

    #[inline(never)]
    pub(crate) fn narrowed(self) -> [f32; WIDTH] {
        self.0.map(|x| x as f32)
    }
}

/// Eight `bool`.
#[derive(Clone, Copy, Debug)]
pub struct Bools([bool; WIDTH]);

macro_rules! lane_by_lane {
    ($($operator:ident $method:ident $of:ident),*) => {$(
        impl $operator for $of {
            type Output = Self;
            #[inline(never)]
            fn $method(self, other: Self) -> Self {
                Self(array::from_fn(|k| $operator::$method(self.0[k], other.0[k])))
            }
        }
    )*};
}

lane_by_lane!(Add add Scalar, Sub sub Scalar, Mul mul Scalar, Div div Scalar, BitAnd bitand Bools, BitOr bitor Bools);
lane_by_lane!(Add add Doubles, Sub sub Doubles, Mul mul Doubles, Div div Doubles);

impl Not for Bools {
    type Output = Self;
    #[inline(never)]
    fn not(self) -> Self {
        Self(self.0.map(bool::not))
    }
}

impl Mask for Bools {}

impl LaneMask for Bools {
    #[inline(never)]
    fn bits(self) -> u8 {
        let bit = |(k, &lane): (usize, &bool)| u8::from(lane) << k;
        self.0.iter().enumerate().map(bit).fold(0, BitOr::bitor)
    }
}

/// Defines a type for numbers in an array, each handled like a single one.
macro_rules! array_of {
    ($of:ident $number:ident) => {
        impl Neg for $of {
            type Output = Self;
            #[inline(never)]
            fn neg(self) -> Self {
                Self(self.0.map($number::neg))
            }
        }

        impl Real for $of {
            type Mask = Bools;

            #[inline(never)]
            fn splat(value: f32) -> Self {
                Self([$number::splat(value); WIDTH])
            }

            #[inline(never)]
            fn splat_wide(value: f64) -> Self {
                Self([$number::splat_wide(value); WIDTH])
            }

            #[inline(never)]
            fn sqrt(self) -> Self {
                Self(self.0.map($number::sqrt))
            }

            #[inline(never)]
            fn abs(self) -> Self {
                Self(self.0.map($number::abs))
            }

            #[inline(never)]
            fn lt(a: Self, b: Self) -> Bools {
                Bools(array::from_fn(|k| a.0[k] < b.0[k]))
            }

            #[inline(never)]
            fn le(a: Self, b: Self) -> Bools {
                Bools(array::from_fn(|k| a.0[k] <= b.0[k]))
            }

            #[inline(never)]
            fn eq(a: Self, b: Self) -> Bools {
                Bools(array::from_fn(|k| a.0[k] == b.0[k]))
            }

            #[inline(never)]
            fn select(mask: Bools, a: Self, b: Self) -> Self {
                Self(array::from_fn(|k| $number::select(mask.0[k], a.0[k], b.0[k])))
            }

            #[inline(never)]
            fn masked(self, mask: Bools) -> Self {
                Self(array::from_fn(|k| self.0[k].masked(mask.0[k])))
            }

            #[inline(never)]
            fn nan_where(self, mask: Bools) -> Self {
                Self(array::from_fn(|k| self.0[k].nan_where(mask.0[k])))
            }
        }
    };
}

array_of!(Scalar f32);
array_of!(Doubles f64);

impl Lanes for Scalar {
    type Wide = Doubles;

    #[inline(never)]
    fn widen(self) -> Doubles {
        Doubles::widened(self.0)
    }

    #[inline(never)]
    fn narrow(wide: Doubles) -> Self {
        Self(wide.narrowed())
    }

    #[inline(never)]
    fn load(from: &[f32; WIDTH]) -> Self {
        Self(*from)
    }

    #[inline(never)]
    fn store(self, to: &mut [f32; WIDTH]) {
        *to = self.0;
    }
}
