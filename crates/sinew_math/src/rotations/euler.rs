//! Euler angles in all 24 conventions, and gimbal lock.

use crate::limits::wrap;
use crate::{Rotation, Vec3, clamp, trig};
use core::f32::consts::{FRAC_PI_2, PI};

/// Order of three rotations about coordinate axes.
///
/// The first six are Tait-Bryan orders (three different axes, such as heading, pitch and roll), the last six proper
/// Euler orders (first and third axis equal, such as precession, nutation and spin).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EulerOrder {
    /// Rotations about x, y, z.
    Xyz,
    /// Rotations about x, z, y.
    Xzy,
    /// Rotations about y, x, z: heading, pitch and roll of a world with +Y up, with intrinsic axes.
    Yxz,
    /// Rotations about y, z, x.
    Yzx,
    /// Rotations about z, x, y.
    Zxy,
    /// Rotations about z, y, x: yaw, pitch and roll of an aircraft whose z points down, with intrinsic axes.
    Zyx,
    /// Rotations about x, y, x.
    Xyx,
    /// Rotations about x, z, x.
    Xzx,
    /// Rotations about y, x, y.
    Yxy,
    /// Rotations about y, z, y.
    Yzy,
    /// Rotations about z, x, z: the classical angles of a top, with intrinsic axes.
    Zxz,
    /// Rotations about z, y, z.
    Zyz,
}

impl EulerOrder {
    /// All twelve orders.
    pub const ALL: [Self; 12] = [
        Self::Xyz,
        Self::Xzy,
        Self::Yxz,
        Self::Yzx,
        Self::Zxy,
        Self::Zyx,
        Self::Xyx,
        Self::Xzx,
        Self::Yxy,
        Self::Yzy,
        Self::Zxz,
        Self::Zyz,
    ];

    /// Convention in which each rotation is about axes moved by the rotations before it: `R = R₁ R₂ R₃`.
    pub const fn intrinsic(self) -> EulerConvention {
        EulerConvention { order: self, axes: EulerAxes::Moving }
    }

    /// Convention in which each rotation is about fixed axes: `R = R₃ R₂ R₁`.
    pub const fn extrinsic(self) -> EulerConvention {
        EulerConvention { order: self, axes: EulerAxes::Fixed }
    }

    /// Returns the axes in the order of the rotations; 0, 1, 2 for x, y, z.
    pub const fn indices(self) -> [usize; 3] {
        match self {
            Self::Xyz => [0, 1, 2],
            Self::Xzy => [0, 2, 1],
            Self::Yxz => [1, 0, 2],
            Self::Yzx => [1, 2, 0],
            Self::Zxy => [2, 0, 1],
            Self::Zyx => [2, 1, 0],
            Self::Xyx => [0, 1, 0],
            Self::Xzx => [0, 2, 0],
            Self::Yxy => [1, 0, 1],
            Self::Yzy => [1, 2, 1],
            Self::Zxz => [2, 0, 2],
            Self::Zyz => [2, 1, 2],
        }
    }

    /// True if the first and the third axis are the same.
    pub const fn is_proper(self) -> bool {
        let [first, _, third] = self.indices();
        first == third
    }
}

/// Motion of the second and third axis: moved by the earlier rotations, or fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EulerAxes {
    /// The axes move with the earlier rotations: *intrinsic* angles, as in nested rings. The axes are the body's.
    Moving,
    /// The axes do not move: *extrinsic* angles about the world's axes.
    Fixed,
}

/// One of the 24 conventions. Made by [`EulerOrder::intrinsic`] and [`EulerOrder::extrinsic`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct EulerConvention {
    /// Axes of the rotations.
    pub order: EulerOrder,
    /// Axes that rotate with the body (intrinsic) or stay fixed (extrinsic).
    pub axes: EulerAxes,
}

impl EulerConvention {
    /// Iterates over all 24 conventions.
    pub fn all() -> impl Iterator<Item = Self> {
        EulerOrder::ALL.into_iter().flat_map(|order| [order.intrinsic(), order.extrinsic()])
    }
}

