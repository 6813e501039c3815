use crate::lanes::Real;
use crate::rotations::orthonormal::gram_schmidt;
use crate::{Mat3, Vec3, any_orthonormal, direction, trig};
use core::ops::Mul;

/// A rotation as a unit quaternion `x i + y j + z k + w`.
///
/// The algebra is our own scalar code, because the bits of `glam::Quat` differ between targets. `From` converts from and
/// to `glam::Quat`, component by component. `a * b` applies `b` first; `r * v` rotates a vector.
///
/// A rotation by angle θ about the unit vector n is `cos(θ/2) + n sin(θ/2)` and takes v to `q v q̄`; so q and −q are
/// the same rotation. For quaternions of any length, and for whole angles, see [`Quaternion`](crate::Quaternion).
///
/// The five basic operations:
///
/// ```
/// use sinew_math::{Rotation, Vec3};
/// // From axis and angle, radians, counter-clockwise as seen against the axis.
/// let q = Rotation::from_axis_angle(Vec3::Y, core::f32::consts::FRAC_PI_2);
/// assert!((q * Vec3::Z - Vec3::X).length() < 1e-6);
/// // To a matrix, whose columns are the images of the axes, and from it.
/// let m = q.to_mat3();
/// assert!((m * Vec3::Z - Vec3::X).length() < 1e-6);
/// assert!(Rotation::from_mat3(&m).angle_to(q) < 1e-6);
/// // Normalise to remove the error of many products.
/// let worn = Rotation::from_xyzw(q.x * 1.01, q.y * 1.01, q.z * 1.01, q.w * 1.01);
/// assert!((worn.normalize().length() - 1.0).abs() < 1e-6);
/// // The inverse turns back.
/// assert!((q.inverse() * (q * Vec3::X) - Vec3::X).length() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Rotation {
    /// Coefficient of i.
    pub x: f32,
    /// Coefficient of j.
    pub y: f32,
    /// Coefficient of k.
    pub z: f32,
    /// Real part.
    pub w: f32,
}

impl Default for Rotation {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Rotation {
    /// The identity: no rotation.
    pub const IDENTITY: Self = Self { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };

    /// Creates a rotation from four numbers as they are; call [`normalize`](Self::normalize) if their length may differ
    /// from 1.
    #[inline(always)]
    pub const fn from_xyzw(x: f32, y: f32, z: f32, w: f32) -> Self {
        Self { x, y, z, w }
    }

    #[inline(always)]
    fn from_vector(v: Vec3, w: f32) -> Self {
        Self { x: v.x, y: v.y, z: v.z, w }
    }

    /// The vector part (x, y, z).
    #[inline(always)]
    pub fn vector(self) -> Vec3 {
        Vec3::new(self.x, self.y, self.z)
    }

    /// Rotation by `angle` radians (any size) about `axis`, right-handed: `cos(angle/2) + axis sin(angle/2)`. `axis`
    /// must have length 1; see [`about`](Self::about) for an axis of any length.
    pub fn from_axis_angle(axis: Vec3, angle: f32) -> Self {
        let (sin, cos) = trig::sin_cos(0.5 * angle);
        Self::from_vector(axis * sin, cos)
    }

    /// Rotates by `angle` radians about an axis of any length. Identity if the axis is zero or a number is not finite.
    pub fn about(axis: Vec3, angle: f32) -> Self {
        direction(axis).map_or(Self::IDENTITY, |axis| Self::from_axis_angle(axis, angle).normalize())
    }

    /// Axis (length 1) and angle, radians, 0..=π. The identity has axis x. A rotation by more than half a turn is
    /// returned as a smaller one about the opposite axis.
    pub fn to_axis_angle(self) -> (Vec3, f32) {
        let q = self.positive();
        let axis_and_angle = |axis: Vec3| (axis, 2.0 * trig::atan2(axis.dot(q.vector()), q.w));
        direction(q.vector()).map_or((Vec3::X, 0.0), axis_and_angle)
    }

