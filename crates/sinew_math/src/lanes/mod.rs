//! Eight `f32` side by side, with the same bits on every processor.
//!
//! A formula is written once, generic over [`Real`]: over `f32` it computes one item, over [`Lanes`] eight at a time,
//! and lane `k` of the eight has the bits that `f32` gives for item `k`. That holds because there is nothing here whose
//! result depends on the processor: `+ − × ÷ √` are IEEE-exact everywhere, the rest are comparisons and selections.
//! There is no fused multiply-add, no estimate of a reciprocal and no sum across the lanes.
//!
//! One freedom is left: the sign and payload of a NaN that arithmetic makes. *Whether* a lane is NaN is the same
//! everywhere; its bits are not, so none may be stored where bits count.
//!
//! Kernels are entered through [`dispatch`](crate::dispatch), which alone picks the type that [`Lanes`] stands for.
//! Everything a kernel calls must be `#[inline(always)]`: what is left as a call of its own is compiled for the oldest
//! processor and takes its vectors through memory. For the same reason kernels hold no closures.
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

/// A number, or several side by side; its operations act in each lane alone.
///
/// No method has a processor's own answer for NaN or −0: see [`min`](Self::min), and `sinew_math::min`, which it is.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// Result of a comparison.
    type Mask: Mask;

    /// `value` in every lane.
    fn splat(value: f32) -> Self;

    /// `value` in every lane, rounded to what lanes hold.
    #[inline(always)]
    fn splat_wide(value: f64) -> Self {
        Self::splat(value as f32)
    }

    /// Square root, exact; NaN below zero, −0 of −0.
    fn sqrt(self) -> Self;

    /// The number without its sign.
    fn abs(self) -> Self;

    /// `a < b`; false where either is NaN.
    fn lt(a: Self, b: Self) -> Self::Mask;

    /// `a ≤ b`; false where either is NaN.
    fn le(a: Self, b: Self) -> Self::Mask;

    /// `a = b`; false where either is NaN, true of 0 and −0.
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

    /// `a` where the mask is true, `b` where it is false; the bits are kept, those of a NaN too.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;

    /// The number where the mask is true, +0 where it is false.
    fn masked(self, mask: Self::Mask) -> Self;

    /// NaN where the mask is true, the number where it is false.
    fn nan_where(self, mask: Self::Mask) -> Self;

    /// The smaller: `b` where either is NaN, and where they are equal, so of 0 and −0 the second.
    #[inline(always)]
    fn min(a: Self, b: Self) -> Self {
        Self::select(Self::lt(a, b), a, b)
    }

    /// The larger: `b` where either is NaN, and where they are equal, so of 0 and −0 the second.
    #[inline(always)]
    fn max(a: Self, b: Self) -> Self {
        Self::select(Self::lt(b, a), a, b)
    }
}

/// True or false in each of the eight lanes.
pub trait LaneMask: Mask {
    /// Bit `k` is lane `k`.
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
/// A type that stands for a processor's own registers exists only where [`dispatch`](crate::dispatch) has found them:
/// nothing else can name it.
pub trait Lanes: Real<Mask: LaneMask> {
    /// Eight numbers of twice the digits, for sums that cancel.
    type Wide: Real;

    /// The same numbers in 64 bits.
    fn widen(self) -> Self::Wide;

    /// Eight numbers of 64 bits, each rounded to the nearest of 32.
    fn narrow(wide: Self::Wide) -> Self;

    /// The numbers of an array, item `k` in lane `k`.
    fn load(from: &[f32; WIDTH]) -> Self;

    /// Lane `k` into item `k`.
    fn store(self, to: &mut [f32; WIDTH]);

    /// Lane `k` gets the number of lane `k + by`, counted round. `by` is less than eight.
    #[inline(always)]
    fn turn(self, by: usize) -> Self {
        let mut twice = [[0.0; WIDTH]; 2];
        self.store(&mut twice[0]);
        self.store(&mut twice[1]);
        let twice = twice.as_flattened();
        Self::load(&core::array::from_fn(|k| twice[by + k]))
    }

    /// Rows become columns: lane `j` of row `i` goes to lane `i` of row `j`. Eight records become eight fields, and back.
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
