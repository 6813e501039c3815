//! Triangle meshes as shapes.

use super::Triangle;
use super::build::{self, Dropped, Sheet};
use super::bvh::Tree;
use crate::boxes::Aabb;
use core::fmt;
use sinew_math::{StableHasher, Vec3};

/// Largest number of triangles of a mesh.
pub const MAX_TRIANGLES: usize = 1 << 28;
/// Largest coordinate of a vertex, metres.
pub const MAX_COORDINATE: f32 = 1e6;

/// Error returned when triangles do not form a valid mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshError {
    /// There is no triangle, or none has an area.
    NoTriangles {
        /// Number of triangles without area.
        degenerate: usize,
    },
    /// A triangle refers to a missing vertex.
    IndexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// Index of the missing vertex.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A vertex has coordinates that are not finite, or beyond [`MAX_COORDINATE`].
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
    },
    /// More triangles than [`MAX_TRIANGLES`], or more vertices than three times [`MAX_TRIANGLES`].
    TooMany {
        /// Number of given triangles.
        triangles: usize,
    },
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoTriangles { degenerate: 0 } => f.write_str("there are no triangles"),
            Self::NoTriangles { .. } => f.write_str("no triangle has an area"),
            Self::IndexOutOfRange { triangle, index, vertices } => {
                write!(f, "triangle {triangle} names vertex {index}: there are {vertices}")
            }
            Self::NotFinite { vertex } => write!(f, "vertex {vertex} is not finite or beyond 10⁶ m"),
            Self::TooMany { triangles } => write!(f, "{triangles} triangles are more than {MAX_TRIANGLES}"),
        }
    }
}

impl core::error::Error for MeshError {}

/// Surface of triangles for levels; each triangle is solid on the side from which its corners are counter-clockwise.
/// The surface may be open and need not enclose a volume.
///
/// Internal edges are inactive: only the surface's rim and edges at which it bends down by more than 5° cause contacts.
#[derive(Clone, Debug)]
pub struct Mesh {
    vertices: Vec<Vec3>,
    /// Faces in the order of the tree's leaves.
    faces: Vec<Face>,
    tree: Tree,
    dropped: Dropped,
    hash: u64,
}

/// A triangle as the mesh stores it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub vertices: [u32; 3],
    /// Index in the user's list in the low 28 bits, active edges in the three bits above.
    tag: u32,
}

impl Face {
    fn number(self) -> u32 {
        self.tag & (MAX_TRIANGLES as u32 - 1)
    }

    fn active(self) -> u8 {
        (self.tag >> 28) as u8
    }
}

impl Mesh {
    /// Creates a mesh from vertices (metres) and the indices of each triangle's corners, counter-clockwise seen from
    /// outside.
    ///
    /// Vertices at the same position are merged. Triangles without area and duplicates are dropped:
    /// [`dropped`](Self::dropped) counts them.
    ///
    /// # Errors
    /// If coordinates are not finite, indices are out of range, or no triangle has an area.
    pub fn new(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        Ok(Self::of_sheet(build::sheet(vertices, triangles)?))
    }

    pub(super) fn of_sheet(sheet: Sheet) -> Self {
        let Sheet { vertices, triangles, active, numbers, dropped } = sheet;
        let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
        let tree = Tree::new(&mut order, &|i| triangles[i as usize].map(|v| vertices[v as usize]));
        let face = |&i: &u32| Face {
            vertices: triangles[i as usize],
            tag: numbers[i as usize] | u32::from(active[i as usize]) << 28,
        };
        let faces: Vec<Face> = order.iter().map(face).collect();
        let hash = hash(&vertices, &triangles, &numbers);
        Self { vertices, faces, tree, dropped, hash }
    }

    /// Returns the unique vertices, metres.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// Iterates over the kept triangles, as indices into [`vertices`](Self::vertices), in the mesh's own order.
    pub fn triangles(&self) -> impl ExactSizeIterator<Item = [u32; 3]> {
        self.faces.iter().map(|face| face.vertices)
    }

    /// Iterates over the corners of each triangle, metres.
    pub fn corners_of_all(&self) -> impl ExactSizeIterator<Item = [Vec3; 3]> {
        self.faces.iter().map(|face| face.vertices.map(|v| self.vertices[v as usize]))
    }

    /// Iterates over the triangles with their indices in the user's list.
    pub(super) fn numbered(&self) -> impl Iterator<Item = (u32, [u32; 3])> {
        self.faces.iter().map(|face| (face.number(), face.vertices))
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.faces.len()
    }

    /// Returns how many triangles were dropped, by reason.
    pub fn dropped(&self) -> Dropped {
        self.dropped
    }

    /// Bounds of all triangles, in the mesh's frame.
    pub fn bounds(&self) -> Aabb {
        self.tree.bounds()
    }

    /// Hash of the content: equal for equal vertices and triangles on every machine.
    pub fn content_hash(&self) -> u64 {
        self.hash
    }

    /// Memory use, bytes.
    pub fn memory(&self) -> usize {
        size_of::<Self>()
            + size_of_val(self.vertices.as_slice())
            + size_of_val(self.faces.as_slice())
            + self.tree.bytes()
    }

    pub(super) fn tree(&self) -> &Tree {
        &self.tree
    }

    /// Returns the triangle at a position in leaf order.
    pub(super) fn triangle(&self, place: u32) -> Triangle {
        let face = self.faces[place as usize];
        Triangle::new(self.corners(place), face.vertices, face.active())
    }

    pub(super) fn corners(&self, place: u32) -> [Vec3; 3] {
        self.faces[place as usize].vertices.map(|v| self.vertices[v as usize])
    }
}

impl PartialEq for Mesh {
    fn eq(&self, other: &Self) -> bool {
        self.hash == other.hash
            && self.vertices == other.vertices
            && self.faces.iter().map(|face| face.vertices).eq(other.faces.iter().map(|face| face.vertices))
    }
}

fn hash(vertices: &[Vec3], triangles: &[[u32; 3]], numbers: &[u32]) -> u64 {
    let mut hasher = StableHasher::default();
    hasher.write(&(vertices.len() as u64).to_le_bytes());
    for x in vertices.iter().flat_map(Vec3::to_array) {
        hasher.write(&x.to_bits().to_le_bytes());
    }
    for index in triangles.iter().flatten().chain(numbers) {
        hasher.write(&index.to_le_bytes());
    }
    hasher.finish()
}
