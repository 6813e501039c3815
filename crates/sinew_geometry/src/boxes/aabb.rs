//! Axis-aligned boxes, used to search for pairs.

use super::expect_half_extents;
use sinew_math::{Vec3, max3, min3};

/// Distance from the origin to which the bounds of a half-space reach, metres. It is finite, so that sums and
/// differences stay finite, and larger than any world.
pub const HALF_SPACE_REACH: f32 = 1.0e9;

/// Axis-aligned box, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Aabb {
    /// Lowest corner.
    pub min: Vec3,
    /// Highest corner.
    pub max: Vec3,
}

impl Aabb {
    /// Creates a box from two opposite corners, the lowest and the highest.
    ///
    /// # Panics
    /// If a number is not finite, or `min` is above `max` along an axis.
    pub fn new(min: Vec3, max: Vec3) -> Self {
        assert!(min.is_finite() && max.is_finite(), "the corners of a box must be finite");
        assert!(
            min.x <= max.x && min.y <= max.y && min.z <= max.z,
            "the corner `min` of a box must not exceed `max` along any axis"
        );
        Self { min, max }
    }

    /// Creates a box from its centre and half extents.
    ///
    /// # Panics
    /// If a number is not finite or a half extent is negative.
    pub fn around(center: Vec3, half_extents: Vec3) -> Self {
        assert!(center.is_finite(), "the centre of a box must be finite");
        expect_half_extents(half_extents);
        Self::reaching(center, half_extents)
    }

    /// Like [`around`](Self::around), without the checks, for computed values: the world checks bodies for numbers that
    /// are not finite, so this function must not panic because of them.
    #[inline]
    pub fn reaching(center: Vec3, half_extents: Vec3) -> Self {
        Self { min: center - half_extents, max: center + half_extents }
    }

    /// True if the other box is inside this one; the boxes may be equal.
    #[inline]
    pub fn contains(&self, other: &Self) -> bool {
        self.merge(other) == *self
    }

    /// Returns the smallest box that contains both boxes.
    #[must_use]
    #[inline]
    pub fn merge(&self, other: &Self) -> Self {
        Self { min: min3(self.min, other.min), max: max3(self.max, other.max) }
    }

    /// Returns the box enlarged by `margin` (metres) on every side.
    #[must_use]
    #[inline]
    pub fn expand(&self, margin: f32) -> Self {
        Self { min: self.min - Vec3::splat(margin), max: self.max + Vec3::splat(margin) }
    }

    /// Centre, metres.
    #[inline]
    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// Half extents, metres.
    #[inline]
    pub fn half_extents(&self) -> Vec3 {
        (self.max - self.min) * 0.5
    }
}