    /// Exponential map: rotation about `v` by its length in radians. Exact for the zero vector; identity for a vector
    /// that is not finite or longer than 1e19.
    #[doc(alias = "exp")]
    pub fn from_scaled_axis(v: Vec3) -> Self {
        let angle = v.length();
        let (sin, cos) = trig::sin_cos(0.5 * angle);
        // sin(a/2)/a → 1/2: the series keeps precision where the division would lose it.
        let scale = if angle > 1e-4 { sin / angle } else { 0.5 - angle * angle / 48.0 };
        Self::from_vector(v * scale, cos).normalize()
    }

    /// Logarithm: axis times angle (radians, at most π long), the inverse of
    /// [`from_scaled_axis`](Self::from_scaled_axis) for vectors no longer than π. Zero for the identity. For half a
    /// turn the signs of the four numbers choose one of two opposite vectors.
    #[doc(alias = "ln")]
    #[doc(alias = "log")]
    pub fn to_scaled_axis(self) -> Vec3 {
        let q = self.positive();
        let v = q.vector();
        let sin = v.length();
        if sin < 1e-6 {
            return v * 2.0;
        }
        v * (2.0 * trig::atan2(sin, q.w) / sin)
    }

    /// Returns the shortest rotation that takes unit vector `from` to unit vector `to`. For opposite vectors: half a
    /// turn about a fixed axis perpendicular to `from`. The error is at most 7e-7 rad over the sine of an obtuse angle
    /// between the two; the worst is 5e-4 rad, a tenth of a degree from opposite. For vectors of other lengths see
    /// [`Quaternion::quotient`](crate::Quaternion::quotient).
    pub fn from_arc(from: Vec3, to: Vec3) -> Self {
        let cos = from.dot(to);
        if cos >= -0.999_999 {
            return Self::from_vector(from.cross(to), 1.0 + cos).normalize();
        }
        // Uses terms that do not cancel: from × to, and sin²/(1 − cos) for 1 + cos.
        let sin = from.cross(from + to);
        let square = sin.length_squared();
        if square < 1e-13 {
            return Self::from_vector(any_orthonormal(from), 0.0);
        }
        Self::from_vector(sin, square / (1.0 - cos)).normalize()
    }

    /// Converts a rotation matrix with orthonormal columns (Shepperd, "Quaternion from rotation matrix", 1978: by the
    /// largest component, so that nothing cancels). For other matrices the result is some rotation: see
    /// [`orthonormalize`](crate::orthonormalize).
    pub fn from_mat3(m: &Mat3) -> Self {
        let (a, b, c) = (m.x_axis, m.y_axis, m.z_axis);
        let trace = a.x + b.y + c.z;
        let q = if trace > 0.0 {
            Self::from_xyzw(b.z - c.y, c.x - a.z, a.y - b.x, 1.0 + trace)
        } else if a.x > b.y && a.x > c.z {
            Self::from_xyzw(1.0 + a.x - b.y - c.z, a.y + b.x, c.x + a.z, b.z - c.y)
        } else if b.y > c.z {
            Self::from_xyzw(a.y + b.x, 1.0 - a.x + b.y - c.z, b.z + c.y, c.x - a.z)
        } else {
            Self::from_xyzw(c.x + a.z, b.z + c.y, 1.0 - a.x - b.y + c.z, a.y - b.x)
        };
        q.normalize()
    }

    /// Returns the rotation of `m` without scale and shear, by Gram-Schmidt, x first. A mirrored matrix gives the
    /// rotation of its mirror image in z. Degenerate columns are replaced. [`orthonormalize`](crate::orthonormalize)
    /// returns the nearest rotation, the size of the correction and whether it is unique.
    pub fn from_mat3_lossy(m: &Mat3) -> Self {
        gram_schmidt(m).0
    }

    /// Converts the rotation to a matrix; its columns are the images of the axes.
    #[inline]
    pub fn to_mat3(self) -> Mat3 {
        let Self { x, y, z, w } = self;
        Mat3::from_cols(
            Vec3::new(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
            Vec3::new(2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)),
            Vec3::new(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)),
        )
    }

    /// The inverse rotation; at length 1 it equals the [`conjugate`](Self::conjugate).
    #[inline(always)]
    pub fn inverse(self) -> Self {
        self.conjugate()
    }

