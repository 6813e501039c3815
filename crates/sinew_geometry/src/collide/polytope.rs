//! Polytope against polytope (hulls, boxes, triangles) by separating axes. Only pairs of edges whose arcs cross on the
//! Gauss map are faces of the Minkowski difference and are tested (Gregorius, "The Separating Axis Test between Convex
//! Polyhedra", GDC 2013). Then the two faces or edges in contact give the points.

use super::arcs::{Arc, for_each_crossing};
use super::axes::{
    Bridge, Faceted, PARALLEL_SINE, choose, choose_face, push, push_bridges, push_faces, tolerance,
};
use super::clip::{PolytopeFace, Reference};
use super::feature::{self, WHOLE, pair};
use super::manifold::{Manifold, SeparationCache};
use super::placed::Segment;
use crate::boxes::separation::{Axis, AxisOf};
use crate::hull::{MAX_VERTICES, Plane, Polytope};
use sinew_math::{Vec3, max, min};

/// Largest number of corners of two hull faces clipped to each other, except for slivers.
const FACE_CORNERS: usize = MAX_VERTICES;
/// Largest number of bridges considered for a contact: corners and edges that are about as close as the closest pair.
const CLOSEST: usize = 16;

/// Finds the contact of two polytopes. `tie` is [`TIE_DIRECTION`](super::axes::TIE_DIRECTION) in their common frame.
pub(super) fn collide(
    a: &Polytope<'_>,
    b: &Polytope<'_>,
    margin: f32,
    tie: Vec3,
    cache: &mut SeparationCache,
    out: &mut Manifold,
) {
    let separates = |axis: &Axis| axis.separation > margin;
    if let Some(axis) = cache.axis.and_then(|of| axis(a, b, of)).filter(separates) {
        cache.gap = axis.separation;
        return;
    }
    cache.axis = None;
    let face_a = best_face(a, b, margin, AxisOf::FaceA);
    if separates(&face_a) {
        *cache = SeparationCache::along(&face_a);
        return;
    }
    let face_b = best_face(b, a, margin, AxisOf::FaceB);
    if separates(&face_b) {
        *cache = SeparationCache::along(&face_b);
        return;
    }
    let edges = best_edges(a, b);
    if let Some(axis) = edges.filter(separates) {
        *cache = SeparationCache::along(&axis);
        return;
    }
    let tolerance = tolerance(a.thickness, b.thickness);
    let face_b = Axis { normal: -face_b.normal, ..face_b };
    let face = choose_face(face_a, face_b, tolerance, tie);
    let best = choose(face, edges, tolerance);
    push(a, b, &best, margin, tolerance, out);
    if let Some(edges) = edges.filter(|edges| edges.of != best.of && edges.separation > best.separation) {
        push_crossing((a, b), &best, &edges, tolerance, out);
    }
}

/// Adds the point where two edges cross. Two edges that separate better than the preferred face may cross beside that
/// face, deeper than all points over it.
fn push_crossing(
    (a, b): (&Polytope<'_>, &Polytope<'_>),
    face: &Axis,
    edges: &Axis,
    tolerance: f32,
    out: &mut Manifold,
) {
    let AxisOf::Edges(i, j) = edges.of else { return };
    let nearest = out.points().iter().fold(f32::INFINITY, |least, point| min(point.separation, least));
    if face.separation > 0.0 || nearest <= face.separation + tolerance + 0.05 * face.separation.abs() {
        return;
    }
    let (edge_a, edge_b) = (a.edge(i), b.edge(j));
    let (s, t) = edge_a.closest_to_segment(&edge_b);
    let (on_a, on_b) = (edge_a.at(s), edge_b.at(t));
    let separation = (on_b - on_a).dot(out.normal);
    if separation < nearest - tolerance {
        let feature = pair(feature::half_edge(a.topology, i), feature::half_edge(b.topology, j));
        out.push_or_replace_shallowest((on_a + on_b) * 0.5, separation, feature);
    }
}

/// Returns the separating axis of the given features, with the same bits as [`best_face`] and [`best_edges`] compute.
/// `None` if an index is out of range, or the Minkowski difference has no face for the pair of edges.
fn axis(a: &Polytope<'_>, b: &Polytope<'_>, of: AxisOf) -> Option<Axis> {
    match of {
        AxisOf::FaceA(k) => a.planes.get(k).map(|plane| face(plane, b, of)),
        AxisOf::FaceB(k) => b.planes.get(k).map(|plane| face(plane, a, of)),
        AxisOf::Edges(i, j) => {
            let there = a.topology.has_edge(i) && b.topology.has_edge(j);
            if there { edges(&Arc::new(a, i), &Arc::new(b, j), of) } else { None }
        }
    }
}

fn face(plane: &Plane, other: &Polytope<'_>, of: AxisOf) -> Axis {
    Axis { normal: plane.normal, separation: -plane.offset - other.reach(-plane.normal), of }
}

