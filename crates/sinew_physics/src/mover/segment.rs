//! Gap between the axis of a capsule and a triangle that is solid from one side.

use crate::triangles::{Part, Triangle, closest_on_triangle};
use sinew_math::{Vec3, clamp, normalize_or};

/// Gap between a triangle and the axis of a capsule.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisGap {
    /// Distance from the triangle to the axis, metres; negative if the axis crosses the face.
    pub distance: f32,
    /// Unit normal from the triangle to the axis.
    pub normal: Vec3,
    /// Closest point on the triangle.
    pub point: Vec3,
    /// True if the nearest feature is an internal edge, so that a neighbouring triangle is at least as near. The gap is
    /// then relative to the plane of the face.
    pub hidden: bool,
}

/// Cosine of the angle to the face normal below which a direction counts as the face normal.
const ALONG_FACE: f32 = 0.9998;
/// Share of the squared distance by which an edge must be nearer than the other features to count as nearest.
const NEARER: f32 = 1e-6;

/// Returns the gap between a triangle and the axis from `p` to `q`. `None` if the axis is behind the face.
pub(super) fn axis_to_triangle(triangle: &Triangle, [p, q]: [Vec3; 2]) -> Option<AxisGap> {
    let (above_p, above_q) = (triangle.height(p), triangle.height(q));
    if above_p < 0.0 && above_q < 0.0 {
        return None;
    }
    if (above_p < 0.0) != (above_q < 0.0)
        && let Some(gap) = through(triangle, [p, q], [above_p, above_q])
    {
        return Some(gap);
    }
    let (mut on_axis, (mut point, mut part)) = (p, closest_on_triangle(&triangle.corners, p));
    let mut square = (p - point).length_squared();
    let (other, other_part) = closest_on_triangle(&triangle.corners, q);
    if (q - other).length_squared() < square {
        (on_axis, point, part) = (q, other, other_part);
        square = (q - other).length_squared();
    }
    for edge in 0..3 {
        let (from, to) = (triangle.corners[edge], triangle.corners[(edge + 1) % 3]);
        let (s, t) = closest_of_segments([p, q], [from, to]);
        let (a, b) = (p + (q - p) * s, from + (to - from) * t);
        if (a - b).length_squared() < square * (1.0 - NEARER) {
            (on_axis, point, part) = (a, b, Part::on_edge(edge, t));
            square = (a - b).length_squared();
        }
    }
    if triangle.height(on_axis) < 0.0 {
        return None;
    }
    let distance = square.sqrt();
    let normal = if distance > 1e-6 { (on_axis - point) / distance } else { triangle.normal };
    let along_face = part == Part::Face || normal.dot(triangle.normal) > ALONG_FACE;
    if along_face {
        return Some(over_face(triangle, on_axis, false));
    }
    if can_be_hit(triangle, part) {
        return Some(AxisGap { distance, normal, point, hidden: false });
    }
    Some(over_face(triangle, if above_p < above_q { p } else { q }, true))
}

fn over_face(triangle: &Triangle, on_axis: Vec3, hidden: bool) -> AxisGap {
    let distance = triangle.height(on_axis);
    AxisGap { distance, normal: triangle.normal, point: on_axis - triangle.normal * distance, hidden }
}

fn can_be_hit(triangle: &Triangle, part: Part) -> bool {
    match part {
        Part::Face => true,
        Part::Edge(k) => triangle.is_active(k),
        Part::Corner(k) => triangle.is_active(k) || triangle.is_active((k + 2) % 3),
    }
}

/// Returns the gap where the axis crosses the face; the shortest exit is through the front of the face.
fn through(triangle: &Triangle, [p, q]: [Vec3; 2], [above_p, above_q]: [f32; 2]) -> Option<AxisGap> {
    let at = p + (q - p) * (above_p / (above_p - above_q));
    let (closest, _) = closest_on_triangle(&triangle.corners, at);
    if (closest - at).length_squared() > 1e-12 * (1.0 + at.length_squared()) {
        return None;
    }
    let distance = if above_p < above_q { above_p } else { above_q };
    Some(AxisGap { distance, normal: triangle.normal, point: at, hidden: false })
}

/// Fractions along two segments at which the segments are closest (Ericson 2005, §5.1.9).
fn closest_of_segments([p1, q1]: [Vec3; 2], [p2, q2]: [Vec3; 2]) -> (f32, f32) {
    let (d1, d2, r) = (q1 - p1, q2 - p2, p1 - p2);
    let (a, e, f) = (d1.length_squared(), d2.length_squared(), d2.dot(r));
    if a <= 1e-12 {
        return (0.0, if e > 0.0 { clamp(f / e, 0.0, 1.0) } else { 0.0 });
    }
    let c = d1.dot(r);
    if e <= 1e-12 {
        return (clamp(-c / a, 0.0, 1.0), 0.0);
    }
    let b = d1.dot(d2);
    let denominator = a * e - b * b;
    let s = if denominator > 1e-9 * a * e { clamp((b * f - c * e) / denominator, 0.0, 1.0) } else { 0.0 };
    let t = (b * s + f) / e;
    if t < 0.0 {
        (clamp(-c / a, 0.0, 1.0), 0.0)
    } else if t > 1.0 {
        (clamp((b - c) / a, 0.0, 1.0), 1.0)
    } else {
        (s, t)
    }
}

/// Returns the unit vector of the component of `v` perpendicular to `up`, or zero.
pub(super) fn level(v: Vec3, up: Vec3) -> Vec3 {
    let across = v - up * v.dot(up);
    if across.length_squared() > 1e-12 { normalize_or(across, Vec3::ZERO) } else { Vec3::ZERO }
}
