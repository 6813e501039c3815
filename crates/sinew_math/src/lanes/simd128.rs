//! Four lanes of WebAssembly simd128; its intrinsics are safe to call in builds that enable it.

use super::quads::{Quad, Quads};
use core::arch::wasm32::{
    f32x4_abs, f32x4_add, f32x4_div, f32x4_eq, f32x4_le, f32x4_lt, f32x4_mul, f32x4_neg, f32x4_pmax,
    f32x4_pmin, f32x4_splat, f32x4_sqrt, f32x4_sub, i32x4_bitmask, v128, v128_and, v128_bitselect, v128_load,
    v128_not, v128_or, v128_store,
};

pub(crate) type Simd128 = Quads<v128>;

impl Quad for v128 {
    type Mask = Self;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        f32x4_splat(value)
    }

    #[inline(always)]
    fn load(from: &[f32; 4]) -> Self {
        // SAFETY: the array has the 16 bytes that are read, and the load needs no alignment.
        unsafe { v128_load(from.as_ptr().cast()) }
    }

    #[inline(always)]
    fn store(self, to: &mut [f32; 4]) {
        // SAFETY: the array has room for the 16 bytes that are written, and the store needs no alignment.
        unsafe { v128_store(to.as_mut_ptr().cast(), self) }
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        f32x4_add(self, other)
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        f32x4_sub(self, other)
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        f32x4_mul(self, other)
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        f32x4_div(self, other)
    }

    #[inline(always)]
    fn neg(self) -> Self {
        f32x4_neg(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f32x4_sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f32x4_abs(self)
    }

    // `pmin(b, a)` is `a < b ? a : b` and `pmax(b, a)` is `b < a ? a : b`; `f32x4_min` has another result for NaN.
    #[inline(always)]
    fn min(a: Self, b: Self) -> Self {
        f32x4_pmin(b, a)
    }

    #[inline(always)]
    fn max(a: Self, b: Self) -> Self {
        f32x4_pmax(b, a)
    }

    #[inline(always)]
    fn lt(a: Self, b: Self) -> Self {
        f32x4_lt(a, b)
    }

    #[inline(always)]
    fn le(a: Self, b: Self) -> Self {
        f32x4_le(a, b)
    }

    #[inline(always)]
    fn eq(a: Self, b: Self) -> Self {
        f32x4_eq(a, b)
    }

    #[inline(always)]
    fn select(mask: Self, a: Self, b: Self) -> Self {
        v128_bitselect(a, b, mask)
    }

    #[inline(always)]
    fn masked(self, mask: Self) -> Self {
        v128_and(mask, self)
    }

    #[inline(always)]
    fn nan_where(self, mask: Self) -> Self {
        v128_or(mask, self)
    }

    #[inline(always)]
    fn and(a: Self, b: Self) -> Self {
        v128_and(a, b)
    }

    #[inline(always)]
    fn or(a: Self, b: Self) -> Self {
        v128_or(a, b)
    }

    #[inline(always)]
    fn not(mask: Self) -> Self {
        v128_not(mask)
    }

    #[inline(always)]
    fn bits(mask: Self) -> u8 {
        i32x4_bitmask(mask)
    }
}
