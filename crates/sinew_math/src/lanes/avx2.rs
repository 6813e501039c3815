//! Eight lanes in one AVX register.
//!
//! Only [`dispatch`](crate::dispatch) creates values of [`Avx2`], and only if the processor supports AVX2; each
//! `unsafe` below relies on that. The types are private to this crate, so no other code can create one.

use super::avx2_wide::Wide;
use super::{LaneMask, Lanes, Mask, Real, WIDTH};
use core::arch::x86_64::{
    __m256, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm256_add_epi32, _mm256_add_ps, _mm256_and_ps,
    _mm256_andnot_ps, _mm256_blendv_ps, _mm256_castps256_ps128, _mm256_cmp_ps, _mm256_cvtpd_ps,
    _mm256_cvtps_pd, _mm256_div_ps, _mm256_extractf128_ps, _mm256_loadu_ps, _mm256_max_ps, _mm256_min_ps,
    _mm256_movemask_ps, _mm256_mul_ps, _mm256_or_ps, _mm256_permute2f128_ps, _mm256_permutevar8x32_ps,
    _mm256_set_m128, _mm256_set1_epi32, _mm256_set1_ps, _mm256_setr_epi32, _mm256_shuffle_ps, _mm256_sqrt_ps,
    _mm256_storeu_ps, _mm256_sub_ps, _mm256_unpackhi_ps, _mm256_unpacklo_ps, _mm256_xor_ps,
};
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

#[derive(Clone, Copy)]
pub(crate) struct Avx2(__m256);

#[derive(Clone, Copy)]
pub(crate) struct Avx2Mask(__m256);

/// Number with only the sign bit set.
const SIGN: f32 = -0.0;

/// All bits set: the true result of a comparison.
const TRUE: f32 = f32::from_bits(u32::MAX);

/// Calls AVX intrinsics. A value of [`Avx2`] proves that the processor has them.
macro_rules! avx {
    ($call:expr) => {
        // SAFETY: code that holds or makes a value of `Avx2` was entered by `dispatch`, on a processor with AVX2.
        unsafe { $call }
    };
}

macro_rules! operators {
    ($($operator:ident $method:ident $of:ident $intrinsic:ident),*) => {$(
        impl $operator for $of {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(avx!($intrinsic(self.0, other.0)))
            }
        }
    )*};
}

operators!(
    Add add Avx2 _mm256_add_ps,
    Sub sub Avx2 _mm256_sub_ps,
    Mul mul Avx2 _mm256_mul_ps,
    Div div Avx2 _mm256_div_ps,
    BitAnd bitand Avx2Mask _mm256_and_ps,
    BitOr bitor Avx2Mask _mm256_or_ps
);

impl Neg for Avx2 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(avx!(_mm256_xor_ps(self.0, Self::splat(SIGN).0)))
    }
}

impl Not for Avx2Mask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(avx!(_mm256_xor_ps(self.0, Avx2::splat(TRUE).0)))
    }
}

impl Mask for Avx2Mask {}

impl LaneMask for Avx2Mask {
    #[inline(always)]
    fn bits(self) -> u8 {
        avx!(_mm256_movemask_ps(self.0)) as u8
    }
}

