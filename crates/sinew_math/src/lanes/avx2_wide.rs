//! Eight `f64` in two AVX registers, for [`Avx2`](super::avx2::Avx2).
//!
//! Values exist only on processors where [`Avx2`](super::avx2::Avx2) exists; each `unsafe` below relies on that.

use super::{Mask, Real};
use core::arch::x86_64::{
    __m256d, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm256_add_pd, _mm256_and_pd, _mm256_andnot_pd,
    _mm256_blendv_pd, _mm256_cmp_pd, _mm256_div_pd, _mm256_mul_pd, _mm256_or_pd, _mm256_set1_pd,
    _mm256_sqrt_pd, _mm256_sub_pd, _mm256_xor_pd,
};
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Lanes 0 to 3, and 4 to 7.
#[derive(Clone, Copy)]
pub(crate) struct Wide(pub __m256d, pub __m256d);

/// True or false in each lane: the result of comparing two [`Wide`].
#[derive(Clone, Copy)]
pub(crate) struct WideMask(__m256d, __m256d);

/// Number with only the sign bit set.
const SIGN: f64 = -0.0;

/// All bits set: the true result of a comparison.
const TRUE: f64 = f64::from_bits(u64::MAX);

/// Calls AVX intrinsics. A value of [`Wide`] proves that the processor has them.
macro_rules! avx {
    ($call:expr) => {
        // SAFETY: code that holds or makes a value of `Wide` was entered by `dispatch`, on a processor with AVX2.
        unsafe { $call }
    };
}

macro_rules! operators {
    ($($operator:ident $method:ident $of:ident $intrinsic:ident),*) => {$(
        impl $operator for $of {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                avx!(Self($intrinsic(self.0, other.0), $intrinsic(self.1, other.1)))
            }
        }
    )*};
}

operators!(
    Add add Wide _mm256_add_pd,
    Sub sub Wide _mm256_sub_pd,
    Mul mul Wide _mm256_mul_pd,
    Div div Wide _mm256_div_pd,
    BitAnd bitand WideMask _mm256_and_pd,
    BitOr bitor WideMask _mm256_or_pd
);

impl Neg for Wide {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let sign = Self::splat_wide(SIGN).0;
        avx!(Self(_mm256_xor_pd(self.0, sign), _mm256_xor_pd(self.1, sign)))
    }
}

impl Not for WideMask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        let all = Wide::splat_wide(TRUE).0;
        avx!(Self(_mm256_xor_pd(self.0, all), _mm256_xor_pd(self.1, all)))
    }
}

impl Mask for WideMask {}

impl Real for Wide {
    type Mask = WideMask;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self::splat_wide(f64::from(value))
    }

    #[inline(always)]
    fn splat_wide(value: f64) -> Self {
        let all = avx!(_mm256_set1_pd(value));
        Self(all, all)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        avx!(Self(_mm256_sqrt_pd(self.0), _mm256_sqrt_pd(self.1)))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        let sign = Self::splat_wide(SIGN).0;
        avx!(Self(_mm256_andnot_pd(sign, self.0), _mm256_andnot_pd(sign, self.1)))
    }

    #[inline(always)]
    fn lt(a: Self, b: Self) -> WideMask {
        avx!(WideMask(_mm256_cmp_pd::<_CMP_LT_OQ>(a.0, b.0), _mm256_cmp_pd::<_CMP_LT_OQ>(a.1, b.1)))
    }

    #[inline(always)]
    fn le(a: Self, b: Self) -> WideMask {
        avx!(WideMask(_mm256_cmp_pd::<_CMP_LE_OQ>(a.0, b.0), _mm256_cmp_pd::<_CMP_LE_OQ>(a.1, b.1)))
    }

    #[inline(always)]
    fn eq(a: Self, b: Self) -> WideMask {
        avx!(WideMask(_mm256_cmp_pd::<_CMP_EQ_OQ>(a.0, b.0), _mm256_cmp_pd::<_CMP_EQ_OQ>(a.1, b.1)))
    }

    #[inline(always)]
    fn select(mask: WideMask, a: Self, b: Self) -> Self {
        avx!(Self(_mm256_blendv_pd(b.0, a.0, mask.0), _mm256_blendv_pd(b.1, a.1, mask.1)))
    }

    #[inline(always)]
    fn masked(self, mask: WideMask) -> Self {
        avx!(Self(_mm256_and_pd(mask.0, self.0), _mm256_and_pd(mask.1, self.1)))
    }

    #[inline(always)]
    fn nan_where(self, mask: WideMask) -> Self {
        avx!(Self(_mm256_or_pd(mask.0, self.0), _mm256_or_pd(mask.1, self.1)))
    }
}