/// Returns the face of the polytope `of` with the largest gap, with the face's outward normal; the first face whose gap
/// exceeds `enough`, if there is one.
fn best_face(of: &Polytope<'_>, other: &Polytope<'_>, enough: f32, name: fn(usize) -> AxisOf) -> Axis {
    let mut best = Axis { normal: Vec3::Y, separation: f32::NEG_INFINITY, of: name(0) };
    for (number, plane) in of.planes.iter().enumerate() {
        let axis = face(plane, other, name(number));
        if axis.separation > best.separation {
            best = axis;
            if axis.separation > enough {
                break;
            }
        }
    }
    best
}

/// Returns the cross product of two edges with the largest gap; among equal gaps, the pair with the lowest indices.
fn best_edges(a: &Polytope<'_>, b: &Polytope<'_>) -> Option<Axis> {
    let mut best: Option<Axis> = None;
    for_each_crossing(a, b, |arc, other| {
        let of = AxisOf::Edges(arc.side, other.side);
        let Some(axis) = edges(arc, other, of) else { return };
        let is_better = best.is_none_or(|best| {
            let comes_first = matches!(best.of, AxisOf::Edges(i, j) if (arc.side, other.side) < (i, j));
            axis.separation > best.separation || axis.separation == best.separation && comes_first
        });
        if is_better {
            best = Some(axis);
        }
    });
    best
}

/// Returns the axis across two edges; `None` if the Minkowski difference has no face there, or the edges are parallel.
fn edges(arc: &Arc, other: &Arc, of: AxisOf) -> Option<Axis> {
    let across = arc.crossing(other)?;
    let length = across.length();
    if length <= PARALLEL_SINE * (arc.along.length() * other.along.length()) {
        return None;
    }
    let normal = across / length;
    Some(Axis { normal, separation: normal.dot(other.from - arc.from), of })
}

impl Faceted for Polytope<'_> {
    fn corner(&self, direction: Vec3) -> (usize, Vec3) {
        let index = self.support(direction);
        (index, self.vertices[index])
    }

    fn edge_named(&self, side: usize, _: Vec3) -> (Segment, u16) {
        (self.edge(side), feature::half_edge(self.topology, side))
    }

    fn push_faces(
        &self,
        face: usize,
        other: &Self,
        best: &Axis,
        margin: f32,
        tolerance: f32,
        out: &mut Manifold,
    ) -> bool {
        let reference = PolytopeFace::new(self, face);
        let incident = PolytopeFace::new(other, other.face_at_support(-reference.normal(), tolerance));
        let corners = (incident.feature(), incident.corners());
        push_faces::<FACE_CORNERS>(&reference, corners, best, margin, tolerance, out)
    }

    /// Tests only corners and edges that may be as close as the closest so far, by their positions along `normal`.
    fn push_closest(&self, b: &Self, normal: Vec3, margin: f32, tolerance: f32, out: &mut Manifold) {
        let a = self;
        let (top, bottom) = (a.reach(normal), -b.reach(-normal));
        let size = (b.center - a.center).length();
        // Rounding must not drop one of several equally close pairs.
        let slack = 1e-5 * (size + top.abs() + bottom.abs());
        let from_a = |k: usize| {
            let on_a = a.vertices[k];
            Bridge { on_a, on_b: b.closest(on_a), feature: pair(feature::vertex(k), WHOLE) }
        };
        let from_b = |k: usize| {
            let on_b = b.vertices[k];
            Bridge { on_a: a.closest(on_b), on_b, feature: pair(WHOLE, feature::vertex(k)) }
        };
        let deepest = from_a(a.support(normal)).shorter(from_b(b.support(-normal)));
        let mut within = min(deepest.span().length() + slack, margin);
        let mut best: Option<Bridge> = None;
        let mut try_bridge = |bridge: Bridge, within: &mut f32| {
            let shorter = best.map_or(bridge, |best| best.shorter(bridge));
            *within = min(shorter.span().length() + slack, *within);
            best = Some(shorter);
        };
        for k in 0..a.vertices.len() {
            if bottom - a.vertices[k].dot(normal) <= within {
                try_bridge(from_a(k), &mut within);
            }
        }
        for k in 0..b.vertices.len() {
            if b.vertices[k].dot(normal) - top <= within {
                try_bridge(from_b(k), &mut within);
            }
        }
        for (i, edge_a) in a.topology.edge_numbers().map(|i| (i, a.edge(i))) {
            let highest = edge_a.ends.iter().fold(f32::NEG_INFINITY, |most, p| max(p.dot(normal), most));
            if bottom - highest > within {
                continue;
            }
            for (j, edge_b) in b.topology.edge_numbers().map(|j| (j, b.edge(j))) {
                let lowest = edge_b.ends.iter().fold(f32::INFINITY, |least, p| min(p.dot(normal), least));
                if lowest - highest > within {
                    continue;
                }
                let (s, t) = edge_a.closest_to_segment(&edge_b);
                let feature = pair(feature::half_edge(a.topology, i), feature::half_edge(b.topology, j));
                try_bridge(Bridge { on_a: edge_a.at(s), on_b: edge_b.at(t), feature }, &mut within);
            }
        }
        let Some(best) = best else { return };
        let near = min(best.span().length() + tolerance + slack, margin);
        let of_a = (0..a.vertices.len()).filter(|&k| bottom - a.vertices[k].dot(normal) <= near).map(from_a);
        let of_b = (0..b.vertices.len()).filter(|&k| b.vertices[k].dot(normal) - top <= near).map(from_b);
        push_bridges::<CLOSEST>(best, of_a.chain(of_b), (size, normal), margin, tolerance, out);
    }
}

