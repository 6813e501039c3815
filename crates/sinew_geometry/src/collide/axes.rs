//! Code shared by boxes and polytopes: the choice of the separating axis, and the contact points for it.

use super::clip::{Incident, Reference, clip};
use super::feature::{self, pair};
use super::manifold::{Manifold, ManifoldPoint};
use super::placed::Segment;
use super::reduce::{midway, push_best};
use crate::boxes::separation::{Axis, AxisOf};
use sinew_math::{Vec3, min};

/// Sine below which edges count as parallel; then the face axes suffice.
pub(super) const PARALLEL_SINE: f32 = 0.005;

/// Direction that breaks ties between the faces of A and B, so that neither the order of the shapes nor rounding
/// decides between them. It is perpendicular to none of the directions that are common in levels (axes and diagonals).
pub(super) const TIE_DIRECTION: Vec3 = Vec3::new(0.331, 0.873, 0.357);

/// Length differences that the choice of features ignores, metres: up to 1 % of the thinner shape's half width, at most
/// 0.5 mm.
pub(super) fn tolerance(half_width_a: f32, half_width_b: f32) -> f32 {
    min(0.0005, 0.01 * min(half_width_a, half_width_b))
}

/// Returns the better of two faces. Two touching faces are equally good, and the choice between them must be stable.
/// `tie` is [`TIE_DIRECTION`] in the current frame.
pub(super) fn choose_face(a: Axis, b: Axis, tolerance: f32, tie: Vec3) -> Axis {
    let tied = (a.separation - b.separation).abs() <= tolerance && a.normal.dot(b.normal) > 0.9;
    let a_wins = if tied { (a.normal + b.normal).dot(tie) > 0.0 } else { a.separation > b.separation };
    if a_wins { a } else { b }
}

/// Returns the axis of the edges if its gap is clearly larger than that of the face, otherwise the face: a face gives
/// up to four points and is more stable.
pub(super) fn choose(face: Axis, edges: Option<Axis>, tolerance: f32) -> Axis {
    let least = least_of_edges(&face, tolerance);
    edges.filter(|edges| edges.separation > least).unwrap_or(face)
}

/// Gap above which edges are preferred over a face, metres.
pub(super) fn least_of_edges(face: &Axis, tolerance: f32) -> f32 {
    face.separation + tolerance + 0.05 * face.separation.abs()
}

/// A solid with flat faces.
pub(super) trait Faceted {
    /// Returns the index and position of the corner furthest along a direction.
    fn corner(&self, direction: Vec3) -> (usize, Vec3);

    /// Returns the edge with the number of an [`AxisOf`], and its feature name. If several edges have the number (four
    /// parallel edges of a box), the edge furthest along `direction` is returned.
    fn edge_named(&self, number: usize, direction: Vec3) -> (Segment, u16);

    /// Pushes the face of `other` that is opposite to this solid's face `face`, clipped to that face: see
    /// [`push_faces`].
    fn push_faces(
        &self,
        face: usize,
        other: &Self,
        best: &Axis,
        margin: f32,
        tolerance: f32,
        out: &mut Manifold,
    ) -> bool;

    /// Pushes the closest points of this solid and `other`, which `normal` separates. The search tests all corners and
    /// edges. It is slow but reliable, for the rare pairs whose closest features are corners or edges.
    fn push_closest(&self, other: &Self, normal: Vec3, margin: f32, tolerance: f32, out: &mut Manifold);
}

/// Pushes the points of a contact along the chosen axis.
pub(super) fn push<S: Faceted>(a: &S, b: &S, axis: &Axis, margin: f32, tolerance: f32, out: &mut Manifold) {
    let touched = match axis.of {
        AxisOf::FaceA(k) => a.push_faces(k, b, axis, margin, tolerance, out),
        AxisOf::FaceB(k) => b.push_faces(k, a, axis, margin, tolerance, out),
        AxisOf::Edges(i, j) => {
            push_edges(a.edge_named(i, axis.normal), b.edge_named(j, -axis.normal), axis, out)
        }
    };
    if !touched {
        if axis.separation > 0.0 {
            a.push_closest(b, axis.normal, margin, tolerance, out);
        } else {
            push_support(a, b, axis, out);
        }
    }
}

