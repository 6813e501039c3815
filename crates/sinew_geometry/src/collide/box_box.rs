//! Box against box: separating axes (Gottschalk, Lin & Manocha 1996), then the two faces or the two edges in contact.

use super::axes::{
    Bridge, Faceted, PARALLEL_SINE, TIE_DIRECTION, choose, choose_face, least_of_edges, push, push_bridges,
    push_faces, tolerance,
};
use super::clip::{BOX_CORNERS, BoxFace, Reference};
use super::feature::{self, WHOLE, pair};
use super::manifold::{Manifold, SeparationCache};
use super::placed::{PlacedBox, Segment, sign};
use crate::boxes::separation::{Axis, AxisOf, Crossed, axis};
use sinew_math::{Vec3, max, min, normalize_or};

pub(super) fn collide(
    a: &PlacedBox,
    b: &PlacedBox,
    margin: f32,
    cache: &mut SeparationCache,
    out: &mut Manifold,
) {
    let separates = |axis: &Axis| axis.separation > margin;
    if let Some(axis) = cache.axis.and_then(|of| axis(a, b, of, PARALLEL_SINE)).filter(separates) {
        cache.gap = axis.separation;
        return;
    }
    cache.axis = None;
    let crossed = Crossed::new(a, b);
    let (face_a, face_b) = (crossed.best_face_of_a(), crossed.best_face_of_b());
    if let Some(axis) = [face_a, face_b].iter().find(|axis| separates(axis)) {
        *cache = SeparationCache::along(axis);
        return;
    }
    let tolerance = tolerance(a.thinnest(), b.thinnest());
    let face = choose_face(face_a, face_b, tolerance, TIE_DIRECTION);
    let edges = crossed.best_edges(PARALLEL_SINE, min(margin, least_of_edges(&face, tolerance)));
    if let Some(axis) = edges.filter(separates) {
        *cache = SeparationCache::along(&axis);
        return;
    }
    push(a, b, &choose(face, edges, tolerance), margin, tolerance, out);
}

impl Faceted for PlacedBox {
    fn corner(&self, direction: Vec3) -> (usize, Vec3) {
        let index = self.support(direction);
        (index, self.vertex(index))
    }

    fn edge_named(&self, axis: usize, direction: Vec3) -> (Segment, u16) {
        let index = self.support(direction) & !(1 << axis);
        (Segment { ends: [self.vertex(index), self.vertex(index | 1 << axis)] }, feature::edge(axis, index))
    }

    fn push_faces(
        &self,
        axis: usize,
        other: &Self,
        best: &Axis,
        margin: f32,
        tolerance: f32,
        out: &mut Manifold,
    ) -> bool {
        let outward = if matches!(best.of, AxisOf::FaceA(_)) { best.normal } else { -best.normal };
        let reference = BoxFace::new(self, axis, sign(self.axes[axis].dot(outward)));
        let (axis, sign) = other.facing(-outward);
        let incident = BoxFace::new(other, axis, sign);
        let face = (incident.feature(), incident.corners());
        push_faces::<BOX_CORNERS>(&reference, face, best, margin, tolerance, out)
    }

    fn push_closest(&self, b: &Self, normal: Vec3, margin: f32, tolerance: f32, out: &mut Manifold) {
        let size = (self.half + b.half).length();
        let closest = Closest::new(self, b, normal, margin + tolerance + BLUR * size);
        let mut corners = [Bridge::default(); 16];
        let mut count = 0;
        for bridge in closest.corner_bridges() {
            corners[count] = bridge;
            count += 1;
        }
        let corners = &corners[..count];
        let best = corners.iter().copied().reduce(Bridge::shorter);
        let Some(best) = closest.shortest_edge_bridge(best) else { return };
        push_bridges::<16>(best, corners.iter().copied(), (size, normal), margin, tolerance, out);
    }
}

/// Upper bound of the rounding error of a distance between two boxes, as a share of their size.
const BLUR: f32 = 1e-5;

