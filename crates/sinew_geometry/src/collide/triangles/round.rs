//! Balls and capsules against a triangle.

use super::{Recorder, When};
use crate::collide::feature::WHOLE;
use crate::collide::placed::{PlacedCapsule, Segment};
use crate::triangles::{Part, closest_on_triangle};
use sinew_math::{Vec3, min};

/// Tests a ball at the origin: the point of the triangle closest to the centre.
pub(super) fn sphere(radius: f32, recorder: &mut Recorder<'_>) -> Option<Part> {
    let (point, part) = closest_on_triangle(&recorder.triangle.corners, Vec3::ZERO);
    let distance = point.length();
    if distance - radius > recorder.margin {
        return None;
    }
    // If the centre is on an edge, rounding dominates the direction to it, and the triangle's normal is used.
    if part == Part::Face || distance <= 1e-3 * radius {
        let height = recorder.triangle.height(Vec3::ZERO);
        let separation = height - radius;
        let position = -recorder.triangle.normal * (radius + 0.5 * separation);
        recorder.point(recorder.triangle.normal, Part::Face, position, separation, WHOLE);
        return Some(Part::Face);
    }
    let (normal, separation) = (-point / distance, distance - radius);
    recorder.point(normal, part, -normal * (radius + 0.5 * separation), separation, WHOLE);
    Some(part)
}

/// Tests a capsule: the part of the core over the triangle, or the closest points of the core and an edge.
pub(super) fn capsule(pill: &PlacedCapsule, recorder: &mut Recorder<'_>) -> Option<Part> {
    let over = recorder.over_face(Vec3::ZERO);
    let lowest = over.corners().iter().fold(f32::INFINITY, |y, c| min(recorder.triangle.height(c.at), y));
    let nearest = nearest_rim(pill, recorder);
    // A core with an end behind the triangle counts as in contact with the face only if it touches or intersects the
    // triangle.
    let in_front = lowest >= 0.0 || nearest.distance <= recorder.solid.tolerance() || pierces(pill, recorder);
    if in_front && lowest <= nearest.distance + recorder.solid.tolerance() {
        return recorder.face_points(&over, When::Now).then_some(Part::Face);
    }
    let separation = nearest.distance - pill.radius;
    if separation > recorder.margin {
        return None;
    }
    let between = nearest.on_core - nearest.on_rim;
    let precise = nearest.distance > 1e-3 * pill.radius;
    let normal = if precise { between / nearest.distance } else { recorder.triangle.normal };
    let position = nearest.on_core - normal * (pill.radius + 0.5 * separation);
    recorder.point(normal, nearest.part, position, separation, WHOLE);
    Some(nearest.part)
}

/// True if the core intersects the triangle.
fn pierces(pill: &PlacedCapsule, recorder: &Recorder<'_>) -> bool {
    let [from, to] = pill.core.ends.map(|end| recorder.triangle.height(end));
    if from * to > 0.0 {
        return false;
    }
    let at = pill.core.at(from / (from - to));
    closest_on_triangle(&recorder.triangle.corners, at).1 == Part::Face
}

/// Closest points of a core and the rim of a triangle.
struct Nearest {
    distance: f32,
    on_core: Vec3,
    on_rim: Vec3,
    part: Part,
}

fn nearest_rim(pill: &PlacedCapsule, recorder: &Recorder<'_>) -> Nearest {
    let corners = recorder.triangle.corners;
    let mut best =
        Nearest { distance: f32::INFINITY, on_core: Vec3::ZERO, on_rim: Vec3::ZERO, part: Part::Face };
    for k in 0..3 {
        let edge = Segment { ends: [corners[k], corners[(k + 1) % 3]] };
        let (s, t) = pill.core.closest_to_segment(&edge);
        let (on_core, on_rim) = (pill.core.at(s), edge.at(t));
        let distance = (on_core - on_rim).length();
        if distance < best.distance {
            best = Nearest { distance, on_core, on_rim, part: Part::on_edge(k, t) };
        }
    }
    best
}
