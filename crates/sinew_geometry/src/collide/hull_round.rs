//! Hull against ball and capsule: closest points of the hull and the core while they are apart, separating axes once a
//! capsule's core has entered the hull. Computed in the hull's frame.

use super::axes::{PARALLEL_SINE, choose};
use super::feature::{self, WHOLE, pair};
use super::line::Line;
use super::manifold::{Manifold, SeparationCache};
use super::placed::Segment;
use crate::boxes::separation::{Axis, AxisOf};
use crate::hull::{Plane, Polytope};
use sinew_math::{Vec3, max, min};

/// Sine between the normal and a face's normal below which the face's normal is used: 0.03°, more than the rounding
/// error.
const FACE_SINE: f32 = 5e-4;
/// Upper bound of the rounding error of the parameters that bound a part of the core.
const ROUNDING: f32 = 1e-3;
/// Sine below which a core counts as parallel to an edge: 1.7°.
const ALONG_SINE: f32 = 0.03;

pub(super) fn against_sphere(
    hull: &Polytope<'_>,
    center: Vec3,
    radius: f32,
    margin: f32,
    cache: &mut SeparationCache,
    out: &mut Manifold,
) {
    let (distance, normal) = hull.distance(center);
    let separation = distance - radius;
    if separation > margin {
        cache.gap = separation;
        return;
    }
    out.normal = normal;
    // One id for all features of the hull, so that the contact of a ball rolling over an edge persists.
    out.push(center - normal * (radius + 0.5 * separation), separation, pair(WHOLE, WHOLE));
}

/// Closest or deepest points of a hull and the core of a capsule.
struct Meeting {
    /// Unit normal, out of the hull.
    normal: Vec3,
    on_core: Vec3,
    /// Distance between core and hull, metres; negative if the core has entered.
    distance: f32,
    /// Half-edge of the hull, if an edge is touched.
    edge: Option<usize>,
}

pub(super) fn against_capsule(
    hull: &Polytope<'_>,
    core: &Segment,
    radius: f32,
    margin: f32,
    cache: &mut SeparationCache,
    out: &mut Manifold,
) {
    let meeting = closest_outside(hull, core).unwrap_or_else(|| shortest_way_out(hull, core, radius));
    let nearest = meeting.distance - radius;
    if nearest > margin {
        cache.gap = nearest;
        return;
    }
    if !push_line(hull, core, radius, &meeting, margin, out) {
        out.normal = meeting.normal;
        let position = meeting.on_core - meeting.normal * (radius + 0.5 * nearest);
        out.push(position, nearest, pair(WHOLE, WHOLE));
    }
}

/// Returns the closest points if the core is clearly outside the hull. The point on the core is one of its ends, or the
/// point on the hull is on an edge.
fn closest_outside(hull: &Polytope<'_>, core: &Segment) -> Option<Meeting> {
    let [from, to] = core.ends;
    let enters = |p: Vec3, way: Vec3| hull.enter(p, way).is_some_and(|(fraction, _)| fraction <= 1.0);
    if core.ends.iter().any(|&p| hull.highest_plane(p).0 <= 0.0) || enters(from, to - from) {
        return None;
    }
    let mut best = (f32::INFINITY, Vec3::ZERO, Vec3::ZERO, None);
    let mut consider = |on_core: Vec3, on_hull: Vec3, edge: Option<usize>| {
        let squared = (on_core - on_hull).length_squared();
        if squared < best.0 {
            best = (squared, on_core, on_hull, edge);
        }
    };
    for p in core.ends {
        consider(p, hull.closest(p), None);
    }
    for side in hull.topology.edge_numbers() {
        let edge = hull.edge(side);
        let (s, t) = core.closest_to_segment(&edge);
        consider(core.at(s), edge.at(t), Some(side));
    }
    let (squared, on_core, on_hull, edge) = best;
    let distance = squared.sqrt();
    // The direction between points closer than rounding is noise.
    let reach = 2.0 * (on_core - hull.center).length();
    (distance > 1e-4 * reach).then(|| Meeting {
        normal: (on_core - on_hull) / distance,
        on_core,
        distance,
        edge,
    })
}

/// Returns the shortest way of the core out of the hull, along the face normals and the cross products of core and
/// edges.
fn shortest_way_out(hull: &Polytope<'_>, core: &Segment, radius: f32) -> Meeting {
    let lower = |plane: &Plane| min(plane.height(core.ends[0]), plane.height(core.ends[1]));
    let mut face = Axis { normal: Vec3::Y, separation: f32::NEG_INFINITY, of: AxisOf::FaceA(0) };
    for (k, plane) in hull.planes.iter().enumerate() {
        if lower(plane) > face.separation {
            face = Axis { normal: plane.normal, separation: lower(plane), of: AxisOf::FaceA(k) };
        }
    }
    // A face can give two points, so an edge must be clearly better.
    let axis = choose(face, best_edge(hull, core), 0.01 * min(hull.thickness, radius));
    let [p, q] = core.ends;
    let (on_core, edge) = match axis.of {
        AxisOf::Edges(side, _) => (core.at(core.closest_to_segment(&hull.edge(side)).0), Some(side)),
        AxisOf::FaceA(_) | AxisOf::FaceB(_) => {
            (if q.dot(axis.normal) < p.dot(axis.normal) { q } else { p }, None)
        }
    };
    Meeting { normal: axis.normal, on_core, distance: axis.separation, edge }
}

