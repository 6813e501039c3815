//! The general quaternion: the quotient of two vectors.

use crate::{Rotation, Vec3, abs3, direction, max, trig};
use core::ops::{Add, Mul, Neg, Sub};

/// A quaternion of any length: a number and a vector, `w + x i + y j + z k`.
///
/// Hamilton defined it as the quotient of two vectors. Taking vector `a` to vector `b` needs a rotation and a stretch:
/// two numbers for the plane of the rotation, one for its angle, one for the stretch. So a quaternion is a **versor**
/// (the rotation) times a **tensor** (the stretch, a positive number; not today's tensors):
///
/// ```text
/// b / a = b a⁻¹ = |b|/|a| · (cos θ + n sin θ)        θ from a to b about the unit vector n
/// ```
///
/// ```
/// use sinew_math::{Quaternion, Vec3};
/// let (a, b) = (Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 3.0, 0.0));
/// let q = Quaternion::quotient(b, a).expect("a is not zero");
/// assert_eq!(q.norm(), 3.0);
/// assert_eq!(q.axis(), Some(Vec3::Z));
/// assert_eq!(q.angle(), core::f32::consts::FRAC_PI_2);
/// assert_eq!(q.apply(a), b);
/// assert_eq!(q * Quaternion::from(a), Quaternion::from(b));
/// ```
///
/// **Whole and half angles.** A quaternion can act on a vector in two ways. Multiplied from the left, `q v`
/// ([`apply`](Self::apply)), it rotates by its own angle, but only vectors perpendicular to its axis stay vectors.
/// Multiplied from both sides, `q v q̄` ([`sandwich`](Self::sandwich)), it rotates any vector, by twice its angle. A
/// [`Rotation`] acts in the second way, so its four numbers hold *half* the angle; [`to_rotation`](Self::to_rotation)
/// converts from the first to the second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quaternion {
    /// The scalar part `w`, as named by Hamilton.
    pub scalar: f32,
    /// The vector part `x i + y j + z k`.
    pub vector: Vec3,
}

impl Quaternion {
    /// Zero: the quotient of the zero vector and any other vector.
    pub const ZERO: Self = Self::new(0.0, Vec3::ZERO);
    /// One, which neither rotates nor stretches.
    pub const ONE: Self = Self::new(1.0, Vec3::ZERO);

    /// Creates a quaternion from its two parts.
    pub const fn new(scalar: f32, vector: Vec3) -> Self {
        Self { scalar, vector }
    }

    /// Returns the quaternion that rotates and stretches `from` into `to`: `to from⁻¹ = (from·to + from×to) / |from|²`.
    /// `None` if `from` is zero, or either is not finite. Opposite vectors give a negative number, which has no axis.
    pub fn quotient(to: Vec3, from: Vec3) -> Option<Self> {
        let unit = direction(from)?;
        let length = from.dot(unit);
        to.is_finite().then(|| Self::new(unit.dot(to) / length, unit.cross(to) * (1.0 / length)))
    }

    /// Makes a versor times a scale: rotates by `angle` (radians) about `axis` (length 1), stretches by `scale`.
    pub fn from_scale_axis_angle(scale: f32, axis: Vec3, angle: f32) -> Self {
        let (sin, cos) = trig::sin_cos(angle);
        Self::new(scale * cos, axis * (scale * sin))
    }

    /// Length, Hamilton's *tensor*: the factor of the stretch. Infinite above 1e19, 0 below 1e-23.
    pub fn norm(self) -> f32 {
        self.norm_squared().sqrt()
    }

    /// The square of the length.
    pub fn norm_squared(self) -> f32 {
        self.scalar * self.scalar + self.vector.length_squared()
    }

    /// Angle of the rotation, radians, 0..=π; 0 for the zero quaternion.
    pub fn angle(self) -> f32 {
        trig::atan2(self.vector.length(), self.scalar)
    }

    /// Unit axis of the rotation. `None` if the vector part is zero: a positive number does not rotate, a negative one
    /// reverses every vector.
    /// vector.
    pub fn axis(self) -> Option<Vec3> {
        direction(self.vector)
    }

    /// The rotation without the stretch: the quaternion at length 1. [`ONE`](Self::ONE) for the zero quaternion and for
    /// one that is not finite.
    pub fn versor(self) -> Self {
        let v = abs3(self.vector);
        let largest = max(max(v.x, v.y), max(v.z, self.scalar.abs()));
        if largest == 0.0 || !self.is_finite() {
            return Self::ONE;
        }
        // Divides by the largest component first, so that squares neither overflow nor vanish.
        let scaled = Self::new(self.scalar / largest, self.vector / largest);
        scaled * (1.0 / scaled.norm())
    }

