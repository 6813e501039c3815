use crate::{Mat3, Rotation, Vec3};
use core::ops::Mul;

/// A rigid motion: rotate, then translate. `a * b` applies `b` first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Transform {
    /// Translation: image of the origin, metres.
    pub translation: Vec3,
    /// Rotation of the axes.
    pub rotation: Rotation,
}

impl Transform {
    /// The identity: no motion.
    pub const IDENTITY: Self = Self { translation: Vec3::ZERO, rotation: Rotation::IDENTITY };

    /// Creates a transform from rotation and translation.
    #[inline(always)]
    pub const fn new(translation: Vec3, rotation: Rotation) -> Self {
        Self { translation, rotation }
    }

    /// Creates a pure translation.
    #[inline(always)]
    pub const fn from_translation(translation: Vec3) -> Self {
        Self { translation, rotation: Rotation::IDENTITY }
    }

    /// Returns the inverse motion.
    #[inline]
    pub fn inverse(self) -> Self {
        let rotation = self.rotation.inverse();
        Self { translation: -(rotation * self.translation), rotation }
    }

    /// Returns the image of a point.
    #[inline]
    pub fn point(self, p: Vec3) -> Vec3 {
        self.rotation * p + self.translation
    }

    /// Returns the point that the motion maps to `p`: `self.inverse().point(p)`.
    #[inline]
    pub fn inverse_point(self, p: Vec3) -> Vec3 {
        self.rotation.inverse() * (p - self.translation)
    }

    /// True if every number is finite.
    pub fn is_finite(self) -> bool {
        self.translation.is_finite() && self.rotation.is_finite()
    }
}

impl Mul for Transform {
    type Output = Self;
    #[inline]
    fn mul(self, b: Self) -> Self {
        Self { translation: self.point(b.translation), rotation: (self.rotation * b.rotation).normalize() }
    }
}

/// Image of a point, like [`Transform::point`]; for directions and velocities use `transform.rotation * v`.
impl Mul<Vec3> for Transform {
    type Output = Vec3;
    #[inline]
    fn mul(self, point: Vec3) -> Vec3 {
        self.point(point)
    }
}

/// A linear map followed by a translation: joints of a rig may scale and shear. `a * b` applies `b` first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// The linear part; its columns are the images of the axes.
    pub linear: Mat3,
    /// Translation: image of the origin.
    pub translation: Vec3,
}

impl Default for Affine {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Affine {
    /// The identity map.
    pub const IDENTITY: Self = Self { linear: Mat3::IDENTITY, translation: Vec3::ZERO };

    /// Creates a map that scales (per axis), then rotates, then translates.
    pub fn from_scale_rotation_translation(scale: Vec3, rotation: Rotation, translation: Vec3) -> Self {
        let m = rotation.to_mat3();
        Self {
            linear: Mat3::from_cols(m.x_axis * scale.x, m.y_axis * scale.y, m.z_axis * scale.z),
            translation,
        }
    }

    /// Returns the inverse map; not finite if the linear part has no inverse.
    pub fn inverse(&self) -> Self {
        let linear = inverse3(&self.linear);
        Self { linear, translation: -(linear * self.translation) }
    }

    /// Returns the image of a point.
    #[inline]
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.linear * p + self.translation
    }

    /// Returns the image of a direction; the translation does not apply.
    #[inline]
    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.linear * v
    }

    /// Returns the rigid part: the translation, and the rotation of the linear part without scale and shear
    /// (Gram-Schmidt). A mirrored linear part is negated first, so that a change of rotation is the same in both
    /// spaces.
    pub fn to_rigid(&self) -> Transform {
        let linear = if self.is_mirrored() { -self.linear } else { self.linear };
        Transform::new(self.translation, Rotation::from_mat3_lossy(&linear))
    }

    /// True if the linear part maps a right-handed frame to a left-handed one.
    fn is_mirrored(&self) -> bool {
        let m = &self.linear;
        m.x_axis.cross(m.y_axis).dot(m.z_axis) < 0.0
    }

    /// True if every number is finite.
    pub fn is_finite(&self) -> bool {
        self.linear.is_finite() && self.translation.is_finite()
    }
}

impl From<Transform> for Affine {
    fn from(t: Transform) -> Self {
        Self { linear: t.rotation.to_mat3(), translation: t.translation }
    }
}

impl Mul for Affine {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self { linear: self.linear * b.linear, translation: self.point(b.translation) }
    }
}
/// Returns the inverse of a 3×3 matrix by its cofactors; not finite if it has none.
///
/// The inverse of glam has had another order of operations, and so other bits, since version 0.33. This function has
/// the same bits with every version of glam.
pub fn inverse3(m: &Mat3) -> Mat3 {
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    let cofactors = [y.cross(z), z.cross(x), x.cross(y)];
    let scale = 1.0 / z.dot(cofactors[2]);
    let [a, b, c] = cofactors.map(|column| column * scale);
    Mat3::from_cols(a, b, c).transpose()
}