/// Returns the cross product of the core and an edge with the largest gap. On the Gauss map the core is the great
/// circle perpendicular to it, so only edges whose arcs cross that circle are tested.
fn best_edge(hull: &Polytope<'_>, core: &Segment) -> Option<Axis> {
    let along = core.ends[1] - core.ends[0];
    let mut best: Option<Axis> = None;
    for side in hull.topology.edge_numbers() {
        let [n, m] = hull.topology.faces_of(side).map(|face| hull.planes[face].normal);
        if n.dot(along) * m.dot(along) >= 0.0 {
            continue;
        }
        let [from, to] = hull.edge(side).ends;
        let across = (to - from).cross(along);
        let length = across.length();
        if length <= PARALLEL_SINE * ((to - from).length() * along.length()) {
            continue;
        }
        let outward = if across.dot(n + m) < 0.0 { -across } else { across };
        let normal = outward / length;
        let separation = normal.dot(core.ends[0] - from);
        if best.is_none_or(|axis| separation > axis.separation) {
            best = Some(Axis { normal, separation, of: AxisOf::Edges(side, 0) });
        }
    }
    best
}

/// Finds the part of the core over the touched face or along the touched edge, and pushes its two ends. Returns false
/// and pushes nothing if the core touches a corner or crosses an edge, or if the part is too short.
fn push_line(
    hull: &Polytope<'_>,
    core: &Segment,
    radius: f32,
    meeting: &Meeting,
    margin: f32,
    out: &mut Manifold,
) -> bool {
    let along = core.ends[1] - core.ends[0];
    let face = hull.facing(meeting.normal);
    let flat = (meeting.normal - hull.planes[face].normal).length() <= FACE_SINE;
    let mut stretch = (0.0, 1.0);
    let (normal, name, height);
    if flat {
        let plane = hull.planes[face];
        for side in hull.topology.sides(face) {
            let [from, to] = hull.edge(side).ends;
            cut(core, (to - from).cross(plane.normal), from, &mut stretch);
        }
        reach(core, meeting.on_core, &mut stretch);
        (normal, name, height) = (plane.normal, feature::face_number(face), plane.offset);
    } else if let Some(side) = meeting.edge
        && runs_along(&hull.edge(side), along)
    {
        let [from, to] = hull.edge(side).ends;
        cut(core, to - from, to, &mut stretch);
        cut(core, from - to, from, &mut stretch);
        normal = meeting.normal;
        (name, height) =
            (feature::half_edge(hull.topology, side), (meeting.on_core.dot(normal) - meeting.distance));
    } else {
        return false;
    }
    let line = Line { core, radius, stretch, normal, name };
    line.push_ends(|p| p.dot(normal) - height, margin, out)
}

/// Extends the part of the core over a face to include the point `nearest`, unless the part is empty. If two faces are
/// nearly parallel, the core's closest point may be over the other face.
fn reach(core: &Segment, nearest: Vec3, stretch: &mut (f32, f32)) {
    let along = core.ends[1] - core.ends[0];
    let place = (nearest - core.ends[0]).dot(along) / along.length_squared();
    let is_off = place < stretch.0 - ROUNDING || place > stretch.1 + ROUNDING;
    if is_off && stretch.1 - stretch.0 > ROUNDING {
        *stretch = (min(stretch.0, place), max(stretch.1, place));
    }
}

fn runs_along(edge: &Segment, along: Vec3) -> bool {
    let side = edge.ends[1] - edge.ends[0];
    side.cross(along).length() <= ALONG_SINE * (side.length() * along.length())
}

/// Clips `stretch`, a range of the core's parameter, to the inner side of the plane through `at` with the normal
/// `outward` (of any length).
fn cut(core: &Segment, outward: Vec3, at: Vec3, stretch: &mut (f32, f32)) {
    let [d0, d1] = core.ends.map(|p| (p - at).dot(outward));
    if d0 > 0.0 && d1 > 0.0 {
        stretch.1 = stretch.0;
    } else if d0 > 0.0 {
        stretch.0 = max(d0 / (d0 - d1), stretch.0);
    } else if d1 > 0.0 {
        stretch.1 = min(d0 / (d0 - d1), stretch.1);
    }
}