    /// Converts the rotation to a [`Rotation`] by [`angle`](Self::angle) about [`axis`](Self::axis), which stores half
    /// the angle. Identity for zero; half a turn about x for a negative number, which has no axis.
    pub fn to_rotation(self) -> Rotation {
        let q = self.versor();
        let Some(axis) = q.axis() else {
            return if q.scalar > 0.0 { Rotation::IDENTITY } else { Rotation::from_xyzw(1.0, 0.0, 0.0, 0.0) };
        };
        // tan(θ/2) = sin θ / (1 + cos θ) = (1 − cos θ) / sin θ: uses the form that does not cancel.
        let sin = q.vector.length();
        let (sin, cos) = if q.scalar > 0.0 { (sin, 1.0 + q.scalar) } else { (1.0 - q.scalar, sin) };
        let half = axis * sin;
        Rotation::from_xyzw(half.x, half.y, half.z, cos).normalize()
    }

    /// Conjugate: `w − v`.
    pub fn conjugate(self) -> Self {
        Self::new(self.scalar, -self.vector)
    }

    /// Inverse: `q⁻¹ = q̄ / |q|²`, with `q q⁻¹ = q⁻¹ q = 1`. `None` for a quaternion that is zero or not finite.
    pub fn inverse(self) -> Option<Self> {
        let versor = self.versor();
        let norm = versor.scalar * self.scalar + versor.vector.dot(self.vector);
        (norm > 0.0 && norm < f32::INFINITY).then(|| versor.conjugate() * (1.0 / norm))
    }

    /// Power: `|q|ᵗ (cos tθ + n sin tθ)`, so `q.power(0.5) * q.power(0.5)` is `q`. Zero stays zero. A negative number,
    /// which has no axis, uses x.
    pub fn power(self, t: f32) -> Self {
        let norm = self.norm();
        if norm == 0.0 {
            return Self::ZERO;
        }
        Self::from_scale_axis_angle(trig::pow(norm, t), self.axis().unwrap_or(Vec3::X), self.angle() * t)
    }

    /// Rotates `v` by [`angle`](Self::angle) about [`axis`](Self::axis) and stretches it by [`norm`](Self::norm). A
    /// number multiplies; zero gives zero.
    ///
    /// For `v` perpendicular to the axis the result is the product `q v`, so `Quaternion::quotient(b, a)` takes `a` to
    /// `b`. The component of `v` along the axis is only stretched (Rodrigues): `w v + u × v + (|q| − w) u (u·v)/u²`.
    /// Close to half a turn the axis, and with it that component, depends on the last digits of `u`.
    pub fn apply(self, v: Vec3) -> Vec3 {
        let along = self.axis().map_or(Vec3::ZERO, |axis| axis * axis.dot(v));
        v * self.scalar + self.vector.cross(v) + along * (self.norm() - self.scalar)
    }

    /// Returns `q v q̄`: rotates `v` by twice [`angle`](Self::angle) and stretches it by the square of
    /// [`norm`](Self::norm). Rotations compose as products: `(p q).sandwich(v) = p.sandwich(q.sandwich(v))`.
    pub fn sandwich(self, v: Vec3) -> Vec3 {
        let (w, u) = (self.scalar, self.vector);
        v * (w * w - u.length_squared()) + u * (2.0 * u.dot(v)) + u.cross(v) * (2.0 * w)
    }

    /// True if all four numbers are finite.
    pub fn is_finite(self) -> bool {
        self.scalar.is_finite() && self.vector.is_finite()
    }
}

/// Converts a vector to a quaternion without a scalar part; its square is minus the square of its length.
impl From<Vec3> for Quaternion {
    fn from(v: Vec3) -> Self {
        Self::new(0.0, v)
    }
}

/// Copies the four numbers of a rotation, which hold half its angle: `Quaternion::from(r).sandwich(v)` is `r * v`.
impl From<Rotation> for Quaternion {
    fn from(r: Rotation) -> Self {
        Self::new(r.w, r.vector())
    }
}

impl Add for Quaternion {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self::new(self.scalar + b.scalar, self.vector + b.vector)
    }
}

impl Sub for Quaternion {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self::new(self.scalar - b.scalar, self.vector - b.vector)
    }
}

impl Neg for Quaternion {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.scalar, -self.vector)
    }
}

impl Mul<f32> for Quaternion {
    type Output = Self;
    fn mul(self, k: f32) -> Self {
        Self::new(self.scalar * k, self.vector * k)
    }
}

/// Hamilton's product, `ij = k = −ji`: lengths multiply, and the order of the factors matters.
impl Mul for Quaternion {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let a = self;
        Self::new(
            a.scalar * b.scalar - a.vector.dot(b.vector),
            b.vector * a.scalar + a.vector * b.scalar + a.vector.cross(b.vector),
        )
    }
}