/// Closest points of two boxes; skips corners and edges that cannot be closest.
struct Closest<'a> {
    boxes: [&'a PlacedBox; 2],
    corners: [[Vec3; 8]; 2],
    /// Coordinate of each corner of A and of B along the separating direction, metres.
    heights: [[f32; 8]; 2],
    /// Coordinates along the separating direction of A's corner nearest to B and of B's corner nearest to A, metres.
    tops: [f32; 2],
    normal: Vec3,
    /// Gap above which pairs of points are skipped, metres.
    most: f32,
}

impl<'a> Closest<'a> {
    fn new(a: &'a PlacedBox, b: &'a PlacedBox, normal: Vec3, most: f32) -> Self {
        let corners = [a, b].map(|of| core::array::from_fn(|k| of.vertex(k)));
        let heights = corners.map(|corners: [Vec3; 8]| corners.map(|corner| corner.dot(normal)));
        let highest = heights[0].into_iter().fold(f32::NEG_INFINITY, max);
        let lowest = heights[1].into_iter().fold(f32::INFINITY, min);
        Self { boxes: [a, b], corners, heights, tops: [highest, lowest], normal, most }
    }

    /// Pairs each corner with the other box's point closest to it.
    fn corner_bridges(&self) -> impl Iterator<Item = Bridge> {
        let ([a, b], [corners_a, corners_b]) = (self.boxes, &self.corners);
        let of_a = (0..8).filter(|&k| self.tops[1] - self.heights[0][k] <= self.most).map(|k| {
            let on_a = corners_a[k];
            Bridge { on_a, on_b: b.closest(on_a), feature: pair(feature::vertex(k), WHOLE) }
        });
        let of_b = (0..8).filter(|&k| self.heights[1][k] - self.tops[0] <= self.most).map(|k| {
            let on_b = corners_b[k];
            Bridge { on_a: a.closest(on_b), on_b, feature: pair(WHOLE, feature::vertex(k)) }
        });
        of_a.chain(of_b)
    }

    /// Returns the closest points of a pair of edges if they are closer than `found`, otherwise `found`.
    fn shortest_edge_bridge(&self, found: Option<Bridge>) -> Option<Bridge> {
        let most = found.map_or(self.most, |found| min(found.span().length() * (1.0 + BLUR), self.most));
        let most = most + self.most * BLUR;
        // Along the direction of the shortest bridge so far, only a few edges can be closer than that bridge.
        let toward = found.map_or(self.normal, |found| normalize_or(found.span(), self.normal));
        let reach = self.corners.map(|corners| corners.map(|corner| corner.dot(toward)));
        let mut best = found;
        for (i, ends) in EDGES.iter().enumerate() {
            let top = ends.map(|k| self.heights[0][k]);
            let top = max(top[0], top[1]);
            if self.tops[1] - top > most {
                continue;
            }
            let front = ends.map(|k| reach[0][k]);
            let front = max(front[0], front[1]);
            for (j, others) in EDGES.iter().enumerate() {
                let low = others.map(|k| self.heights[1][k]);
                let back = others.map(|k| reach[1][k]);
                if min(low[0], low[1]) - top > most || min(back[0], back[1]) - front > most {
                    continue;
                }
                let bridge = self.edge_bridge((i, *ends), (j, *others));
                best = Some(best.map_or(bridge, |best| best.shorter(bridge)));
            }
        }
        best
    }

    /// Returns the closest points of two edges, each given by its index and ends.
    fn edge_bridge(&self, (i, ends): (usize, [usize; 2]), (j, others): (usize, [usize; 2])) -> Bridge {
        let edge_a = Segment { ends: ends.map(|k| self.corners[0][k]) };
        let edge_b = Segment { ends: others.map(|k| self.corners[1][k]) };
        let (s, t) = edge_a.closest_to_segment(&edge_b);
        let name = |number: usize, from: usize| feature::edge(number / 4, from);
        Bridge { on_a: edge_a.at(s), on_b: edge_b.at(t), feature: pair(name(i, ends[0]), name(j, others[0])) }
    }
}

