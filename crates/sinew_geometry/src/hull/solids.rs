//! Boxes and triangles as polytopes with fixed topologies.

use super::polytope::Polytope;
use super::topology::{HalfEdge, Loop, Plane, Topology};
use crate::boxes::PlacedBox;
use sinew_math::Vec3;

/// Corners of the faces −x +x −y +y −z +z; bit k of a corner's index is set on the positive side of axis k.
const BOX_LOOPS: [[u8; 4]; 6] =
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
static BOX: Table<6, 24> = table(BOX_LOOPS);

/// Corners of the front and the back face.
#[cfg(test)]
const TRIANGLE_LOOPS: [[u8; 3]; 2] = [[0, 1, 2], [0, 2, 1]];
#[cfg(test)]
static TRIANGLE: Table<2, 6> = table(TRIANGLE_LOOPS);

/// A topology of `F` faces and `H` half-edges.
struct Table<const F: usize, const H: usize> {
    faces: [Loop; F],
    half_edges: [HalfEdge; H],
}

impl<const F: usize, const H: usize> Table<F, H> {
    fn topology(&self) -> Topology<'_> {
        Topology { faces: &self.faces, half_edges: &self.half_edges }
    }
}

/// Builds a table from the corners of each face, counter-clockwise from outside.
const fn table<const F: usize, const K: usize, const H: usize>(loops: [[u8; K]; F]) -> Table<F, H> {
    let mut faces = [Loop { first: 0, count: K as u16 }; F];
    let mut half_edges = [HalfEdge { origin: 0, face: 0, twin: 0 }; H];
    let mut side = 0;
    while side < H {
        let (face, k) = (side / K, side % K);
        faces[face].first = (face * K) as u16;
        let (from, to) = (loops[face][k], loops[face][(k + 1) % K]);
        half_edges[side] = HalfEdge { origin: from, face: face as u8, twin: 0 };
        let mut other = 0;
        while other < H {
            let (there, m) = (other / K, other % K);
            if loops[there][m] == to && loops[there][(m + 1) % K] == from {
                half_edges[side].twin = other as u16;
            }
            other += 1;
        }
        side += 1;
    }
    Table { faces, half_edges }
}

/// Corners and planes of a box.
pub(crate) struct BoxPolytope {
    center: Vec3,
    vertices: [Vec3; 8],
    planes: [Plane; 6],
    thickness: f32,
}

impl BoxPolytope {
    pub fn new(of: &PlacedBox) -> Self {
        let plane = |face: usize| {
            let axis = of.axes[face / 2];
            let normal = if face % 2 == 1 { axis } else { -axis };
            Plane { normal, offset: normal.dot(of.center) + of.half[face / 2] }
        };
        Self {
            center: of.center,
            vertices: core::array::from_fn(|index| of.vertex(index)),
            planes: core::array::from_fn(plane),
            thickness: of.thinnest(),
        }
    }

    pub fn polytope(&self) -> Polytope<'_> {
        Polytope {
            center: self.center,
            vertices: &self.vertices,
            planes: &self.planes,
            topology: BOX.topology(),
            thickness: self.thickness,
        }
    }
}

/// Corners of a triangle and its two planes.
#[cfg(test)]
pub(crate) struct TrianglePolytope {
    vertices: [Vec3; 3],
    planes: [Plane; 2],
}

#[cfg(test)]
impl TrianglePolytope {
    /// Creates the polytope of a triangle. `normal` is the unit normal of the side from which the corners are
    /// counter-clockwise.
    pub fn new(vertices: [Vec3; 3], normal: Vec3) -> Self {
        let offset = normal.dot((vertices[0] + vertices[1] + vertices[2]) / 3.0);
        Self { vertices, planes: [Plane { normal, offset }, Plane { normal: -normal, offset: -offset }] }
    }

    pub fn polytope(&self) -> Polytope<'_> {
        Polytope {
            center: (self.vertices[0] + self.vertices[1] + self.vertices[2]) / 3.0,
            vertices: &self.vertices,
            planes: &self.planes,
            topology: TRIANGLE.topology(),
            thickness: f32::INFINITY,
        }
    }
}
