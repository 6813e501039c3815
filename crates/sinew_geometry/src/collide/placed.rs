//! Shapes placed in the frame in which a pair is examined, and the distances that the pairs share.

pub(crate) use crate::boxes::placed::{PlacedBox, largest_axis, sign};
pub(crate) use crate::boxes::segment::Segment;
use sinew_math::{Transform, Vec3};

/// Plane with solid matter below it.
pub(crate) struct Plane {
    /// Unit, out of the solid.
    pub normal: Vec3,
    /// Distance of the plane from the origin along the normal.
    pub offset: f32,
}

impl Plane {
    pub fn new(frame: &Transform) -> Self {
        let normal = frame.rotation * Vec3::Y;
        Self { normal, offset: normal.dot(frame.translation) }
    }

    /// Height of a point over the plane.
    pub fn height(&self, p: Vec3) -> f32 {
        p.dot(self.normal) - self.offset
    }
}

/// PlacedSphere.
pub(crate) struct PlacedSphere {
    pub center: Vec3,
    pub radius: f32,
}

impl PlacedSphere {
    pub fn new(radius: f32, frame: &Transform) -> Self {
        Self { center: frame.translation, radius }
    }
}

/// Capsule: a core segment and a radius.
pub(crate) struct PlacedCapsule {
    pub core: Segment,
    /// Unit direction of the core, also where the core is a point.
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

/// Unit direction of the offset between two cores whose radii add up to `radii`, or `fallback` if the cores touch: then
/// the offset is rounding.
pub(crate) fn direction_or(offset: Vec3, radii: f32, fallback: Vec3) -> Vec3 {
    let length = offset.length();
    if length > 1e-3 * radii { offset / length } else { fallback }
}
