//! Capsule against capsule: closest points of the cores; two points where the cores run side by side.

use super::Manifold;
use super::feature::{WHOLE, end, pair};
use super::placed::{Pill, Segment};
use sinew_math::{any_orthonormal, clamp, max, min, normalize_or};

/// Cores that run side by side touch along a line; its two ends are used while the cores lie within this share of
/// the smaller radius of each other's plane through the normal.
const SIDEWAYS_SHARE: f32 = 0.25;

pub(super) fn collide(a: &Pill, b: &Pill, margin: f32, out: &mut Manifold) {
    let (s, t) = a.core.closest_to_segment(&b.core);
    let (pa, pb) = (a.core.at(s), b.core.at(t));
    let separation = (pb - pa).length() - a.radius - b.radius;
    if separation > margin {
        return;
    }
    // Crossing cores part along their common perpendicular; cores on one line across it.
    let across = normalize_or(a.axis.cross(b.axis), any_orthonormal(a.axis));
    let apart = if across.dot(b.core.at(0.5) - a.core.at(0.5)) < 0.0 { -across } else { across };
    out.normal = normalize_or(pb - pa, apart);
    if !push_side_by_side(a, b, margin, out) {
        let position = pa + out.normal * (a.radius + 0.5 * separation);
        out.push(position, separation, pair(WHOLE, WHOLE));
    }
}

/// The two ends of the stretch along which the cores run side by side; false, and nothing pushed, if they don't.
fn push_side_by_side(a: &Pill, b: &Pill, margin: f32, out: &mut Manifold) -> bool {
    let along = a.core.ends[1] - a.core.ends[0];
    let length_squared = along.dot(along);
    if length_squared <= f32::MIN_POSITIVE {
        return false;
    }
    let parameter = |i: usize| clamp((b.core.ends[i] - a.core.ends[0]).dot(along) / length_squared, 0.0, 1.0);
    let (t0, t1) = (parameter(0), parameter(1));
    let (lo, hi) = (min(t0, t1), max(t0, t1));
    // Shorter than a tenth of the radius, the stretch is a point.
    if (hi - lo) * length_squared.sqrt() < 0.1 * min(a.radius, b.radius) {
        return false;
    }
    let sideways_max = SIDEWAYS_SHARE * min(a.radius, b.radius);
    let line_b = Segment { ends: b.core.ends };
    let mut points = [None; 2];
    for (i, t) in [lo, hi].into_iter().enumerate() {
        let pa = a.core.at(t);
        let gap = line_b.at(line_b.closest(pa)) - pa;
        let along_normal = gap.dot(out.normal);
        if (gap - out.normal * along_normal).length() > sideways_max {
            return false;
        }
        points[i] = Some((pa, along_normal - a.radius - b.radius));
    }
    for (i, (pa, separation)) in points.into_iter().flatten().enumerate() {
        if separation <= margin {
            out.push(pa + out.normal * (a.radius + 0.5 * separation), separation, pair(end(i), WHOLE));
        }
    }
    out.count > 0
}
