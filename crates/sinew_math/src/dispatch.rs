//! Runs kernels with the widest SIMD registers of the processor; the results have the same bits on every processor.
//!
//! ```
//! use sinew_math::dispatch::{self, Kernel};
//! use sinew_math::lanes::{Lanes, Real, WIDTH};
//!
//! /// Computes the square roots of many numbers.
//! struct Roots<'a>(&'a mut [[f32; WIDTH]]);
//!
//! impl Kernel for Roots<'_> {
//!     type Output = ();
//!     #[inline(always)]
//!     fn run<L: Lanes>(self) {
//!         for block in self.0 {
//!             L::load(block).sqrt().store(block);
//!         }
//!     }
//! }
//!
//! let mut numbers = [[0.0, 1.0, 4.0, 9.0, 16.0, 25.0, 36.0, 49.0]; 2];
//! dispatch::run(Roots(&mut numbers));
//! assert_eq!(numbers[1][7], 7.0);
//! ```
#![allow(unsafe_code)] // the call into code that is compiled for AVX2

use crate::lanes::{Lanes, Scalar};

/// A loop over data that is written once, generic over the SIMD type, and compiled for each [`Level`].
pub trait Kernel {
    /// Result of the loop.
    type Output;

    /// Runs the kernel with `L` as its eight lanes. Implementations and every function they call need
    /// `#[inline(always)]`: see [`lanes`](crate::lanes).
    fn run<L: Lanes>(self) -> Self::Output;
}

/// SIMD registers that hold eight lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Level {
    /// Eight scalars.
    Scalar,
    /// Two SSE2 registers: every x86-64.
    Sse2,
    /// One AVX register: x86-64 since about 2013, if the operating system saves the register.
    Avx2,
    /// Two NEON registers: every aarch64.
    Neon,
    /// Two WebAssembly registers, in builds with `-C target-feature=+simd128`.
    Simd128,
}

impl Level {
    /// All levels; of each architecture, the widest comes last.
    pub const ALL: [Self; 5] = [Self::Scalar, Self::Sse2, Self::Avx2, Self::Neon, Self::Simd128];

    /// True if this processor and this build support the level.
    #[inline]
    pub fn is_available(self) -> bool {
        match self {
            Self::Scalar => true,
            Self::Sse2 => cfg!(target_arch = "x86_64"),
            // `--cfg sinew_narrow` is for measurements beside WebAssembly, whose registers have 128 bits.
            #[cfg(all(target_arch = "x86_64", not(sinew_narrow)))]
            Self::Avx2 => std::arch::is_x86_feature_detected!("avx2"),
            #[cfg(any(sinew_narrow, not(target_arch = "x86_64")))]
            Self::Avx2 => false,
            Self::Neon => cfg!(target_arch = "aarch64"),
            Self::Simd128 => cfg!(all(target_arch = "wasm32", target_feature = "simd128")),
        }
    }

    /// Levels that this processor supports, for tests that compare them.
    pub fn available() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|level| level.is_available())
    }

    /// Level that [`run`] uses.
    #[inline]
    pub fn best() -> Self {
        Self::ALL.into_iter().rfind(|level| level.is_available()).unwrap_or(Self::Scalar)
    }
}

/// The widest level that every processor of the target supports.
#[cfg(all(target_arch = "x86_64", feature = "sse2", not(debug_assertions)))]
type Base = crate::lanes::sse2::Sse2;
#[cfg(target_arch = "aarch64")]
type Base = crate::lanes::neon::Neon;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
type Base = crate::lanes::simd128::Simd128;
#[cfg(not(any(
    target_arch = "x86_64",
    target_arch = "aarch64",
    all(target_arch = "wasm32", target_feature = "simd128")
)))]
type Base = Scalar;

/// Runs a kernel on the widest available registers. Levels narrower than this build's minimum are not compiled.
///
/// For x86-64, kernels without AVX2 take a third of the compile time. Only builds without debug assertions and with the
/// feature `sse2` contain them.
///
/// # Panics
/// If the processor lacks AVX2 and the build has no other kernels.
#[inline]
pub fn run<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    if Level::Avx2.is_available() {
        // SAFETY: the processor has AVX2.
        return unsafe { on_avx2(kernel) };
    }
    #[cfg(any(not(target_arch = "x86_64"), all(feature = "sse2", not(debug_assertions))))]
    return kernel.run::<Base>();
    #[cfg(all(target_arch = "x86_64", any(not(feature = "sse2"), debug_assertions)))]
    no_kernels()
}

/// Panics because the processor lacks AVX2 and this build has no other kernels.
#[cfg(all(target_arch = "x86_64", any(not(feature = "sse2"), debug_assertions)))]
#[cold]
fn no_kernels() -> ! {
    panic!(
        "this processor lacks AVX2: build with `--release` and the feature `sse2` of sinew_math, for the command line \
         `cargo run --release --features sse2`"
    )
}

/// Runs a kernel at a given level, for tests and measurements.
///
/// # Panics
/// If the level is not [available](Level::is_available).
#[inline]
pub fn run_at<K: Kernel>(level: Level, kernel: K) -> K::Output {
    assert!(level.is_available(), "{level:?} is not available on this processor");
    match level {
        #[cfg(target_arch = "x86_64")]
        Level::Sse2 => kernel.run::<crate::lanes::sse2::Sse2>(),
        // SAFETY: the processor has AVX2, as was asserted.
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 => unsafe { on_avx2(kernel) },
        #[cfg(target_arch = "aarch64")]
        Level::Neon => kernel.run::<crate::lanes::neon::Neon>(),
        #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
        Level::Simd128 => kernel.run::<crate::lanes::simd128::Simd128>(),
        _ => kernel.run::<Scalar>(),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn on_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<crate::lanes::avx2::Avx2>()
}