    /// The quaternion with its vector part reversed.
    #[inline(always)]
    pub fn conjugate(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z, w: self.w }
    }

    /// Four-dimensional dot product; 1 or −1 for equal rotations.
    #[inline(always)]
    pub fn dot(self, other: Self) -> f32 {
        self.x * other.x + self.y * other.y + (self.z * other.z + self.w * other.w)
    }

    /// Length of the quaternion; its difference from 1 shows the accumulated rounding.
    #[inline(always)]
    pub fn length(self) -> f32 {
        self.dot(self).sqrt()
    }

    /// Scales to length 1. The zero quaternion (not longer than 1e-12) and those that are not finite (above 1e19) give
    /// the identity.
    #[inline]
    pub fn normalize(self) -> Self {
        let length = self.length();
        if length > 1e-12 && length < f32::INFINITY {
            let s = 1.0 / length;
            Self { x: self.x * s, y: self.y * s, z: self.z * s, w: self.w * s }
        } else {
            Self::IDENTITY
        }
    }

    /// Returns the same rotation with `w ≥ 0`.
    #[inline]
    pub fn positive(self) -> Self {
        if self.w < 0.0 { self.negate() } else { self }
    }

    /// Returns the same rotation on the hemisphere of `reference`, so that blends take the short way.
    #[inline]
    pub fn toward(self, reference: Self) -> Self {
        if self.dot(reference) < 0.0 { self.negate() } else { self }
    }

    #[inline(always)]
    fn negate(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z, w: -self.w }
    }

    /// Angle between two rotations, radians, 0..=π.
    pub fn angle_to(self, other: Self) -> f32 {
        (self.inverse() * other).to_scaled_axis().length()
    }

    /// Normalised linear blend, the short way; `t` in 0..=1. Follows the path of [`slerp`](Self::slerp), but moves
    /// faster in its middle. Between rotations half a turn apart the signs of the two quaternions choose the way.
    pub fn nlerp(self, other: Self, t: f32) -> Self {
        let b = other.toward(self);
        let s = 1.0 - t;
        Self::from_xyzw(
            s * self.x + t * b.x,
            s * self.y + t * b.y,
            s * self.z + t * b.z,
            s * self.w + t * b.w,
        )
        .normalize()
    }

    /// Spherical blend at constant angular speed, the short way; `t` in 0..=1 (Shoemake, "Animating rotation with
    /// quaternion curves", 1985): `(q sin((1−t)φ) + p sin(tφ)) / sin φ` with `cos φ = q·p`. Below 3.6° it uses
    /// [`nlerp`](Self::nlerp), which is as accurate there. Opposite quaternions are the same rotation, so a blend of
    /// them is constant. Between rotations half a turn apart the signs of the two quaternions choose the way.
    pub fn slerp(self, other: Self, t: f32) -> Self {
        let b = other.toward(self);
        let cos = self.dot(b);
        if cos > 0.9995 {
            return self.nlerp(b, t);
        }
        let angle = trig::acos(cos);
        let k = 1.0 / trig::sin(angle);
        let (s, t) = (trig::sin((1.0 - t) * angle) * k, trig::sin(t * angle) * k);
        Self::from_xyzw(
            s * self.x + t * b.x,
            s * self.y + t * b.y,
            s * self.z + t * b.z,
            s * self.w + t * b.w,
        )
        .normalize()
    }

    /// Splits into `(swing, twist)` with `self = swing * twist`, `twist` about unit vector `axis` and the axis of
    /// `swing` perpendicular to it. At a swing of half a turn (within 2e-4) the twist is undefined; the identity is
    /// returned for it.
    pub fn swing_twist(self, axis: Vec3) -> (Self, Self) {
        let q = self.positive();
        let along = q.vector().dot(axis);
        if q.w * q.w + along * along < 1e-8 {
            return (q, Self::IDENTITY);
        }
        let twist = Self::from_vector(axis * along, q.w).normalize();
        (q * twist.inverse(), twist)
    }

    /// Twist angle about unit vector `axis`, radians, −π..=π: the angle of the second part of
    /// [`swing_twist`](Self::swing_twist).
    pub fn twist_angle(self, axis: Vec3) -> f32 {
        let q = self.positive();
        2.0 * trig::atan2(q.vector().dot(axis), q.w)
    }

    /// Returns the rotation after turning with angular velocity `w` (rad/s, world axes) for `h` seconds: exponential
    /// map.
    #[inline]
    pub fn integrate(self, w: Vec3, h: f32) -> Self {
        (Self::from_scaled_axis(w * h) * self).normalize()
    }

    /// Returns the constant angular velocity (rad/s, world axes) that takes `self` to `later` within `dt` seconds, the
    /// short way; at most `π/dt`. `dt` must not be 0.
    pub fn angular_velocity_to(self, later: Self, dt: f32) -> Vec3 {
        let turn = (later * self.inverse()).positive();
        let square = turn.vector().length_squared();
        if square > Self::SHORT_TURN {
            return turn.to_scaled_axis() / dt;
        }
        turn.vector() * (2.0 * Self::half_angle_over_sine(square) / dt)
    }

    /// Squared sine of half the angle up to which [`half_angle_over_sine`](Self::half_angle_over_sine) is accurate: an
    /// angle of 0.2 rad.
    pub const SHORT_TURN: f32 = 0.01;

    /// Returns half of a rotation's angle (rad) over its sine `s`, from `s²`: the first terms of the series of
    /// `asin(s) / s`. The truncation error is 3e-10 up to [`SHORT_TURN`](Self::SHORT_TURN).
    #[inline(always)]
    pub fn half_angle_over_sine<R: Real>(square: R) -> R {
        let [one, third, fifth, seventh] = [1.0, 1.0 / 6.0, 3.0 / 40.0, 15.0 / 336.0].map(R::splat);
        one + square * (third + square * (fifth + square * seventh))
    }

    /// Returns `self * v`, corrected for the quaternion's deviation from length 1. After normalising, the deviation is
    /// up to 1e-7 and positive on average: rotated back and forth in every substep, a vector would grow by 1e-3 in a
    /// minute.
    #[inline]
    pub fn turn(self, v: Vec3) -> Vec3 {
        let [x, y, z, w] = [self.x, self.y, self.z, self.w].map(f64::from);
        let [a, b, c] = v.to_array().map(f64::from);
        let s = 2.0 / (x * x + y * y + z * z + w * w);
        let t = [y * c - z * b, z * a - x * c, x * b - y * a];
        let u = [y * t[2] - z * t[1], z * t[0] - x * t[2], x * t[1] - y * t[0]];
        Vec3::new(
            (a + s * (w * t[0] + u[0])) as f32,
            (b + s * (w * t[1] + u[1])) as f32,
            (c + s * (w * t[2] + u[2])) as f32,
        )
    }

    /// True if all four numbers are finite.
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite() && self.w.is_finite()
    }
}

impl Mul for Rotation {
    type Output = Self;
    #[inline]
    fn mul(self, b: Self) -> Self {
        let a = self;
        Self {
            x: a.w * b.x + a.x * b.w + (a.y * b.z - a.z * b.y),
            y: a.w * b.y + a.y * b.w + (a.z * b.x - a.x * b.z),
            z: a.w * b.z + a.z * b.w + (a.x * b.y - a.y * b.x),
            w: a.w * b.w - a.x * b.x - (a.y * b.y + a.z * b.z),
        }
    }
}

impl Mul<Vec3> for Rotation {
    type Output = Vec3;
    #[inline]
    fn mul(self, v: Vec3) -> Vec3 {
        let u = self.vector();
        let t = u.cross(v) * 2.0;
        v + t * self.w + u.cross(t)
    }
}

impl From<glam::Quat> for Rotation {
    fn from(q: glam::Quat) -> Self {
        Self::from_xyzw(q.x, q.y, q.z, q.w)
    }
}

impl From<Rotation> for glam::Quat {
    fn from(r: Rotation) -> Self {
        glam::Quat::from_xyzw(r.x, r.y, r.z, r.w)
    }
}
