//! Boxes with any orientation.

use super::Aabb;
use crate::shape::Shape;
use sinew_math::{Rotation, Transform, Vec3};

/// A box with any orientation (oriented bounding box).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Obb {
    /// Centre, metres.
    pub center: Vec3,
    /// Rotation from the box's axes to the axes of the space that contains it.
    pub rotation: Rotation,
    /// Half extents along the box's own axes, metres, ≥ 0.
    pub half_extents: Vec3,
}

impl Obb {
    /// Creates a box from its centre, rotation and half extents.
    ///
    /// # Panics
    /// If a number is not finite or a half extent is negative.
    pub fn new(center: Vec3, rotation: Rotation, half_extents: Vec3) -> Self {
        assert!(
            center.is_finite() && rotation.is_finite(),
            "the centre and rotation of a box must be finite"
        );
        super::expect_half_extents(half_extents);
        Self { center, rotation, half_extents }
    }

    /// Creates a box around the origin of a frame, along the axes of the frame.
    ///
    /// # Panics
    /// Like [`new`](Self::new).
    pub fn from_transform(frame: &Transform, half_extents: Vec3) -> Self {
        Self::new(frame.translation, frame.rotation, half_extents)
    }

    /// Returns the box's frame: the transform from the box's coordinates to those of the space that contains it.
    pub fn to_transform(&self) -> Transform {
        Transform::new(self.center, self.rotation)
    }

    /// Returns the smallest axis-aligned box around this box, except for rounding. Its half extents are `|R| h` (Arvo,
    /// "Transforming axis-aligned bounding boxes", Graphics Gems 1990).
    pub fn bounds(&self) -> Aabb {
        Shape::Box { half_extents: self.half_extents }.aabb(&self.to_transform())
    }
}

impl From<Aabb> for Obb {
    fn from(aabb: Aabb) -> Self {
        Self { center: aabb.center(), rotation: Rotation::IDENTITY, half_extents: aabb.half_extents() }
    }
}
