//! Four lanes of SSE2 (every x86-64).

use super::quads::{Quad, Quads};
use core::arch::x86_64::{
    __m128, _mm_add_ps, _mm_and_ps, _mm_andnot_ps, _mm_cmpeq_ps, _mm_cmple_ps, _mm_cmplt_ps, _mm_div_ps,
    _mm_loadu_ps, _mm_max_ps, _mm_min_ps, _mm_movemask_ps, _mm_mul_ps, _mm_or_ps, _mm_set1_ps, _mm_sqrt_ps,
    _mm_storeu_ps, _mm_sub_ps, _mm_xor_ps,
};

pub(crate) type Sse2 = Quads<__m128>;

/// Number with only the sign bit set.
const SIGN: f32 = -0.0;

/// All bits set: the true result of a comparison.
const TRUE: f32 = f32::from_bits(u32::MAX);

/// Calls SSE and SSE2 intrinsics.
macro_rules! sse2 {
    ($call:expr) => {
        // SAFETY: SSE2 is part of x86-64.
        unsafe { $call }
    };
}

impl Quad for __m128 {
    type Mask = Self;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        sse2!(_mm_set1_ps(value))
    }

    #[inline(always)]
    fn load(from: &[f32; 4]) -> Self {
        // SAFETY: the array has the four floats that are read, and the load needs no alignment.
        unsafe { _mm_loadu_ps(from.as_ptr()) }
    }

    #[inline(always)]
    fn store(self, to: &mut [f32; 4]) {
        // SAFETY: the array has room for the four floats that are written, and the store needs no alignment.
        unsafe { _mm_storeu_ps(to.as_mut_ptr(), self) }
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        sse2!(_mm_add_ps(self, other))
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        sse2!(_mm_sub_ps(self, other))
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        sse2!(_mm_mul_ps(self, other))
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        sse2!(_mm_div_ps(self, other))
    }

    #[inline(always)]
    fn neg(self) -> Self {
        sse2!(_mm_xor_ps(self, _mm_set1_ps(SIGN)))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        sse2!(_mm_sqrt_ps(self))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        sse2!(_mm_andnot_ps(_mm_set1_ps(SIGN), self))
    }

    // `minps` and `maxps` are defined as these selections, down to NaN and −0.
    #[inline(always)]
    fn min(a: Self, b: Self) -> Self {
        sse2!(_mm_min_ps(a, b))
    }

    #[inline(always)]
    fn max(a: Self, b: Self) -> Self {
        sse2!(_mm_max_ps(a, b))
    }

    #[inline(always)]
    fn lt(a: Self, b: Self) -> Self {
        sse2!(_mm_cmplt_ps(a, b))
    }

    #[inline(always)]
    fn le(a: Self, b: Self) -> Self {
        sse2!(_mm_cmple_ps(a, b))
    }

    #[inline(always)]
    fn eq(a: Self, b: Self) -> Self {
        sse2!(_mm_cmpeq_ps(a, b))
    }

    #[inline(always)]
    fn select(mask: Self, a: Self, b: Self) -> Self {
        sse2!(_mm_or_ps(_mm_and_ps(mask, a), _mm_andnot_ps(mask, b)))
    }

    #[inline(always)]
    fn masked(self, mask: Self) -> Self {
        sse2!(_mm_and_ps(mask, self))
    }

    #[inline(always)]
    fn nan_where(self, mask: Self) -> Self {
        sse2!(_mm_or_ps(mask, self))
    }

    #[inline(always)]
    fn and(a: Self, b: Self) -> Self {
        sse2!(_mm_and_ps(a, b))
    }

    #[inline(always)]
    fn or(a: Self, b: Self) -> Self {
        sse2!(_mm_or_ps(a, b))
    }

    #[inline(always)]
    fn not(mask: Self) -> Self {
        sse2!(_mm_xor_ps(mask, _mm_set1_ps(TRUE)))
    }

    #[inline(always)]
    fn bits(mask: Self) -> u8 {
        sse2!(_mm_movemask_ps(mask)) as u8
    }
}