/// Corners at the ends of each edge of a box: four per axis.
const EDGES: [[usize; 2]; 12] =
    [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_math::{Random, Transform};

    fn some_box(random: &mut Random, near: f32) -> PlacedBox {
        let half = random.in_cube().abs() * 0.5 + Vec3::splat(0.02);
        let turn = if random.index(4) == 0 { Vec3::Y * random.unit() } else { random.in_cube() * 3.0 };
        PlacedBox::new(
            half,
            &Transform::new(random.in_cube() * near, sinew_math::Rotation::from_scaled_axis(turn)),
        )
    }

    #[test]
    fn skipping_edges_that_separate_less_than_enough_keeps_the_best_axis() {
        let mut random = Random::new(41);
        let (mut found, mut left_out) = (0, 0);
        for case in 0..20_000 {
            let (a, b) = (some_box(&mut random, 1.0), some_box(&mut random, 1.0));
            let crossed = Crossed::new(&a, &b);
            let enough = random.range(-0.5, 0.5);
            let of = |axis: &Axis| (axis.of, axis.separation, axis.normal);
            let all = crossed.best_edges(PARALLEL_SINE, f32::NEG_INFINITY);
            let some = crossed.best_edges(PARALLEL_SINE, enough);
            match all.filter(|best| best.separation > enough) {
                Some(best) => {
                    assert_eq!(some.as_ref().map(of), Some(of(&best)), "case {case}");
                    found += 1;
                }
                None => left_out += usize::from(some.is_none()),
            }
        }
        assert!(found > 3_000 && left_out > 3_000, "{found} best axes compared, {left_out} left out");
    }

    /// Reference implementation: the closest points by brute force over all corners and edges.
    fn brute_force(a: &PlacedBox, b: &PlacedBox, normal: Vec3, margin: f32) -> Manifold {
        let all = Closest::new(a, b, normal, f32::INFINITY);
        let corners: Vec<Bridge> = all.corner_bridges().collect();
        let edges = EDGES.iter().enumerate().flat_map(|(i, ends)| {
            let all = &all;
            EDGES.iter().enumerate().map(move |(j, others)| all.edge_bridge((i, *ends), (j, *others)))
        });
        let best = corners.iter().copied().chain(edges).reduce(Bridge::shorter).expect("boxes have corners");
        let (size, mut out) = ((a.half + b.half).length(), Manifold::default());
        push_bridges::<16>(best, corners.into_iter(), (size, normal), margin, 5e-4, &mut out);
        out
    }

    #[test]
    fn closest_points_match_all_corners_and_edges() {
        let mut random = Random::new(42);
        let (mut pairs, mut with_points) = (0, 0);
        for case in 0..40_000 {
            let (mut a, b) = (some_box(&mut random, 1.5), some_box(&mut random, 0.5));
            if random.index(8) == 0 {
                a.axes = b.axes;
            }
            let crossed = Crossed::new(&a, &b);
            let faces = [crossed.best_face_of_a(), crossed.best_face_of_b()];
            let axes = faces.into_iter().chain(crossed.best_edges(PARALLEL_SINE, f32::NEG_INFINITY));
            for axis in axes.filter(|axis| axis.separation > 0.0) {
                let margin = [0.02, 0.2, 1.0][random.index(3)];
                let mut out = Manifold::default();
                a.push_closest(&b, axis.normal, margin, 5e-4, &mut out);
                assert_eq!(out, brute_force(&a, &b, axis.normal, margin), "case {case}");
                pairs += 1;
                with_points += usize::from(out.count > 0);
            }
        }
        assert!(pairs > 20_000 && with_points > 5_000, "{pairs} pairs, {with_points} with contact points");
    }
}
