//! Mathematics whose bits are the same on every target.
//!
//! Vectors and 3×3 matrices are [`glam::Vec3`] and [`glam::Mat3`], plain scalar structs whose `+ − × ÷ √` are
//! IEEE-exact everywhere. Quaternion algebra, trigonometry and `min`/`max` with NaN have different bits on different
//! targets in `glam` and std, so this crate has its own. See `docs/adr/0006-glam-and-bits.md`.
//!
//! **Conventions.** Right-handed axes, +Y up, SI units, radians. Vectors are columns: `m * v` and `r * v` rotate a
//! vector, `a * b` applies `b` first, and the columns of a rotation matrix are the images of the axes.
//! `world_from_body` maps vectors from body axes to world axes. A positive rotation is counter-clockwise when seen
//! against its axis.
//!
//! **Ways to write a rotation:**
//!
//! | as | type | good for | watch for |
//! |---|---|---|---|
//! | unit quaternion | [`Rotation`] | everything: products, blends, integration | q and −q are the same rotation |
//! | axis × angle | [`Vec3`], by [`Rotation::to_scaled_axis`] | rates, small turns, averages | at most half a turn |
//! | nine numbers | [`Mat3`], by [`Rotation::to_mat3`] | many vectors, other libraries | drift: [`MatrixDrift`], [`orthonormalize`] |
//! | three angles | [`EulerAngles`], by [`Rotation::to_euler`] | people, files | 24 meanings, [`GimbalLock`] in each |
//! | two vectors | [`Rotation::from_arc`], [`Quaternion::quotient`] | aiming | opposite vectors define no axis |
//! | stretch and turn | [`Quaternion`] | Hamilton's algebra | holds the whole angle, [`Rotation`] the half |
#![deny(unsafe_code)] // `lanes` and `dispatch` alone allow it

pub mod bytes;
pub mod dispatch;
pub mod hash;
pub mod lanes;
pub mod limits;
pub mod random;
mod rotations;
mod symmetric;
mod transform;
pub mod triangle;
pub mod trig;
#[cfg(feature = "serde")]
pub mod unlimited;

pub use bytes::{ReadError, Reader, Writer};
pub use glam::{DVec3, Mat3, Vec2, Vec3};
pub use hash::StableHasher;
pub use limits::{Range, SwingTwistLimit};
pub use random::Random;
pub use rotations::euler::{EulerAngles, EulerAxes, EulerConvention, EulerOrder, GimbalLock};
pub use rotations::orthonormal::{
    MatrixDrift, Orthonormalization, Orthonormalized, Uniqueness, orthonormalize,
};
pub use rotations::quaternion::Quaternion;
pub use rotations::rotation::Rotation;
pub use symmetric::Sym3;
pub use transform::{Affine, Transform, inverse3};

/// Returns the smaller of two numbers by explicit selection: `b` if either is NaN (like x86 `minps`), on every target.
#[inline(always)]
pub fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Returns the larger of two numbers by explicit selection: `b` if either is NaN (like x86 `maxps`), on every target.
#[inline(always)]
pub fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Limits `x` to `lo..=hi`; NaN gives `lo`, so that NaN cannot spread.
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

/// Scales `v` to length 1; returns `fallback` when the length is not above 1e-12 or not finite.
#[inline]
pub fn normalize_or(v: Vec3, fallback: Vec3) -> Vec3 {
    let length = v.length();
    if length > 1e-12 && length < f32::INFINITY { v / length } else { fallback }
}

/// Returns the direction and the length of a finite vector. The direction of zero is zero. A length that overflows is
/// `f32::MAX`.
#[inline]
pub fn direction_and_length(v: Vec3) -> (Vec3, f32) {
    (normalize_or(v, direction(v).unwrap_or(Vec3::ZERO)), min(v.length(), f32::MAX))
}

/// Scales `v` to length 1, for any length; `None` if `v` is zero or not finite.
#[inline]
pub fn direction(v: Vec3) -> Option<Vec3> {
    let a = abs3(v);
    let largest = max(a.x, max(a.y, a.z));
    // Divides by the largest component first, so that squares neither overflow nor vanish.
    let scaled = v / largest;
    (largest > 0.0 && v.is_finite()).then(|| scaled / scaled.length())
}

/// Returns a unit vector perpendicular to the unit vector `n`, continuous except for one jump (Duff et al., "Building
/// an Orthonormal Basis, Revisited", JCGT 2017).
#[inline]
pub fn any_orthonormal(n: Vec3) -> Vec3 {
    let sign = if n.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + n.z);
    Vec3::new(1.0 + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x)
}

/// Returns the matrix whose product with `v` is `r × v`.
#[inline]
pub fn skew(r: Vec3) -> Mat3 {
    Mat3::from_cols(Vec3::new(0.0, r.z, -r.y), Vec3::new(-r.z, 0.0, r.x), Vec3::new(r.y, -r.x, 0.0))
}
