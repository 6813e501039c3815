//! Vectors whose coordinates are [`Real`]s.

use super::{Lanes, Real, WIDTH};
use crate::{Rotation, Vec3};
use core::ops::{Add, Mul, Neg, Sub};

/// A vector, or one vector per lane. Sums use the order of [`Vec3`], so the bits are equal.
#[derive(Clone, Copy, Debug)]
pub struct Vector3<R> {
    /// First coordinate.
    pub x: R,
    /// Second coordinate.
    pub y: R,
    /// Third coordinate.
    pub z: R,
}

impl<R: Real> Vector3<R> {
    /// Creates a vector from its coordinates.
    #[inline(always)]
    pub fn new(x: R, y: R, z: R) -> Self {
        Self { x, y, z }
    }

    /// Returns the same vector in every lane.
    #[inline(always)]
    pub fn splat(v: Vec3) -> Self {
        Self::new(R::splat(v.x), R::splat(v.y), R::splat(v.z))
    }

    /// Returns the vector rotated by `by` in all lanes, with the bits of `by * v`.
    #[inline(always)]
    pub fn turned(self, by: Rotation) -> Self {
        let axis = Self::splat(by.vector());
        let across = axis.cross(self) * R::splat(2.0);
        self + across * R::splat(by.w) + axis.cross(across)
    }

    /// Returns the coordinates.
    #[inline(always)]
    pub fn to_array(self) -> [R; 3] {
        [self.x, self.y, self.z]
    }

    /// Sum of the coordinates.
    #[inline(always)]
    pub fn sum(self) -> R {
        self.x + self.y + self.z
    }

    /// Dot product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> R {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Cross product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - other.y * self.z,
            self.z * other.x - other.z * self.x,
            self.x * other.y - other.x * self.y,
        )
    }

    /// Length, in the unit of the coordinates.
    #[inline(always)]
    pub fn length(self) -> R {
        self.dot(self).sqrt()
    }

    /// Component-wise absolute value.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self::new(self.x.abs(), self.y.abs(), self.z.abs())
    }
}

impl<L: Lanes> Vector3<L> {
    /// Loads eight vectors from three rows of a [`Block`](super::Block).
    #[inline(always)]
    pub fn load(x: &[f32; WIDTH], y: &[f32; WIDTH], z: &[f32; WIDTH]) -> Self {
        Self::new(L::load(x), L::load(y), L::load(z))
    }
}

impl From<Vec3> for Vector3<f32> {
    #[inline(always)]
    fn from(v: Vec3) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

impl<R: Real> Add for Vector3<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<R: Real> Sub for Vector3<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<R: Real> Mul<R> for Vector3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: R) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl<R: Real> Neg for Vector3<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}
