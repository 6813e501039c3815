//! Box against capsule: closest points of the box and the core while they are apart, separating axes once the core has
//! entered the box. Computed in the box's frame.

use super::feature::{self, WHOLE, pair};
use super::line::Line;
use super::manifold::{Manifold, SeparationCache};
use super::placed::{PlacedBox, PlacedCapsule, Segment, largest_axis, sign};
use crate::boxes::segment::{Gap, Meeting, best_edge, best_face, cut, gap};
use sinew_math::{Vec3, min};

/// Sine between the normal and a face's normal below which the face's normal is used: 0.03°, more than the rounding
/// error, also at the ends of a long box.
const FACE_SINE: f32 = 5e-4;
/// Cosine above which a core counts as parallel to an edge of the box: 1.8°.
const ALONG_COSINE: f32 = 0.9995;
/// Sine below which a normal counts as perpendicular to that edge: 1.7°.
const ACROSS_SINE: f32 = 0.03;
/// Sine below which a core that has entered the box counts as parallel to an axis of the box; then the face axes
/// suffice.
const PARALLEL_SINE: f32 = 0.005;

pub(super) fn collide(
    a: &PlacedBox,
    b: &PlacedCapsule,
    margin: f32,
    cache: &mut SeparationCache,
    out: &mut Manifold,
) {
    let core = Segment { ends: b.core.ends.map(|p| a.local_point(p)) };
    let meeting = closest_outside(a.half, &core).unwrap_or_else(|| shortest_way_out(a.half, &core, b.radius));
    let nearest = (meeting.on_core - meeting.on_box).dot(meeting.normal) - b.radius;
    if nearest > margin {
        cache.gap = nearest;
        return;
    }
    if !push_line(a.half, &core, b.radius, &meeting, margin, out) {
        out.normal = meeting.normal;
        let position = meeting.on_core - meeting.normal * (b.radius + 0.5 * nearest);
        out.push(position, nearest, pair(WHOLE, WHOLE));
    }
    out.normal = a.vector(out.normal);
    for point in &mut out.points[..out.count] {
        point.position = a.point(point.position);
    }
}

/// Returns the closest points if the core is clearly outside the box.
fn closest_outside(half: Vec3, core: &Segment) -> Option<Meeting> {
    let Gap { on_core, on_box, distance } = gap(half, core)?;
    // The direction between points closer than rounding is noise.
    let reach = half.length() + on_core.length();
    (distance > 1e-4 * reach).then(|| Meeting { normal: (on_core - on_box) / distance, on_box, on_core })
}

/// Returns the shortest way of the core out of the box, along the face normals and the cross products of core and
/// edges.
fn shortest_way_out(half: Vec3, core: &Segment, radius: f32) -> Meeting {
    let (face_gap, face) = best_face(half, core);
    // A face can give two points, so an edge must be clearly better.
    let preference = 0.05 * face_gap.abs() + 0.01 * min(min(half.x, half.y), min(half.z, radius));
    match best_edge(half, core, PARALLEL_SINE) {
        Some((edge_gap, edge)) if edge_gap > face_gap + preference => edge,
        _ => face,
    }
}

/// Finds the part of the core over the touched face or along the touched edge, and pushes its two ends. Returns false
/// and pushes nothing if the core touches a corner or crosses an edge, or if the part is too short.
fn push_line(
    half: Vec3,
    core: &Segment,
    radius: f32,
    meeting: &Meeting,
    margin: f32,
    out: &mut Manifold,
) -> bool {
    let along = core.ends[1] - core.ends[0];
    let length = along.length();
    let mut stretch = (0.0, 1.0);
    let face = largest_axis(meeting.normal);
    let along_axis = largest_axis(along);
    let mut straight = Vec3::ZERO;
    straight[face] = sign(meeting.normal[face]);
    let (normal, name);
    if (meeting.normal - straight).length() <= FACE_SINE {
        (normal, name) = (straight, feature::face(face, straight[face]));
        for axis in (0..3).filter(|axis| *axis != face) {
            if !cut(core, axis, half[axis], &mut stretch) {
                return false;
            }
        }
    } else if along[along_axis].abs() >= ALONG_COSINE * length
        && meeting.normal[along_axis].abs() < ACROSS_SINE
    {
        (normal, name) = (meeting.normal, feature::edge(along_axis, corner_index(meeting.on_box)));
        if !cut(core, along_axis, half[along_axis], &mut stretch) {
            return false;
        }
    } else {
        return false;
    }
    let line = Line { core, radius, stretch, normal, name };
    line.push_ends(|p| (p - meeting.on_box).dot(normal), margin, out)
}

/// Index of the corner in the octant of `p`.
fn corner_index(p: Vec3) -> usize {
    usize::from(p.x > 0.0) | usize::from(p.y > 0.0) << 1 | usize::from(p.z > 0.0) << 2
}
