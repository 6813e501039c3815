//! Segments: their closest points, and their position relative to a box.

use super::placed::sign;
use sinew_math::{Vec3, clamp, max, max3, min, min3};

/// Line segment; its ends may coincide.
#[derive(Clone, Copy)]
pub(crate) struct Segment {
    pub ends: [Vec3; 2],
}

impl Segment {
    /// Point at parameter `t`, 0..=1.
    pub fn at(&self, t: f32) -> Vec3 {
        self.ends[0] + (self.ends[1] - self.ends[0]) * t
    }

    /// Parameter of the point closest to `p`, 0..=1.
    pub fn closest(&self, p: Vec3) -> f32 {
        let d = self.ends[1] - self.ends[0];
        let length_squared = d.dot(d);
        if length_squared > f32::MIN_POSITIVE {
            clamp((p - self.ends[0]).dot(d) / length_squared, 0.0, 1.0)
        } else {
            0.5
        }
    }

    /// Parameters of the closest points on this segment and on the other (Ericson 2005, §5.1.9). If the segments are
    /// parallel, the result is one of the closest pairs of points.
    pub fn closest_to_segment(&self, other: &Self) -> (f32, f32) {
        let (d1, d2) = (self.ends[1] - self.ends[0], other.ends[1] - other.ends[0]);
        let r = self.ends[0] - other.ends[0];
        let (a, e, f) = (d1.dot(d1), d2.dot(d2), d2.dot(r));
        if e <= f32::MIN_POSITIVE {
            return (self.closest(other.ends[0]), 0.5);
        }
        if a <= f32::MIN_POSITIVE {
            return (0.5, other.closest(self.ends[0]));
        }
        let (b, c) = (d1.dot(d2), d1.dot(r));
        // Equals a e sin². The cross product is used because a e − b² loses its digits for nearly parallel segments.
        let cross = d1.cross(d2);
        let denominator = cross.dot(cross);
        let s =
            if denominator > 1e-12 * a * e { clamp((b * f - c * e) / denominator, 0.0, 1.0) } else { 0.5 };
        let t = clamp((b * s + f) / e, 0.0, 1.0);
        (self.closest(other.at(t)), t)
    }
}

/// Closest points of a box and a separated segment (a capsule's core), in the box's frame.
pub(crate) struct Gap {
    pub on_core: Vec3,
    pub on_box: Vec3,
    pub distance: f32,
}

/// Returns the closest points of a segment and the box with these half extents around the origin. `None` if the segment
/// enters the box.
pub(crate) fn gap(half: Vec3, core: &Segment) -> Option<Gap> {
    let on_core = core.at(closest_to_box(half, core));
    let on_box = max3(min3(on_core, half), -half);
    let squared = (on_core - on_box).length_squared();
    (squared > 0.0).then(|| Gap { on_core, on_box, distance: squared.sqrt() })
}

/// Parameter of the segment's point closest to the box, 0..=1; 0 or 1 if an end is as close as the interior.
///
/// The squared distance is convex along the segment. Its slope is piecewise linear, with breaks at the crossings of
/// face planes: the two breaks between which the slope changes sign enclose its zero.
fn closest_to_box(half: Vec3, core: &Segment) -> f32 {
    let (from, step) = (core.ends[0], core.ends[1] - core.ends[0]);
    let outside = |t: f32| {
        let p = from + step * t;
        p - max3(min3(p, half), -half)
    };
    let slope = |t: f32| outside(t).dot(step);
    if slope(0.0) >= 0.0 {
        return 0.0;
    }
    if slope(1.0) <= 0.0 {
        return 1.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for axis in 0..3 {
        for side in [half[axis], -half[axis]] {
            let t = (side - from[axis]) / step[axis];
            if low < t && t < high {
                if slope(t) < 0.0 {
                    low = t;
                } else {
                    high = t;
                }
            }
        }
    }
    let beyond = outside(0.5 * (low + high));
    let (mut along, mut length) = (0.0, 0.0);
    for axis in 0..3 {
        if beyond[axis] != 0.0 {
            let side = if beyond[axis] < 0.0 { -half[axis] } else { half[axis] };
            along += (side - from[axis]) * step[axis];
            length += step[axis] * step[axis];
        }
    }
    if length > 0.0 { clamp(along / length, low, high) } else { low }
}

/// Closest or deepest points of a box and a segment, in the box's frame.
pub(crate) struct Meeting {
    /// Unit normal, out of the box.
    pub normal: Vec3,
    pub on_box: Vec3,
    pub on_core: Vec3,
}

/// Returns the box's edge along `axis`, on the given sides of the other two axes.
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

/// Finds the face through which the core leaves the box by the shortest way. Returns the signed distance along its
/// normal, and the deepest points.
pub(crate) fn best_face(half: Vec3, core: &Segment) -> (f32, Meeting) {
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

/// Like [`best_face`], for the cross products of the segment with the box's axes instead of the faces. Skips axes to
/// which the segment is parallel (sine at most `parallel_sine`); `None` if no axis is left.
pub(crate) fn best_edge(half: Vec3, core: &Segment, parallel_sine: f32) -> Option<(f32, Meeting)> {
    let along = core.ends[1] - core.ends[0];
    let mut best: Option<(f32, usize, Vec3)> = None;
    for axis in 0..3 {
        let mut side = Vec3::ZERO;
        side[axis] = 1.0;
        let across = side.cross(along);
        let length = across.length();
        if length <= parallel_sine * along.length() {
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

/// Clips `stretch`, a range of the segment's parameter, to the part within `half` of the origin along `axis`. Returns
/// false if no part is left.
pub(crate) fn cut(segment: &Segment, axis: usize, half: f32, stretch: &mut (f32, f32)) -> bool {
    let from = segment.ends[0][axis];
    let step = segment.ends[1][axis] - from;
    if step.abs() <= 1e-12 * half {
        return from.abs() <= half;
    }
    let (t0, t1) = ((-half - from) / step, (half - from) / step);
    *stretch = (max(min(t0, t1), stretch.0), min(max(t0, t1), stretch.1));
    stretch.0 <= stretch.1
}
