//! Probes: shapes at a pose, for queries.

use crate::body::shape::Shape;
use crate::boxes::{Aabb, Capsule, Obb, Sphere};
use crate::convex::support::Core;
use sinew_math::{Rotation, Transform, Vec3, normalize_or};

/// A shape at a pose with which a query tests a world; it is not part of the world.
///
/// The shape must be convex and bounded. Sizes may be 0: a box without height is a rectangle, a ball without radius a
/// point.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Shape of the probe.
    pub shape: Shape,
    /// Pose of the shape in the world, with a rotation of length 1.
    pub world_from_shape: Transform,
}

impl Probe {
    /// Returns a probe with a shape at a pose.
    pub fn new(shape: Shape, world_from_shape: Transform) -> Self {
        Self { shape, world_from_shape }
    }

    /// Returns a probe with a shape at a position, without rotation.
    pub fn at(shape: Shape, position: Vec3) -> Self {
        Self::new(shape, Transform::from_translation(position))
    }

    /// True if the numbers of the probe are valid for a query: finite, and no size negative.
    ///
    /// # Panics
    /// If the shape is not convex or not bounded.
    pub(super) fn is_valid(&self) -> bool {
        assert!(Core::of(&self.shape).is_some(), "a probe is convex and bounded");
        let reach = self.shape.bounding_radius();
        // The comparison is false for NaN.
        self.world_from_shape.is_finite() && self.shape.inner_radius() >= 0.0 && reach < f32::INFINITY
    }

    /// Bounds of the probe, world, metres.
    pub(super) fn aabb(&self) -> Aabb {
        self.shape.aabb(&self.world_from_shape)
    }
}

impl From<Obb> for Probe {
    fn from(obb: Obb) -> Self {
        Self::new(Shape::Box { half_extents: obb.half_extents }, obb.to_transform())
    }
}

impl From<Aabb> for Probe {
    fn from(aabb: Aabb) -> Self {
        Obb::from(aabb).into()
    }
}

impl From<Sphere> for Probe {
    fn from(sphere: Sphere) -> Self {
        Self::at(Shape::Sphere { radius: sphere.radius }, sphere.center)
    }
}

impl From<Capsule> for Probe {
    fn from(Capsule { ends: [from, to], radius }: Capsule) -> Self {
        let reach = (to - from) * 0.5;
        let rotation = Rotation::from_arc(Vec3::Y, normalize_or(reach, Vec3::Y));
        let shape = Shape::Capsule { half_height: reach.length(), radius };
        Self::new(shape, Transform::new(from + reach, rotation))
    }
}
