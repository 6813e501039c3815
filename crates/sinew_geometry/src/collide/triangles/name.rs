//! Names of a surface's features, for the ids of contact points.

use crate::triangles::{Part, Triangle};

/// Common name of all faces, so that the contact of a corner that slides from triangle to triangle persists.
pub(super) const FACE: u16 = 0x300;
/// Common name of all features that other shapes hide. No edge or corner can have this name.
pub(super) const HIDDEN: u16 = 0x3ff;
const EDGE: u16 = 0x200;
const VERTEX: u16 = 0x100;

fn name(kind: u16, number: u32) -> u16 {
    kind | (number & 0xff) as u16 | ((number >> 8 & 0x3f) as u16) << 10
}

pub(super) fn edge(triangle: &Triangle, edge: usize) -> u16 {
    let (low, high) = triangle.edge_vertices(edge);
    name(EDGE, low.wrapping_mul(31).wrapping_add(high))
}

pub(super) fn vertex(triangle: &Triangle, corner: usize) -> u16 {
    name(VERTEX, triangle.vertices[corner])
}

/// Name of the corner where two edges meet.
pub(super) fn corner(triangle: &Triangle, edge_a: usize, edge_b: usize) -> u16 {
    // Edge k begins at corner k and ends at the next one.
    vertex(triangle, if (edge_a + 1) % 3 == edge_b { edge_b } else { edge_a })
}

pub(super) fn part(triangle: &Triangle, part: Part) -> u16 {
    match part {
        Part::Face => FACE,
        Part::Edge(k) => edge(triangle, k),
        Part::Corner(k) => vertex(triangle, k),
    }
}

/// True if a feature is a face of a surface.
pub(super) fn is_face(feature: u16) -> bool {
    feature == FACE
}
