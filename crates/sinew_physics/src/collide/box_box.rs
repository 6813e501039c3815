//! Box against box: separating axes (Gottschalk, Lin & Manocha 1996), then the two faces or the two edges that meet.

use super::clip::{self, Face};
use super::feature::{self, WHOLE, pair};
use super::placed::{PlacedBox, Segment, sign};
use super::reduce::{midway, push_best};
use super::{Manifold, ManifoldPoint};
use crate::boxes::separation::{Axis, AxisOf, best_edges, best_face};
use sinew_math::{Vec3, min};

/// Edges whose sine is below this are taken as parallel: the faces' axes then say all there is to say.
const PARALLEL_SINE: f32 = 0.005;

/// Settles ties between the faces of A and B by geometry, so that neither the order of the shapes nor rounding
/// decides. No common direction of a level (axes, diagonals) is at right angles to it.
const TIE_DIRECTION: Vec3 = Vec3::new(0.331, 0.873, 0.357);

pub(super) fn collide(a: &PlacedBox, b: &PlacedBox, margin: f32, out: &mut Manifold) {
    let tolerance = tolerance(a, b);
    let (face_a, face_b) = (best_face(a, b, 1.0, AxisOf::FaceA), best_face(b, a, -1.0, AxisOf::FaceB));
    let face = choose_face(face_a, face_b, tolerance);
    if face_a.separation > margin || face_b.separation > margin {
        return;
    }
    let axis = match best_edges(a, b, PARALLEL_SINE) {
        Some(edges) if edges.separation > margin => return,
        // Faces give up to four points and hold better: edges must be clearly the better axis.
        Some(edges) if edges.separation > face.separation + tolerance + 0.05 * face.separation.abs() => edges,
        _ => face,
    };
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

/// Below which lengths don't matter for the choice of features: 1 % of the thinnest half side, at most 0.5 mm.
fn tolerance(a: &PlacedBox, b: &PlacedBox) -> f32 {
    min(0.0005, 0.01 * min(a.thinnest(), b.thinnest()))
}

/// The better of the two. Faces that lie on each other are as good, and one of them is kept to.
fn choose_face(a: Axis, b: Axis, tolerance: f32) -> Axis {
    let tied = (a.separation - b.separation).abs() <= tolerance && a.normal.dot(b.normal) > 0.9;
    let a_wins = if tied { a.normal.dot(TIE_DIRECTION) > 0.0 } else { a.separation > b.separation };
    if a_wins { a } else { b }
}

/// The other box's face cut to the reference face. False, and nothing pushed, if that does not show how far the
/// boxes are apart: they pass each other beside the face.
fn push_faces(
    of: &PlacedBox,
    axis: usize,
    other: &PlacedBox,
    best: &Axis,
    margin: f32,
    tolerance: f32,
    out: &mut Manifold,
) -> bool {
    let is_a = matches!(best.of, AxisOf::FaceA(_));
    let outward = if is_a { best.normal } else { -best.normal };
    let reference = Face { of, axis, sign: sign(of.axes[axis].dot(outward)) };
    let (incident_axis, incident_sign) = other.facing(-outward);
    let incident = Face { of: other, axis: incident_axis, sign: incident_sign };

    let mut points = [ManifoldPoint::default(); clip::MAX_CORNERS];
    let (mut count, mut nearest) = (0, f32::INFINITY);
    for corner in clip::clip(&reference, &incident, tolerance).corners() {
        let separation = corner.local.z;
        nearest = min(separation, nearest);
        if separation <= margin {
            let feature = if is_a {
                pair(corner.reference, corner.incident)
            } else {
                pair(corner.incident, corner.reference)
            };
            let position = midway(reference.point(corner.local), outward, separation);
            points[count] = ManifoldPoint { position, separation, feature };
            count += 1;
        }
    }
    if best.separation > 0.0 && nearest > best.separation + tolerance {
        return false;
    }
    out.normal = best.normal;
    push_best(&points[..count], tolerance, out);
    out.count > 0
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

/// A pair of points on A and B.
#[derive(Clone, Copy, Default)]
struct Bridge {
    on_a: Vec3,
    on_b: Vec3,
    feature: u32,
}

impl Bridge {
    fn span(&self) -> Vec3 {
        self.on_b - self.on_a
    }
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
    let shorter = |x: Bridge, y: Bridge| if y.span().length() < x.span().length() { y } else { x };
    let best = corners.into_iter().chain(edge_bridges(a, b)).reduce(shorter).unwrap_or_default();
    let separation = best.span().length();
    if separation > margin {
        return;
    }
    // The direction between points that all but coincide is noise.
    let precise = separation > 2e-5 * (a.half + b.half).length();
    out.normal = if precise { best.span() / separation } else { fallback };

    // Parallel edges are equally close along a line, at whose ends there are corners.
    let mut points = [ManifoldPoint::default(); 16];
    let mut count = 0;
    for bridge in corners {
        let (length, along) = (bridge.span().length(), bridge.span().dot(out.normal));
        let position = (bridge.on_a + bridge.on_b) * 0.5;
        let known = points[..count].iter().any(|p| (p.position - position).length() <= 2.0 * tolerance);
        if length <= separation + tolerance && along >= 0.99 * length && !known {
            points[count] = ManifoldPoint { position, separation: along, feature: bridge.feature };
            count += 1;
        }
    }
    if count > 0 {
        push_best(&points[..count], tolerance, out);
    } else {
        out.push((best.on_a + best.on_b) * 0.5, separation, best.feature);
    }
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
