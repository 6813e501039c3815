//! Eight `f32` side by side, with the same bits on every processor.
//!
//! A formula is written once, generic over [`Real`]: with `f32` it computes one item, with [`Lanes`] eight. Lane `k`
//! has the same bits as `f32` for item `k`, because no operation here depends on the processor: `+ − × ÷ √`
//! are exact by IEEE 754, and the rest are comparisons and selections. There is no fused multiply-add, no reciprocal
//! estimate and no sum across lanes.
//!
//! The only exception is the sign and payload of a NaN that arithmetic produces. Every processor gets NaN in the same
//! lanes, but with different bits, so do not store NaN in data whose bits are compared.
//!
//! Kernels are entered through [`dispatch`](crate::dispatch), which picks the type for [`Lanes`]. Every function that a
//! kernel calls must be `#[inline(always)]`: a separate call is compiled for the oldest processor and passes its
//! vectors through memory. Closures are not allowed in kernels for the same reason.
#![allow(unsafe_code)] // the intrinsics of AVX2, and loads and stores

use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

#[cfg(target_arch = "x86_64")]
pub(crate) mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx2_wide;
mod blocks;
mod first;
#[cfg(target_arch = "aarch64")]
pub(crate) mod neon;
#[cfg(any(
    target_arch = "x86_64",
    target_arch = "aarch64",
    all(target_arch = "wasm32", target_feature = "simd128")
))]
mod quads;
mod scalar;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
pub(crate) mod simd128;
#[cfg(target_arch = "x86_64")]
pub(crate) mod sse2;
#[cfg(test)]
mod tests;
mod vector;

pub use blocks::{Block, Blocks};
pub use first::First;
pub use scalar::Scalar;
pub use vector::Vector3;

/// Number of lanes, the same on every target.
pub const WIDTH: usize = 8;

/// Result of a comparison of [`Real`]s: true or false, in each lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {}

/// A number, or eight numbers; operations act on each lane separately.
///
/// NaN and −0 have a fixed result on every processor: see [`min`](Self::min), which equals `sinew_math::min`.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// Result of a comparison.
    type Mask: Mask;

    /// Returns `value` in every lane.
    fn splat(value: f32) -> Self;

    /// Returns `value` in every lane, rounded to the precision of the lanes.
    #[inline(always)]
    fn splat_wide(value: f64) -> Self {
        Self::splat(value as f32)
    }

    /// Square root, exact; NaN below zero, −0 for −0.
    fn sqrt(self) -> Self;

    /// Absolute value.
    fn abs(self) -> Self;

    /// `a < b`; false where either is NaN.
    fn lt(a: Self, b: Self) -> Self::Mask;

    /// `a ≤ b`; false where either is NaN.
    fn le(a: Self, b: Self) -> Self::Mask;

    /// `a = b`; false where either is NaN, true for 0 and −0.
    fn eq(a: Self, b: Self) -> Self::Mask;

    /// `a > b`; false where either is NaN.
    #[inline(always)]
    fn gt(a: Self, b: Self) -> Self::Mask {
        Self::lt(b, a)
    }

    /// `a ≥ b`; false where either is NaN.
    #[inline(always)]
    fn ge(a: Self, b: Self) -> Self::Mask {
        Self::le(b, a)
    }

    /// `a` where the mask is true, else `b`; bits are copied unchanged, including NaN.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;

    /// Returns the number where the mask is true, +0 where it is false.
    fn masked(self, mask: Self::Mask) -> Self;

    /// Returns NaN where the mask is true, the number where it is false.
    fn nan_where(self, mask: Self::Mask) -> Self;

    /// Returns the smaller number, or `b` if either is NaN or both are equal (so `b` for 0 and −0).
    #[inline(always)]
    fn min(a: Self, b: Self) -> Self {
        Self::select(Self::lt(a, b), a, b)
    }

    /// Returns the larger number, or `b` if either is NaN or both are equal (so `b` for 0 and −0).
    #[inline(always)]
    fn max(a: Self, b: Self) -> Self {
        Self::select(Self::lt(b, a), a, b)
    }
}

/// True or false in each of the eight lanes.
pub trait LaneMask: Mask {
    /// Returns lane `k` as bit `k`.
    fn bits(self) -> u8;

    /// True if any lane is true.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }

    /// True if all lanes are true.
    #[inline(always)]
    fn all(self) -> bool {
        self.bits() == u8::MAX
    }
}

/// Eight numbers.
///
/// Types of processor registers can only be created by [`dispatch`](crate::dispatch), after it has checked for support.
pub trait Lanes: Real<Mask: LaneMask> {
    /// Eight `f64`, for sums in which large terms cancel.
    type Wide: Real;

    /// Converts the numbers to `f64`.
    fn widen(self) -> Self::Wide;

    /// Rounds eight `f64` to the nearest `f32`.
    fn narrow(wide: Self::Wide) -> Self;

    /// Loads an array, item `k` into lane `k`.
    fn load(from: &[f32; WIDTH]) -> Self;

    /// Stores lane `k` into item `k`.
    fn store(self, to: &mut [f32; WIDTH]);

    /// Rotates lanes: lane `k` gets the number of lane `(k + by) % 8`. `by` is less than eight.
    #[inline(always)]
    fn turn(self, by: usize) -> Self {
        let mut twice = [[0.0; WIDTH]; 2];
        self.store(&mut twice[0]);
        self.store(&mut twice[1]);
        let twice = twice.as_flattened();
        Self::load(&core::array::from_fn(|k| twice[by + k]))
    }

    /// Transposes: lane `j` of row `i` goes to lane `i` of row `j`.
    #[inline(always)]
    fn transpose(rows: [Self; WIDTH]) -> [Self; WIDTH] {
        let [mut records, mut fields] = [[[0.0; WIDTH]; WIDTH]; 2];
        for i in 0..WIDTH {
            rows[i].store(&mut records[i]);
            for j in 0..WIDTH {
                fields[j][i] = records[i][j];
            }
        }
        let mut out = rows;
        for j in 0..WIDTH {
            out[j] = Self::load(&fields[j]);
        }
        out
    }
}
