//! Box against box: separating axes (Gottschalk, Lin & Manocha 1996), then the two faces or the two edges that meet.

use super::axes::{
    Bridge, Faceted, PARALLEL_SINE, TIE_DIRECTION, choose, choose_face, push, push_bridges, push_faces,
    tolerance,
};
use super::clip::{BOX_CORNERS, BoxFace, Reference};
use super::feature::{self, WHOLE, pair};
use super::placed::{PlacedBox, Segment, sign};
use super::{Manifold, Parting};
use crate::boxes::separation::{Axis, AxisOf, axis, best_edges, best_face};
use sinew_math::Vec3;

pub(super) fn collide(a: &PlacedBox, b: &PlacedBox, margin: f32, parting: &mut Parting, out: &mut Manifold) {
    let parts = |axis: &Axis| axis.separation > margin;
    if let Some(axis) = parting.axis.and_then(|of| axis(a, b, of, PARALLEL_SINE)).filter(parts) {
        parting.gap = axis.separation;
        return;
    }
    parting.axis = None;
    let (face_a, face_b) = (best_face(a, b, 1.0, AxisOf::FaceA), best_face(b, a, -1.0, AxisOf::FaceB));
    if let Some(axis) = [face_a, face_b].iter().find(|axis| parts(axis)) {
        *parting = Parting::along(axis);
        return;
    }
    let edges = best_edges(a, b, PARALLEL_SINE);
    if let Some(axis) = edges.filter(parts) {
        *parting = Parting::along(&axis);
        return;
    }
    let tolerance = tolerance(a.thinnest(), b.thinnest());
    let face = choose_face(face_a, face_b, tolerance, TIE_DIRECTION);
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
        let reference = BoxFace { of: self, axis, sign: sign(self.axes[axis].dot(outward)) };
        let (axis, sign) = other.facing(-outward);
        let incident = BoxFace { of: other, axis, sign };
        let face = (incident.feature(), incident.corners());
        push_faces::<BOX_CORNERS>(&reference, face, best, margin, tolerance, out)
    }

    fn push_closest(&self, b: &Self, normal: Vec3, margin: f32, tolerance: f32, out: &mut Manifold) {
        let corners = corner_bridges(self, b);
        let best = corners.into_iter().chain(edge_bridges(self, b)).reduce(Bridge::shorter);
        let size = (self.half + b.half).length();
        let best = best.unwrap_or_default();
        push_bridges::<16>(best, corners.into_iter(), (size, normal), margin, tolerance, out);
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