#[cfg(test)]
mod tests {
    use super::super::placed::PlacedBox;
    use super::*;
    use crate::hull::{BoxPolytope, Hull, TrianglePolytope};
    use sinew_math::{Random, Transform};

    fn gap(a: &Polytope<'_>, b: &Polytope<'_>, n: Vec3) -> f32 {
        -b.reach(-n) - a.reach(n)
    }

    /// The polytope of a triangle (two faces, three edges) gives the best of all face normals and crossed edges, both
    /// ways.
    #[test]
    fn triangle_has_the_features_of_a_polytope() {
        let mut random = Random::new(31);
        let (mut touching, mut faces) = (0, 0);
        for case in 0..3_000 {
            let corners = [random.in_cube(), random.in_cube(), random.in_cube()];
            let Some(normal) = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_normalize()
            else {
                continue;
            };
            let triangle = TrianglePolytope::new(corners, normal);
            let frame = Transform::new(random.in_cube(), random.rotation());
            let cuboid = BoxPolytope::new(&PlacedBox::new(Vec3::new(0.2, 0.3, 0.5), &frame));
            let (a, b) = (triangle.polytope(), cuboid.polytope());
            let mut best = f32::NEG_INFINITY;
            let edges_a = a.topology.edge_numbers().map(|i| a.edge(i));
            for e in edges_a.map(|e| e.ends[1] - e.ends[0]) {
                for f in b.topology.edge_numbers().map(|j| b.edge(j)).map(|e| e.ends[1] - e.ends[0]) {
                    if let Some(n) = e.cross(f).try_normalize() {
                        best =
                            [n, -n].into_iter().fold(best, |best, n| sinew_math::max(gap(&a, &b, n), best));
                    }
                }
            }
            for n in a.planes.iter().map(|p| p.normal).chain(b.planes.iter().map(|p| -p.normal)) {
                best = sinew_math::max(gap(&a, &b, n), best);
            }
            let mut out = Manifold::default();
            collide(&a, &b, 0.0, Vec3::Y, &mut SeparationCache::default(), &mut out);
            assert_eq!(out.count > 0, best <= 0.0, "case {case}: separation {best}, manifold {out:?}");
            if out.count > 0 {
                let along = gap(&a, &b, out.normal);
                let slack = 1e-4 + 0.0011 + 0.06 * best.abs();
                assert!(
                    along > best - slack,
                    "case {case}: separation {along} along the normal, best {best}, {out:?}"
                );
                touching += 1;
                faces += usize::from(out.count > 2);
            }
        }
        assert!(touching > 500 && faces > 100, "{touching} pairs touch, {faces} with at least three points");
    }

    /// Skipping never loses the closest of all corners and edges.
    #[test]
    fn closest_feature_is_kept() {
        let mut random = Random::new(8);
        let mut apart = 0;
        for case in 0..400 {
            let corners = 4 + random.index(40);
            let [a, b] = [Vec3::ZERO, random.direction() * random.range(1.0, 2.5)].map(|center| {
                let points: Vec<Vec3> = (0..corners).map(|_| center + random.direction()).collect();
                Hull::new(&points).expect("points on a ball")
            });
            let (a, b) = (a.polytope(), b.polytope());
            let ways = [(&a, &b), (&b, &a)];
            let corners =
                ways.iter().flat_map(|(p, q)| p.vertices.iter().map(|&v| (q.closest(v) - v).length()));
            let edges_a = a.topology.edge_numbers().map(|i| a.edge(i));
            let edges = edges_a.flat_map(|e| b.topology.edge_numbers().map(move |j| (e, b.edge(j))));
            let between = edges.map(|(e, f)| {
                let (s, t) = e.closest_to_segment(&f);
                (f.at(t) - e.at(s)).length()
            });
            let closest = corners.chain(between).fold(f32::INFINITY, min);
            let axis =
                [best_face(&a, &b, f32::INFINITY, AxisOf::FaceA)].into_iter().chain(best_edges(&a, &b));
            let normal =
                axis.reduce(|p, q| if q.separation > p.separation { q } else { p }).expect("a face").normal;
            if gap(&a, &b, normal) <= 0.0 {
                continue;
            }
            let mut out = Manifold::default();
            a.push_closest(&b, normal, 10.0, 1e-4, &mut out);
            let found = out.points().iter().fold(f32::INFINITY, |least, point| min(point.separation, least));
            assert!((found - closest).abs() <= 1e-5, "case {case}: distance {found}, expected {closest}");
            let mut none = Manifold::default();
            a.push_closest(&b, normal, 0.9 * closest, 1e-4, &mut none);
            assert_eq!(none.count, 0, "case {case}: contact points beyond the margin");
            apart += 1;
        }
        assert!(apart > 100, "{apart}");
    }
}