/// Pushes the closest points of two edges. Returns false and pushes nothing if the solids are apart and their closest
/// points are elsewhere.
fn push_edges(
    (edge_a, feature_a): (Segment, u16),
    (edge_b, feature_b): (Segment, u16),
    axis: &Axis,
    out: &mut Manifold,
) -> bool {
    let (s, t) = edge_a.closest_to_segment(&edge_b);
    let inside = |x: f32| x > 0.0 && x < 1.0;
    if axis.separation > 0.0 && !(inside(s) && inside(t)) {
        return false;
    }
    out.normal = axis.normal;
    out.push((edge_a.at(s) + edge_b.at(t)) * 0.5, axis.separation, pair(feature_a, feature_b));
    true
}

/// Pushes B's deepest corner, for overlaps where neither the faces nor the edges gave a point.
fn push_support<S: Faceted>(a: &S, b: &S, axis: &Axis, out: &mut Manifold) {
    let ((of_a, _), (of_b, corner)) = (a.corner(axis.normal), b.corner(-axis.normal));
    out.normal = axis.normal;
    let position = midway(corner, axis.normal, axis.separation);
    out.push(position, axis.separation, pair(feature::vertex(of_a), feature::vertex(of_b)));
}

/// Pushes the other shape's face, clipped to the reference face. Returns false and pushes nothing if the shapes are
/// separated and the other face is beside the reference face, so that the points would not give their distance.
pub(super) fn push_faces<const N: usize>(
    reference: &impl Reference,
    (incident, corners): (u16, impl Iterator<Item = Incident>),
    best: &Axis,
    margin: f32,
    tolerance: f32,
    out: &mut Manifold,
) -> bool {
    let outward = reference.normal();
    let mut points = [ManifoldPoint::default(); N];
    let (mut count, mut nearest) = (0, f32::INFINITY);
    for corner in clip::<N>(reference, incident, corners, tolerance).corners() {
        let separation = corner.local.z;
        nearest = min(separation, nearest);
        if separation <= margin {
            let feature = match best.of {
                AxisOf::FaceB(_) => pair(corner.incident, corner.reference),
                AxisOf::FaceA(_) | AxisOf::Edges(..) => pair(corner.reference, corner.incident),
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

/// A pair of points on A and B.
#[derive(Clone, Copy, Default)]
pub(super) struct Bridge {
    pub on_a: Vec3,
    pub on_b: Vec3,
    pub feature: u32,
}

impl Bridge {
    pub fn span(&self) -> Vec3 {
        self.on_b - self.on_a
    }

    /// Returns the shorter bridge; the first among equals.
    pub fn shorter(self, other: Self) -> Self {
        if other.span().length() < self.span().length() { other } else { self }
    }
}

/// Pushes the contact of separated shapes. `best` is the shortest bridge between them. `corners` are all bridges from
/// corners: those about as short as `best` are pushed too, because parallel edges are equally close along a line whose
/// ends are corners. `size` is the size of the shapes; `fallback` is the normal if the gap is too small to define one.
pub(super) fn push_bridges<const N: usize>(
    best: Bridge,
    corners: impl Iterator<Item = Bridge>,
    (size, fallback): (f32, Vec3),
    margin: f32,
    tolerance: f32,
    out: &mut Manifold,
) {
    let separation = best.span().length();
    if separation > margin {
        return;
    }
    // The direction between nearly coincident points is noise.
    let precise = separation > 2e-5 * size;
    out.normal = if precise { best.span() / separation } else { fallback };
    let mut points = [ManifoldPoint::default(); N];
    let mut count = 0;
    for bridge in corners {
        let (length, along) = (bridge.span().length(), bridge.span().dot(out.normal));
        let position = (bridge.on_a + bridge.on_b) * 0.5;
        let known = points[..count].iter().any(|p| (p.position - position).length() <= 2.0 * tolerance);
        if length <= separation + tolerance && along >= 0.99 * length && !known && count < N {
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
