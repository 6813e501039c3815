//! Four lanes of NEON (every aarch64).
//!
//! `fmin` and `fmax` are not used because their NaN result differs from the selection's.

use super::quads::{Quad, Quads};
use core::arch::aarch64::{
    float32x4_t, uint32x4_t, vabsq_f32, vaddq_f32, vaddvq_u32, vandq_u32, vbslq_f32, vceqq_f32, vcleq_f32,
    vcltq_f32, vdivq_f32, vdupq_n_f32, vld1q_f32, vld1q_u32, vmulq_f32, vmvnq_u32, vnegq_f32, vorrq_u32,
    vreinterpretq_f32_u32, vreinterpretq_u32_f32, vsqrtq_f32, vst1q_f32, vsubq_f32,
};

pub(crate) type Neon = Quads<float32x4_t>;

/// Calls NEON intrinsics.
macro_rules! neon {
    ($call:expr) => {
        // SAFETY: NEON is part of aarch64.
        unsafe { $call }
    };
}

impl Quad for float32x4_t {
    type Mask = uint32x4_t;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        neon!(vdupq_n_f32(value))
    }

    #[inline(always)]
    fn load(from: &[f32; 4]) -> Self {
        // SAFETY: the array has the four floats that are read.
        unsafe { vld1q_f32(from.as_ptr()) }
    }

    #[inline(always)]
    fn store(self, to: &mut [f32; 4]) {
        // SAFETY: the array has room for the four floats that are written.
        unsafe { vst1q_f32(to.as_mut_ptr(), self) }
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        neon!(vaddq_f32(self, other))
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        neon!(vsubq_f32(self, other))
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        neon!(vmulq_f32(self, other))
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        neon!(vdivq_f32(self, other))
    }

    #[inline(always)]
    fn neg(self) -> Self {
        neon!(vnegq_f32(self))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        neon!(vsqrtq_f32(self))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        neon!(vabsq_f32(self))
    }

    #[inline(always)]
    fn min(a: Self, b: Self) -> Self {
        Self::select(Self::lt(a, b), a, b)
    }

    #[inline(always)]
    fn max(a: Self, b: Self) -> Self {
        Self::select(Self::lt(b, a), a, b)
    }

    #[inline(always)]
    fn lt(a: Self, b: Self) -> uint32x4_t {
        neon!(vcltq_f32(a, b))
    }

    #[inline(always)]
    fn le(a: Self, b: Self) -> uint32x4_t {
        neon!(vcleq_f32(a, b))
    }

    #[inline(always)]
    fn eq(a: Self, b: Self) -> uint32x4_t {
        neon!(vceqq_f32(a, b))
    }

    #[inline(always)]
    fn select(mask: uint32x4_t, a: Self, b: Self) -> Self {
        neon!(vbslq_f32(mask, a, b))
    }

    #[inline(always)]
    fn masked(self, mask: uint32x4_t) -> Self {
        neon!(vreinterpretq_f32_u32(vandq_u32(mask, vreinterpretq_u32_f32(self))))
    }

    #[inline(always)]
    fn nan_where(self, mask: uint32x4_t) -> Self {
        neon!(vreinterpretq_f32_u32(vorrq_u32(mask, vreinterpretq_u32_f32(self))))
    }

    #[inline(always)]
    fn and(a: uint32x4_t, b: uint32x4_t) -> uint32x4_t {
        neon!(vandq_u32(a, b))
    }

    #[inline(always)]
    fn or(a: uint32x4_t, b: uint32x4_t) -> uint32x4_t {
        neon!(vorrq_u32(a, b))
    }

    #[inline(always)]
    fn not(mask: uint32x4_t) -> uint32x4_t {
        neon!(vmvnq_u32(mask))
    }

    #[inline(always)]
    fn bits(mask: uint32x4_t) -> u8 {
        // SAFETY: the array has the four integers that are read.
        let places = unsafe { vld1q_u32([1, 2, 4, 8].as_ptr()) };
        neon!(vaddvq_u32(vandq_u32(mask, places))) as u8
    }
}
