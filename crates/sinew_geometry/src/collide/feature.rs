//! Names of the corners, edges and faces of shapes, for the ids of contact points.

use crate::hull::Topology;

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

/// End of a capsule, 0 or 1.
pub(crate) fn end(index: usize) -> u16 {
    VERTEX | index as u16
}

/// Id of a contact point from the features of A and B.
pub(crate) fn pair(a: u16, b: u16) -> u32 {
    u32::from(a) | u32::from(b) << 16
}
