//! Box against capsule: closest points of the box and the core while they are apart, separating axes once the core
//! has entered the box. Everything happens in the box's frame.

use super::Manifold;
use super::feature::{self, WHOLE, end, pair};
use super::placed::{Obb, Pill, Segment, largest_axis, sign};
use sinew_math::{Vec3, max, max3, min, min3};

/// Where the box and the core are closest, or deepest in each other.
struct Meeting {
    /// Unit, out of the box.
    normal: Vec3,
    on_box: Vec3,
    on_core: Vec3,
}

/// Normals within 0.03° of a face's are that face's: rounding is below that, and the rim of a long box not far off.
const FACE_SINE: f32 = 5e-4;
/// A core within 1.8° of a side's direction runs along it.
const ALONG_COSINE: f32 = 0.9995;
/// A normal within 1.8° of the plane across that side.
const ACROSS_SINE: f32 = 0.03;

pub(super) fn collide(a: &Obb, b: &Pill, margin: f32, out: &mut Manifold) {
    let core = Segment { ends: b.core.ends.map(|p| a.local_point(p)) };
    let meeting = apart(a.half, &core).unwrap_or_else(|| pierced(a.half, &core, b.radius));
    let nearest = (meeting.on_core - meeting.on_box).dot(meeting.normal) - b.radius;
    if nearest > margin {
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

/// The closest points, if the core is clearly outside the box: one of them is an end of the core, or lies on an edge.
fn apart(half: Vec3, core: &Segment) -> Option<Meeting> {
    let mut inside = (0.0, 1.0);
    if (0..3).all(|axis| cut(core, axis, half[axis], &mut inside)) {
        return None;
    }
    let mut best = (f32::INFINITY, Vec3::ZERO, Vec3::ZERO);
    let mut consider = |on_core: Vec3, on_box: Vec3| {
        let squared = (on_core - on_box).dot(on_core - on_box);
        if squared < best.0 {
            best = (squared, on_core, on_box);
        }
    };
    for p in core.ends {
        consider(p, max3(min3(p, half), -half));
    }
    for axis in 0..3 {
        for corner in 0..4 {
            let edge = edge(half, axis, [corner & 1 == 1, corner & 2 == 2]);
            let (s, t) = core.closest_to_segment(&edge);
            consider(core.at(s), edge.at(t));
        }
    }
    let (squared, on_core, on_box) = best;
    let distance = squared.sqrt();
    // Closer than rounding can tell, the direction between the points is noise.
    let reach = half.length() + on_core.length();
    (distance > 1e-4 * reach).then(|| Meeting { normal: (on_core - on_box) / distance, on_box, on_core })
}

/// The box's edge along `axis`, on the given sides of the other two axes.
fn edge(half: Vec3, axis: usize, positive: [bool; 2]) -> Segment {
    let mut from = half;
    for (k, positive) in [(axis + 1) % 3, (axis + 2) % 3].into_iter().zip(positive) {
        from[k] = if positive { half[k] } else { -half[k] };
    }
    let mut to = from;
    from[axis] = -half[axis];
    to[axis] = half[axis];
    Segment { ends: [from, to] }
}

/// The shortest way out, over the box's faces and the directions across the core and an edge.
fn pierced(half: Vec3, core: &Segment, radius: f32) -> Meeting {
    let (face_gap, face) = best_face(half, core);
    // A face can carry two points: an edge must be clearly the better way.
    let preference = 0.05 * face_gap.abs() + 0.01 * min(min(half.x, half.y), min(half.z, radius));
    match best_edge(half, core) {
        Some((edge_gap, edge)) if edge_gap > face_gap + preference => edge,
        _ => face,
    }
}

fn best_face(half: Vec3, core: &Segment) -> (f32, Meeting) {
    let mut best = (f32::NEG_INFINITY, 0, 1.0);
    for axis in 0..3 {
        for side in [1.0, -1.0] {
            let lowest = min(core.ends[0][axis] * side, core.ends[1][axis] * side);
            if lowest - half[axis] > best.0 {
                best = (lowest - half[axis], axis, side);
            }
        }
    }
    let (gap, axis, side) = best;
    let mut normal = Vec3::ZERO;
    normal[axis] = side;
    let [p, q] = core.ends;
    let on_core = if q[axis] * side < p[axis] * side { q } else { p };
    (gap, Meeting { normal, on_box: on_core - normal * gap, on_core })
}

fn best_edge(half: Vec3, core: &Segment) -> Option<(f32, Meeting)> {
    let along = core.ends[1] - core.ends[0];
    let mut best: Option<(f32, usize, Vec3)> = None;
    for axis in 0..3 {
        let mut side = Vec3::ZERO;
        side[axis] = 1.0;
        let across = side.cross(along);
        let length = across.length();
        if length <= 0.005 * along.length() {
            continue;
        }
        let normal = across * (sign(across.dot(core.ends[0])) / length);
        let width = half.x * normal.x.abs() + half.y * normal.y.abs() + half.z * normal.z.abs();
        let gap = core.ends[0].dot(normal) - width;
        if best.is_none_or(|(other, ..)| gap > other) {
            best = Some((gap, axis, normal));
        }
    }
    let (gap, axis, normal) = best?;
    let edge = edge(half, axis, [normal[(axis + 1) % 3] > 0.0, normal[(axis + 2) % 3] > 0.0]);
    let (s, t) = core.closest_to_segment(&edge);
    Some((gap, Meeting { normal, on_box: edge.at(t), on_core: core.at(s) }))
}

/// The two ends of the stretch of the core that lies over the face or along the edge it meets. False, and nothing
/// pushed, if it meets a corner, crosses an edge, or the stretch is too short to tell two points apart.
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
    if (stretch.1 - stretch.0) * length < 0.1 * radius {
        return false;
    }
    out.normal = normal;
    for (index, t) in [stretch.0, stretch.1].into_iter().enumerate() {
        let p = core.at(t);
        let separation = (p - meeting.on_box).dot(normal) - radius;
        if separation <= margin {
            out.push(p - normal * (radius + 0.5 * separation), separation, pair(name, end(index)));
        }
    }
    out.count > 0
}

/// Of the corner in the octant of `p`.
fn corner_index(p: Vec3) -> usize {
    usize::from(p.x > 0.0) | usize::from(p.y > 0.0) << 1 | usize::from(p.z > 0.0) << 2
}

/// Narrows the stretch of the segment to what lies within `half` of the middle along `axis`; false if nothing does.
fn cut(segment: &Segment, axis: usize, half: f32, stretch: &mut (f32, f32)) -> bool {
    let from = segment.ends[0][axis];
    let step = segment.ends[1][axis] - from;
    if step.abs() <= 1e-12 * half {
        return from.abs() <= half;
    }
    let (t0, t1) = ((-half - from) / step, (half - from) / step);
    *stretch = (max(min(t0, t1), stretch.0), min(max(t0, t1), stretch.1));
    stretch.0 <= stretch.1
}
