//! Replaces the normals of contacts where other shapes hide or continue a surface by the visible normals.

use super::solid::Solid;
use super::{Candidate, name};
use crate::collide::ManifoldPoint;
use crate::collide::feature::pair;
use crate::triangles::{Part, closest_on_triangle};
use sinew_math::{Transform, Vec3, min};

/// Function that gets a point of the surface and a contact normal there, in the world. It returns the visible unit
/// normal of the ground that replaces the contact normal, and the height of the point over the supporting plane with
/// that normal, metres. It returns `None` if other shapes hide the surface there.
pub type Ground<'a> = dyn Fn(Vec3, Vec3) -> Option<(Vec3, f32)> + 'a;

/// Cosine between the visible normal and the candidate's normal above which the candidate is kept unchanged.
const AS_FOUND: f32 = 0.999_999_9;

/// Replaces the normals of the valid candidates by the visible normals of the ground, and voids hidden candidates.
/// `margin` is [`Motion::margin`](super::Motion::margin).
pub(super) fn use_visible_normals(
    ground: &Ground<'_>,
    world_from_center: &Transform,
    (solid, margin): (&Solid<'_>, f32),
    candidates: &mut [Candidate],
    points: &mut Vec<ManifoldPoint>,
) {
    for candidate in candidates.iter_mut().filter(|candidate| candidate.holds) {
        let own = &points[candidate.first as usize..][..candidate.count as usize];
        let deeper = |p: ManifoldPoint, q: ManifoldPoint| if q.separation < p.separation { q } else { p };
        let Some(deepest) = own.iter().copied().reduce(deeper) else { continue };
        // Position of the point when the shape is over the triangle.
        let on_surface = deepest.position - candidate.normal * (0.5 * deepest.separation) + candidate.shift;
        let (at, _) = closest_on_triangle(&candidate.triangle.corners, on_surface);
        let shown = ground(world_from_center.point(at), world_from_center.rotation * candidate.normal);
        let Some((normal, height)) = shown else {
            candidate.holds = false;
            continue;
        };
        let normal = world_from_center.rotation.inverse() * normal;
        if normal.dot(candidate.normal) <= AS_FOUND {
            move_to_plane((normal, at - normal * height), (solid, margin), candidate, points);
        }
    }
}

/// Recomputes a candidate's points over a plane. The points of a box keep their positions on the box; other shapes get
/// the corners of the side that faces the plane.
fn move_to_plane(
    (normal, origin): (Vec3, Vec3),
    (solid, margin): (&Solid<'_>, f32),
    candidate: &mut Candidate,
    points: &mut Vec<ManifoldPoint>,
) {
    let old = candidate.first as usize..(candidate.first + candidate.count) as usize;
    let (first, mut nearest) = (points.len(), f32::INFINITY);
    let mut put = |points: &mut Vec<ManifoldPoint>, on_shape: Vec3, of_shape: u16| {
        let separation = (on_shape - origin).dot(normal);
        if separation <= margin {
            let position = on_shape - normal * (0.5 * separation);
            points.push(ManifoldPoint { position, separation, feature: pair(name::FACE, of_shape) });
            nearest = min(nearest, separation);
        }
    };
    match solid {
        Solid::Box(_) => {
            for i in old {
                let ManifoldPoint { position, separation, feature } = points[i];
                put(points, position + candidate.normal * (0.5 * separation), (feature >> 16) as u16);
            }
        }
        _ => {
            for corner in solid.outline(normal).corners() {
                put(points, corner.at - normal * solid.radius(), corner.of_shape);
            }
        }
    }
    (candidate.normal, candidate.part, candidate.nearest) = (normal, Part::Face, nearest);
    (candidate.first, candidate.count) = (first as u32, (points.len() - first) as u32);
    candidate.holds = candidate.count > 0;
}
