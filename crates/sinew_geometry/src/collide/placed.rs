//! Shapes placed in the common frame of a pair.

pub(crate) use crate::boxes::placed::{PlacedBox, largest_axis, sign};
pub(crate) use crate::boxes::segment::Segment;
use sinew_math::{Transform, Vec3};

/// Plane of a half-space; the solid is below it.
pub(crate) struct Plane {
    /// Unit normal, out of the solid.
    pub normal: Vec3,
    /// Distance of the plane from the origin along the normal, metres.
    pub offset: f32,
}

impl Plane {
    pub fn new(frame: &Transform) -> Self {
        let normal = frame.rotation * Vec3::Y;
        Self { normal, offset: normal.dot(frame.translation) }
    }

    /// Height of a point over the plane, metres.
    pub fn height(&self, p: Vec3) -> f32 {
        p.dot(self.normal) - self.offset
    }
}

/// A ball placed in the frame of the pair.
pub(crate) struct PlacedSphere {
    pub center: Vec3,
    pub radius: f32,
}

impl PlacedSphere {
    pub fn new(radius: f32, frame: &Transform) -> Self {
        Self { center: frame.translation, radius }
    }
}

/// A capsule placed in the frame of the pair: a core segment and a radius.
pub(crate) struct PlacedCapsule {
    pub core: Segment,
    /// Unit direction of the core, defined even if the core is a point.
    pub axis: Vec3,
    pub radius: f32,
}

impl PlacedCapsule {
    pub fn new(half_height: f32, radius: f32, frame: &Transform) -> Self {
        let axis = frame.rotation * Vec3::Y;
        let reach = axis * half_height;
        let core = Segment { ends: [frame.translation - reach, frame.translation + reach] };
        Self { core, axis, radius }
    }
}

/// Returns the unit direction of the offset between two cores. `radii` is the sum of their radii. Returns `fallback` if
/// the offset is so short that rounding dominates its direction.
pub(crate) fn direction_or(offset: Vec3, radii: f32, fallback: Vec3) -> Vec3 {
    let length = offset.length();
    if length > 1e-3 * radii { offset / length } else { fallback }
}