/// Gimbal lock: whether the three angles can be separated.
///
/// If the middle rotation aligns the third axis with the first, both rotate about the same line: one degree of freedom
/// is lost, and only a combination of the two outer angles is defined. Every convention has such orientations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GimbalLock {
    /// The three angles can be separated.
    Free,
    /// Only the sum of the first and the third angle is determined. The third is given as 0.
    OnlySum,
    /// Only the difference of the first and the third angle is determined. The third is given as 0.
    OnlyDifference,
}

/// Euler angles of a rotation, and how well the rotation determines them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EulerAngles {
    /// Angles in the order of the rotations, radians. First and third −π..=π; the second −π/2..=π/2 for a Tait-Bryan
    /// order, 0..=π for a proper one.
    pub angles: [f32; 3],
    /// Distance of the second angle from gimbal lock, radians, 0..=π/2. The error of the first and third angle is the
    /// error of the rotation over the sine of this margin: at 0.001 an error of 1e-7 becomes 1e-4.
    pub lock_margin: f32,
    /// Gimbal lock: locked if [`lock_margin`](Self::lock_margin) is below [`EulerAngles::LOCKED_BELOW`].
    pub lock: GimbalLock,
}

impl EulerAngles {
    /// Margin, radians, below which the outer angles are noise. The third angle is then 0, and the first holds the
    /// rotation of both. The rotation is reproduced within this margin. Angles with the second exactly at lock are
    /// always reported as locked.
    pub const LOCKED_BELOW: f32 = 2e-6;
}

impl Rotation {
    /// Makes a rotation from three `angles` (radians, in the order of the rotations, any size). Identity if one is not
    /// finite.
    ///
    /// ```
    /// use sinew_math::{EulerOrder, Rotation, Vec3};
    /// let right = core::f32::consts::FRAC_PI_2;
    /// // Turn left, then look up: the nose (−z) ends up pointing at the sky.
    /// let plane = Rotation::from_euler(EulerOrder::Yxz.intrinsic(), [right, right, 0.0]);
    /// assert!((plane * Vec3::NEG_Z - Vec3::Y).length() < 1e-6);
    /// ```
    pub fn from_euler(convention: EulerConvention, angles: [f32; 3]) -> Self {
        let [first, second, third] = convention.order.indices();
        let turn = |axis: usize, angle: f32| Self::from_axis_angle(Vec3::AXES[axis], angle);
        let (a, b, c) = (turn(first, angles[0]), turn(second, angles[1]), turn(third, angles[2]));
        match convention.axes {
            EulerAxes::Moving => (a * b * c).normalize(),
            EulerAxes::Fixed => (c * b * a).normalize(),
        }
    }

