//! Capsule against capsule: closest points of the cores; two points if the cores run side by side.

use super::feature::{WHOLE, end, pair};
use super::manifold::{Manifold, SeparationCache};
use super::placed::{PlacedCapsule, direction_or, sign};
use sinew_math::{Vec3, any_orthonormal, min, normalize_or};

/// Parallel cores touch along a line, whose two ends become contact points. This holds if each core is near the plane
/// that contains the other core and the normal: within this share of the smaller radius.
const SIDEWAYS_SHARE: f32 = 0.25;

/// Sine above which cores count as crossing: about half a degree.
const LEAST_SINE: f32 = 0.01;

pub(super) fn collide(
    a: &PlacedCapsule,
    b: &PlacedCapsule,
    margin: f32,
    cache: &mut SeparationCache,
    out: &mut Manifold,
) {
    let (s, t) = a.core.closest_to_segment(&b.core);
    let (pa, pb) = (a.core.at(s), b.core.at(t));
    let cross = a.axis.cross(b.axis);
    let sine = cross.length();
    let inside = |share: f32, pill: &PlacedCapsule| {
        0.0 < share && share < 1.0 && pill.core.ends[0] != pill.core.ends[1]
    };
    // For crossing cores the common perpendicular is exact at any distance, while rounding may dominate the direction
    // between two close points.
    let (normal, separation) = if inside(s, a) && inside(t, b) && sine > LEAST_SINE {
        let gap = (pb - pa).dot(cross) / sine;
        (cross * (sign(gap) / sine), gap.abs() - a.radius - b.radius)
    } else {
        let across = normalize_or(cross, any_orthonormal(a.axis));
        let apart = if across.dot(b.core.at(0.5) - a.core.at(0.5)) < 0.0 { -across } else { across };
        let normal = direction_or(pb - pa, a.radius + b.radius, apart);
        (normal, (pb - pa).length() - a.radius - b.radius)
    };
    if separation > margin {
        cache.gap = separation;
        return;
    }
    out.normal = normal;
    if !push_side_by_side(a, b, margin, out) {
        let position = pa + out.normal * (a.radius + 0.5 * separation);
        out.push(position, separation, pair(WHOLE, WHOLE));
    }
}

/// Pushes the two ends of the part along which the cores run side by side. Returns false and pushes nothing if the
/// cores have no such part.
fn push_side_by_side(a: &PlacedCapsule, b: &PlacedCapsule, margin: f32, out: &mut Manifold) -> bool {
    // The direction uses both cores, so that their order does not matter.
    let common = a.axis + b.axis * sign(a.axis.dot(b.axis));
    let place = |p: Vec3| (p - a.core.ends[0]).dot(common);
    let (end_of_a, [t0, t1]) = (place(a.core.ends[1]), b.core.ends.map(place));
    let (first, last) = if t0 < t1 { ((t0, 0), (t1, 1)) } else { ((t1, 1), (t0, 0)) };
    // Each end of the overlap is an end of one core, opposite a point of the other core.
    let beside_a =
        |i: usize| (a.core.at(a.core.closest(b.core.ends[i])), b.core.ends[i], pair(WHOLE, end(i)));
    let beside_b =
        |i: usize| (a.core.ends[i], b.core.at(b.core.closest(a.core.ends[i])), pair(end(i), WHOLE));
    let ends = [
        if first.0 > 0.0 { beside_a(first.1) } else { beside_b(0) },
        if last.0 < end_of_a { beside_a(last.1) } else { beside_b(1) },
    ];
    // A part shorter than a tenth of the radius counts as a point.
    let thinner = min(a.radius, b.radius);
    let middle = |k: usize| (ends[k].0 + ends[k].1) * 0.5;
    if (middle(1) - middle(0)).length() < 0.1 * thinner {
        return false;
    }
    let sideways = |(pa, pb, _): &(Vec3, Vec3, u32)| {
        let gap = *pb - *pa;
        (gap - out.normal * gap.dot(out.normal)).length()
    };
    if ends.iter().any(|e| sideways(e) > SIDEWAYS_SHARE * thinner) {
        return false;
    }
    for (pa, pb, feature) in ends {
        let separation = (pb - pa).dot(out.normal) - a.radius - b.radius;
        if separation <= margin {
            out.push((pa + pb) * 0.5 + out.normal * (0.5 * (a.radius - b.radius)), separation, feature);
        }
    }
    out.count > 0
}
