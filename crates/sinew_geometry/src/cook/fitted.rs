//! Boxes around points, and sample points on boxes.

use crate::boxes::{Aabb, Cuboid, Obb};
use crate::shape::Shape;
use sinew_math::{Random, Rotation, Vec3, max3, min3};

/// Returns the box along the axes of `rotation` around points; half extents below `least` (metres) are increased to
/// that.
pub(super) fn around(points: impl Iterator<Item = Vec3>, rotation: Rotation, least: f32) -> Obb {
    let (mut low, mut high) = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
    for p in points {
        let local = rotation.inverse() * p;
        low = min3(low, local);
        high = max3(high, local);
    }
    from_corners(low, high, rotation, least)
}

/// Returns the box between two corners in the axes of `rotation`; half extents below `least` (metres) are increased to
/// that.
pub(super) fn from_corners(low: Vec3, high: Vec3, rotation: Rotation, least: f32) -> Obb {
    let half_extents = max3((high - low) * 0.5, Vec3::splat(least));
    Obb { center: rotation * ((low + high) * 0.5), rotation, half_extents }
}

/// Returns the box as a shape around its centre.
pub(super) fn shape(obb: &Obb) -> Shape {
    Shape::Box { half_extents: obb.half_extents }
}

pub(super) fn bounds(obb: &Obb) -> Aabb {
    shape(obb).aabb(&obb.to_transform())
}

/// Adds `count` points of a box's surface to `out`, uniform by area, in strata.
pub(super) fn sample_surface(obb: &Obb, count: usize, random: &mut Random, out: &mut Vec<Vec3>) {
    let h = obb.half_extents;
    let faces = [h.y * h.z, h.z * h.x, h.x * h.y];
    let total = 2.0 * (faces[0] + faces[1] + faces[2]);
    let placed = obb.placed();
    for k in 0..count {
        let mut along = (k as f32 + random.unit()) / count as f32 * total;
        let mut face = 0;
        while face < 5 && along >= faces[face / 2] {
            along -= faces[face / 2];
            face += 1;
        }
        let mut p = random.in_cube() * h;
        p[face / 2] = if face % 2 == 0 { -h[face / 2] } else { h[face / 2] };
        out.push(placed.point(p));
    }
}
