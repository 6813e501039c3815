//! Names of the corners, edges and faces of shapes, for the ids of contact points.

use crate::hull::Topology;
use crate::shape::Shape;
use sinew_math::Vec3;

/// Name of a whole shape, or of the only feature of its kind.
pub(crate) const WHOLE: u16 = 0;

/// The two high bits of a name give the kind of the feature; the other bits are the feature's index.
const VERTEX: u16 = 0x4000;
const EDGE: u16 = 0x8000;
const FACE: u16 = 0xC000;

/// Name of a corner of a polytope; for a box, bit k of the index is set on the positive side of axis k.
pub(crate) fn vertex(index: usize) -> u16 {
    VERTEX | index as u16
}

/// Name of the edge of a box along `axis`, through corner `index`.
pub(crate) fn edge(axis: usize, index: usize) -> u16 {
    let low = index & !(1 << axis);
    EDGE | (axis << 3 | low) as u16
}

/// Name of the face of a box on the positive or negative side of `axis`.
pub(crate) fn face(axis: usize, sign: f32) -> u16 {
    FACE | (axis << 1 | usize::from(sign > 0.0)) as u16
}

/// Name of a face of a polytope, by its index.
pub(crate) fn face_number(index: usize) -> u16 {
    FACE | index as u16
}

/// Name of an edge of a polytope, by the index of either of its half-edges.
pub(crate) fn half_edge(topology: Topology<'_>, side: usize) -> u16 {
    EDGE | topology.edge_of(side) as u16
}

/// Returns the direction of the edge with a name, in the frame of its shape and not normalized. `None` if the name is
/// not that of an edge, or the shape is neither a box nor a hull.
fn direction(shape: &Shape, feature: u16) -> Option<Vec3> {
    let number = usize::from(feature & !FACE);
    match shape {
        _ if feature & FACE != EDGE => None,
        Shape::Box { .. } => Some(Vec3::AXES[number >> 3]),
        Shape::Hull(hull) => {
            let [from, to] = hull.topology().ends(number).map(|corner| hull.vertices()[corner]);
            Some(to - from)
        }
        _ => None,
    }
}

/// Returns the directions of the two edges that cross at a contact point, each in the frame of its shape and not
/// normalized. `feature` is the [`ManifoldPoint::feature`](super::ManifoldPoint::feature). `None` if the point is not a
/// crossing of two edges of boxes or hulls.
pub fn edge_directions(shapes: [&Shape; 2], feature: u32) -> Option<[Vec3; 2]> {
    let [a, b] = [feature as u16, (feature >> 16) as u16];
    Some([direction(shapes[0], a)?, direction(shapes[1], b)?])
}

/// Name of an end of a capsule, 0 or 1.
pub(crate) fn end(index: usize) -> u16 {
    VERTEX | index as u16
}

/// Id of a contact point from the features of A and B.
pub(crate) fn pair(a: u16, b: u16) -> u32 {
    u32::from(a) | u32::from(b) << 16
}
