//! Box against box: separating axes (Gottschalk, Lin & Manocha 1996), then the two faces or the two edges that meet.

use super::Manifold;
use super::axes::{
    Bridge, PARALLEL_SINE, TIE_DIRECTION, choose, choose_face, push_bridges, push_faces as push_clipped,
    tolerance,
};
use super::clip::{BOX_CORNERS, BoxFace, Reference};
use super::feature::{self, WHOLE, pair};
use super::placed::{PlacedBox, Segment, sign};
use super::reduce::midway;
use crate::boxes::separation::{Axis, AxisOf, best_edges, best_face};
use sinew_math::Vec3;

pub(super) fn collide(a: &PlacedBox, b: &PlacedBox, margin: f32, out: &mut Manifold) {
    let tolerance = tolerance(a.thinnest(), b.thinnest());
    let (face_a, face_b) = (best_face(a, b, 1.0, AxisOf::FaceA), best_face(b, a, -1.0, AxisOf::FaceB));
    let face = choose_face(face_a, face_b, tolerance, TIE_DIRECTION);
    if face_a.separation > margin || face_b.separation > margin {
        return;
    }
    let edges = best_edges(a, b, PARALLEL_SINE);
    if edges.is_some_and(|edges| edges.separation > margin) {
        return;
    }
    let axis = choose(face, edges, tolerance);
    let touched = match axis.of {
        AxisOf::FaceA(k) => push_faces(a, k, b, &axis, margin, tolerance, out),
        AxisOf::FaceB(k) => push_faces(b, k, a, &axis, margin, tolerance, out),
        AxisOf::Edges(i, j) => push_edges(a, i, b, j, &axis, out),
    };
    if !touched {
        if axis.separation > 0.0 {
            push_closest(a, b, axis.normal, margin, tolerance, out);
        } else {
            push_support(a, b, &axis, out);
        }
    }
}

/// The face of `other` that looks at the reference face, cut to it.
fn push_faces(
    of: &PlacedBox,
    axis: usize,
    other: &PlacedBox,
    best: &Axis,
    margin: f32,
    tolerance: f32,
    out: &mut Manifold,
) -> bool {
    let outward = if matches!(best.of, AxisOf::FaceA(_)) { best.normal } else { -best.normal };
    let reference = BoxFace { of, axis, sign: sign(of.axes[axis].dot(outward)) };
    let (axis, sign) = other.facing(-outward);
    let incident = BoxFace { of: other, axis, sign };
    let face = (incident.feature(), incident.corners());
    push_clipped::<BOX_CORNERS>(&reference, face, best, margin, tolerance, out)
}

/// The edge of `of` along `axis` that reaches furthest along `direction`, and its feature.
fn support_edge(of: &PlacedBox, axis: usize, direction: Vec3) -> (Segment, u16) {
    let index = of.support(direction) & !(1 << axis);
    (Segment { ends: [of.vertex(index), of.vertex(index | 1 << axis)] }, feature::edge(axis, index))
}

/// The closest points of two edges. False, and nothing pushed, if the boxes are apart and these are not their
/// closest points.
fn push_edges(a: &PlacedBox, i: usize, b: &PlacedBox, j: usize, axis: &Axis, out: &mut Manifold) -> bool {
    let (edge_a, feature_a) = support_edge(a, i, axis.normal);
    let (edge_b, feature_b) = support_edge(b, j, -axis.normal);
    let (s, t) = edge_a.closest_to_segment(&edge_b);
    let inside = |x: f32| x > 0.0 && x < 1.0;
    if axis.separation > 0.0 && !(inside(s) && inside(t)) {
        return false;
    }
    out.normal = axis.normal;
    out.push((edge_a.at(s) + edge_b.at(t)) * 0.5, axis.separation, pair(feature_a, feature_b));
    true
}

/// The closest points of two boxes that are apart, by trying corners against boxes and edges against edges: slow
/// and sure, for the rare pairs that pass each other corner by corner or edge by edge.
fn push_closest(
    a: &PlacedBox,
    b: &PlacedBox,
    fallback: Vec3,
    margin: f32,
    tolerance: f32,
    out: &mut Manifold,
) {
    let corners = corner_bridges(a, b);
    let best = corners.into_iter().chain(edge_bridges(a, b)).reduce(Bridge::shorter).unwrap_or_default();
    let size = (a.half + b.half).length();
    push_bridges::<16>(best, corners.into_iter(), (size, fallback), margin, tolerance, out);
}

/// Each corner and the other box's point closest to it.
fn corner_bridges(a: &PlacedBox, b: &PlacedBox) -> [Bridge; 16] {
    core::array::from_fn(|k| {
        let (index, name) = (k % 8, feature::vertex(k % 8));
        if k < 8 {
            let on_a = a.vertex(index);
            Bridge { on_a, on_b: b.closest(on_a), feature: pair(name, WHOLE) }
        } else {
            let on_b = b.vertex(index);
            Bridge { on_a: a.closest(on_b), on_b, feature: pair(WHOLE, name) }
        }
    })
}

/// The closest points of each pair of edges.
fn edge_bridges(a: &PlacedBox, b: &PlacedBox) -> impl Iterator<Item = Bridge> {
    edges(a).flat_map(move |(edge_a, feature_a)| {
        edges(b).map(move |(edge_b, feature_b)| {
            let (s, t) = edge_a.closest_to_segment(&edge_b);
            Bridge { on_a: edge_a.at(s), on_b: edge_b.at(t), feature: pair(feature_a, feature_b) }
        })
    })
}

fn edges(of: &PlacedBox) -> impl Iterator<Item = (Segment, u16)> {
    (0..3).flat_map(move |axis| {
        (0..8).filter(move |index| index >> axis & 1 == 0).map(move |index| {
            let ends = [of.vertex(index), of.vertex(index | 1 << axis)];
            (Segment { ends }, feature::edge(axis, index))
        })
    })
}

/// B's deepest corner, for overlaps that no face or edge describes.
fn push_support(a: &PlacedBox, b: &PlacedBox, axis: &Axis, out: &mut Manifold) {
    let index = b.support(-axis.normal);
    out.normal = axis.normal;
    let position = midway(b.vertex(index), axis.normal, axis.separation);
    out.push(
        position,
        axis.separation,
        pair(feature::vertex(a.support(axis.normal)), feature::vertex(index)),
    );
}
