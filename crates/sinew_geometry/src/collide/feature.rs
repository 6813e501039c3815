//! Names of the corners, edges and faces of shapes, for the ids of contact points.

use crate::hull::Topology;
use crate::shape::Shape;
use sinew_math::Vec3;

/// A whole shape, or the only feature of its kind.
pub(crate) const WHOLE: u16 = 0;

/// Kinds, above the numbers.
const VERTEX: u16 = 0x4000;
const EDGE: u16 = 0x8000;
const FACE: u16 = 0xC000;

/// Corner of a polytope; of a box: bit k is set on the positive side of axis k.
pub(crate) fn vertex(index: usize) -> u16 {
    VERTEX | index as u16
}

/// Edge of a box along `axis`, through corner `index`.
pub(crate) fn edge(axis: usize, index: usize) -> u16 {
    let low = index & !(1 << axis);
    EDGE | (axis << 3 | low) as u16
}

/// Face of a box on the positive or negative side of `axis`.
pub(crate) fn face(axis: usize, sign: f32) -> u16 {
    FACE | (axis << 1 | usize::from(sign > 0.0)) as u16
}

/// Face of a polytope by its number.
pub(crate) fn face_number(index: usize) -> u16 {
    FACE | index as u16
}

/// Edge of a polytope, by either of its half-edges.
pub(crate) fn half_edge(topology: Topology<'_>, side: usize) -> u16 {
    EDGE | topology.edge_of(side) as u16
}

/// Direction of the edge that a feature names, in the frame of its shape, of any length. `None` if it names no edge, or
/// the shape is neither a box nor a hull.
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

/// Directions of the two edges that cross at a contact point, each in the frame of its shape and of any length. `None`
/// if the point is not one of edges of boxes or hulls.
pub fn edge_directions(shapes: [&Shape; 2], feature: u32) -> Option<[Vec3; 2]> {
    let [a, b] = [feature as u16, (feature >> 16) as u16];
    Some([direction(shapes[0], a)?, direction(shapes[1], b)?])
}

/// End of a capsule, 0 or 1.
pub(crate) fn end(index: usize) -> u16 {
    VERTEX | index as u16
}

/// Id of a contact point from the features of A and B.
pub(crate) fn pair(a: u16, b: u16) -> u32 {
    u32::from(a) | u32::from(b) << 16
}