    /// Returns the three angles of this rotation, and whether they are locked.
    ///
    /// After Bernardes & Viollet, "Quaternion to Euler angles conversion: a direct, general and computationally
    /// efficient method", PLoS ONE 17(11), 2022. The quaternion of rotations by α, β, γ about axes i, j, i, with third
    /// axis l and `e_i e_j = ε e_l`, is
    ///
    /// ```text
    /// w   = cos(β/2) cos((α+γ)/2)      q_j   = sin(β/2) cos((α−γ)/2)
    /// q_i = cos(β/2) sin((α+γ)/2)      ε q_l = sin(β/2) sin((α−γ)/2)
    /// ```
    ///
    /// so that two arctangents give sum and difference and a third gives β, without the precision loss of an arccosine.
    /// A quarter turn makes a proper order of a Tait-Bryan order:
    /// `R_i(α) R_j(β) R_l(γ) R_j(π/2) = R_i(α) R_j(β+π/2) R_i(−εγ)`.
    ///
    /// ```
    /// use sinew_math::{EulerOrder, GimbalLock, Rotation};
    /// let nose_up = Rotation::from_euler(EulerOrder::Yxz.intrinsic(), [0.3, core::f32::consts::FRAC_PI_2, 0.5]);
    /// let found = nose_up.to_euler(EulerOrder::Yxz.intrinsic());
    /// // Heading and roll now turn about one line. Only their difference is defined.
    /// assert_eq!(found.lock, GimbalLock::OnlyDifference);
    /// assert_eq!(found.angles[2], 0.0);
    /// assert!((found.angles[0] - (0.3 - 0.5)).abs() < 1e-6);
    /// ```
    pub fn to_euler(self, convention: EulerConvention) -> EulerAngles {
        let order = match convention.axes {
            EulerAxes::Moving => convention.order.indices(),
            // Rotations about fixed axes equal those about moving axes in reverse order.
            EulerAxes::Fixed => {
                let [first, second, third] = convention.order.indices();
                [third, second, first]
            }
        };
        let rings = Rings::of(self, order);
        let is_locked = rings.margin < EulerAngles::LOCKED_BELOW;
        let [outer, inner] = match (is_locked, convention.axes) {
            (false, _) => [rings.outer, rings.inner],
            (true, EulerAxes::Moving) => [rings.outer_alone, 0.0],
            (true, EulerAxes::Fixed) => [0.0, rings.inner_alone],
        }
        .map(wrap);
        let angles = match convention.axes {
            EulerAxes::Moving => [outer, rings.middle, inner],
            EulerAxes::Fixed => [inner, rings.middle, outer],
        };
        let lock = if is_locked { rings.nearest_lock } else { GimbalLock::Free };
        EulerAngles { angles, lock_margin: rings.margin, lock }
    }
}

/// Three nested rings that make up a rotation: rotations about moving axes, outer one first. Angles of the outer and
/// inner ring are within −2π..=2π.
struct Rings {
    outer: f32,
    middle: f32,
    inner: f32,
    /// Difference between the middle angle and the nearer lock, radians.
    margin: f32,
    /// Kind of the nearer lock.
    nearest_lock: GimbalLock,
    /// Outer angle at the nearer lock when the inner one is 0, radians.
    outer_alone: f32,
    /// Inner angle at the nearer lock when the outer one is 0, radians.
    inner_alone: f32,
}

impl Rings {
    fn of(rotation: Rotation, [i, j, k]: [usize; 3]) -> Self {
        let is_proper = i == k;
        let l = 3 - i - j;
        let parity = if (j + 3 - i) % 3 == 1 { 1.0 } else { -1.0 };
        let v = rotation.vector();
        let (w, x, y, z) = (rotation.w, v[i], v[j], parity * v[l]);
        let tilt = 4.0 * (w * y + x * z);
        let [w, x, y, z] = if is_proper { [w, x, y, z] } else { [w - y, x - z, y + w, z + x] };
        // Cosine and sine of half the middle angle.
        let (cos, sin) = ((w * w + x * x).sqrt(), (y * y + z * z).sqrt());
        let middle = if is_proper {
            clamp(2.0 * trig::atan2(sin, cos), 0.0, PI)
        } else {
            // The quarter turn is subtracted as `sin − cos` over `sin + cos`; the former is computed as
            // `(sin² − cos²) / (sin + cos)`, which does not cancel for small angles.
            clamp(2.0 * trig::atan2(tilt / (cos + sin), cos + sin), -FRAC_PI_2, FRAC_PI_2)
        };
        // The inner axis of a Tait-Bryan order is aligned with the outer axis, or opposite to it.
        let sign = if is_proper { 1.0 } else { -parity };
        let (half_sum, half_difference) = (trig::atan2(x, w), trig::atan2(z, y));
        let (small, large, share) = if sin < cos { (sin, cos, 1.0) } else { (cos, sin, -1.0) };
        let alone = 2.0 * if sin < cos { half_sum } else { half_difference };
        Self {
            outer: half_sum + half_difference,
            middle,
            inner: sign * (half_sum - half_difference),
            margin: 2.0 * trig::atan2(small, large),
            nearest_lock: if share == sign { GimbalLock::OnlySum } else { GimbalLock::OnlyDifference },
            outer_alone: alone,
            inner_alone: share * sign * alone,
        }
    }
}