impl Real for Avx2 {
    type Mask = Avx2Mask;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(avx!(_mm256_set1_ps(value)))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(avx!(_mm256_sqrt_ps(self.0)))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(avx!(_mm256_andnot_ps(Self::splat(SIGN).0, self.0)))
    }

    #[inline(always)]
    fn lt(a: Self, b: Self) -> Avx2Mask {
        Avx2Mask(avx!(_mm256_cmp_ps::<_CMP_LT_OQ>(a.0, b.0)))
    }

    #[inline(always)]
    fn le(a: Self, b: Self) -> Avx2Mask {
        Avx2Mask(avx!(_mm256_cmp_ps::<_CMP_LE_OQ>(a.0, b.0)))
    }

    #[inline(always)]
    fn eq(a: Self, b: Self) -> Avx2Mask {
        Avx2Mask(avx!(_mm256_cmp_ps::<_CMP_EQ_OQ>(a.0, b.0)))
    }

    #[inline(always)]
    fn select(mask: Avx2Mask, a: Self, b: Self) -> Self {
        Self(avx!(_mm256_blendv_ps(b.0, a.0, mask.0)))
    }

    #[inline(always)]
    fn masked(self, mask: Avx2Mask) -> Self {
        Self(avx!(_mm256_and_ps(mask.0, self.0)))
    }

    #[inline(always)]
    fn nan_where(self, mask: Avx2Mask) -> Self {
        Self(avx!(_mm256_or_ps(mask.0, self.0)))
    }

    // `vminps` and `vmaxps` are defined as these selections, down to NaN and −0.
    #[inline(always)]
    fn min(a: Self, b: Self) -> Self {
        Self(avx!(_mm256_min_ps(a.0, b.0)))
    }

    #[inline(always)]
    fn max(a: Self, b: Self) -> Self {
        Self(avx!(_mm256_max_ps(a.0, b.0)))
    }
}

impl Lanes for Avx2 {
    type Wide = Wide;

    #[inline(always)]
    fn widen(self) -> Wide {
        avx!(Wide(
            _mm256_cvtps_pd(_mm256_castps256_ps128(self.0)),
            _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(self.0))
        ))
    }

    #[inline(always)]
    fn narrow(Wide(low, high): Wide) -> Self {
        Self(avx!(_mm256_set_m128(_mm256_cvtpd_ps(high), _mm256_cvtpd_ps(low))))
    }

    #[inline(always)]
    fn load(from: &[f32; WIDTH]) -> Self {
        // SAFETY: as above; the array has the eight floats that are read, and the load needs no alignment.
        Self(unsafe { _mm256_loadu_ps(from.as_ptr()) })
    }

    #[inline(always)]
    fn store(self, to: &mut [f32; WIDTH]) {
        // SAFETY: as above; and the array has room for the eight floats that are written.
        unsafe { _mm256_storeu_ps(to.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn turn(self, by: usize) -> Self {
        // Only the lowest three bits of an index are used.
        let places =
            avx!(_mm256_add_epi32(_mm256_set1_epi32(by as i32), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)));
        Self(avx!(_mm256_permutevar8x32_ps(self.0, places)))
    }

    #[inline(always)]
    fn transpose(rows: [Self; WIDTH]) -> [Self; WIDTH] {
        let [a, b, c, d, e, f, g, h] = rows;
        let ([p, q, r, s], [t, u, v, w]) = (quarters(a, b, c, d), quarters(e, f, g, h));
        avx!([
            Self(_mm256_permute2f128_ps::<0x20>(p, t)),
            Self(_mm256_permute2f128_ps::<0x20>(q, u)),
            Self(_mm256_permute2f128_ps::<0x20>(r, v)),
            Self(_mm256_permute2f128_ps::<0x20>(s, w)),
            Self(_mm256_permute2f128_ps::<0x31>(p, t)),
            Self(_mm256_permute2f128_ps::<0x31>(q, u)),
            Self(_mm256_permute2f128_ps::<0x31>(r, v)),
            Self(_mm256_permute2f128_ps::<0x31>(s, w)),
        ])
    }
}

/// Puts column `k` of four rows in the lower half of register `k`, and column `4 + k` in its upper half.
#[inline(always)]
fn quarters(a: Avx2, b: Avx2, c: Avx2, d: Avx2) -> [__m256; 4] {
    avx!({
        let (low_ab, high_ab) = (_mm256_unpacklo_ps(a.0, b.0), _mm256_unpackhi_ps(a.0, b.0));
        let (low_cd, high_cd) = (_mm256_unpacklo_ps(c.0, d.0), _mm256_unpackhi_ps(c.0, d.0));
        [
            _mm256_shuffle_ps::<0x44>(low_ab, low_cd),
            _mm256_shuffle_ps::<0xEE>(low_ab, low_cd),
            _mm256_shuffle_ps::<0x44>(high_ab, high_cd),
            _mm256_shuffle_ps::<0xEE>(high_ab, high_cd),
        ]
    })
}
