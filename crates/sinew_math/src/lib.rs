//! Mathematics whose bits are the same on every target.
//!
//! Vectors and 3×3 matrices are [`glam::Vec3`] and [`glam::Mat3`], plain scalar structs whose `+ − × ÷ √` are
//! IEEE-exact everywhere. Everything whose bits differ between targets in `glam` or in std (quaternion algebra,
//! trigonometry, `min`/`max` with NaN) lives here instead. See `docs/adr/0006-glam-and-bits.md`.
#![deny(unsafe_code)] // `lanes` and `dispatch` alone allow it

pub mod bytes;
pub mod dispatch;
pub mod hash;
pub mod lanes;
pub mod limits;
pub mod random;
mod rotation;
mod symmetric;
mod transform;
pub mod trig;

pub use bytes::{ReadError, Reader, Writer};
pub use glam::{Mat3, Vec2, Vec3};
pub use hash::StableHasher;
pub use limits::{Range, SwingTwistLimit};
pub use random::Random;
pub use rotation::Rotation;
pub use symmetric::Sym3;
pub use transform::{Affine, Transform};

/// The smaller of two numbers by explicit selection: `b` if either is NaN (like x86 `minps`), on every target.
#[inline(always)]
pub fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The larger of two numbers by explicit selection: `b` if either is NaN (like x86 `maxps`), on every target.
#[inline(always)]
pub fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// `x` limited to `lo..=hi`; NaN gives `lo`, so that a poisoned number cannot spread.
#[inline(always)]
pub fn clamp(x: f32, lo: f32, hi: f32) -> f32 {
    min(max(x, lo), hi)
}

/// Component-wise smaller of two vectors, by [`min`].
#[inline(always)]
pub fn min3(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(min(a.x, b.x), min(a.y, b.y), min(a.z, b.z))
}

/// Component-wise larger of two vectors, by [`max`].
#[inline(always)]
pub fn max3(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(max(a.x, b.x), max(a.y, b.y), max(a.z, b.z))
}

/// Component-wise absolute value.
#[inline(always)]
pub fn abs3(v: Vec3) -> Vec3 {
    Vec3::new(v.x.abs(), v.y.abs(), v.z.abs())
}

/// `v` at length 1, or `fallback` when its length is below 1e-12 or not finite.
#[inline]
pub fn normalize_or(v: Vec3, fallback: Vec3) -> Vec3 {
    let length = v.length();
    if length > 1e-12 && length < f32::INFINITY { v / length } else { fallback }
}

/// A unit vector at right angles to the unit vector `n`, continuous but for one jump
/// (Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017).
#[inline]
pub fn any_orthonormal(n: Vec3) -> Vec3 {
    let sign = if n.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + n.z);
    Vec3::new(1.0 + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x)
}

/// The matrix whose product with `v` is `r × v`.
#[inline]
pub fn skew(r: Vec3) -> Mat3 {
    Mat3::from_cols(Vec3::new(0.0, r.z, -r.y), Vec3::new(-r.z, 0.0, r.x), Vec3::new(r.y, -r.x, 0.0))
}
