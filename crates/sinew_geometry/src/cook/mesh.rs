//! Prepares a triangle mesh for cooking: checks it, welds its vertices, and finds its connected parts.

use crate::boxes::Aabb;
use core::fmt;
use sinew_math::{Vec3, max3, min3};
use std::collections::HashMap;

/// Distance, as a share of the mesh's diagonal, below which vertices are welded.
const WELD: f32 = 1e-5;
/// Largest number of triangles of a mesh.
pub const MAX_TRIANGLES: usize = 16 << 20;

/// Reason why a mesh cannot be cooked. Indices refer to the given slices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CookError {
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
    /// A triangle refers to a vertex whose coordinates are not finite, or beyond 10⁶ m.
    NotFinite {
        /// Index of the triangle.
        triangle: usize,
        /// Index of the vertex.
        vertex: u32,
    },
    /// More triangles than [`MAX_TRIANGLES`].
    TooMany {
        /// Number of given triangles.
        triangles: usize,
    },
}

impl fmt::Display for CookError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoTriangles { degenerate: 0 } => write!(f, "there are no triangles"),
            Self::NoTriangles { degenerate } => write!(f, "none of the {degenerate} triangles has an area"),
            Self::IndexOutOfRange { index, vertices, .. } => {
                write!(f, "index {index} is out of range: there are {vertices} vertices")
            }
            Self::NotFinite { .. } => write!(f, "a coordinate is not finite or beyond 10⁶ m"),
            Self::TooMany { triangles } => write!(f, "{triangles} triangles are more than {MAX_TRIANGLES}"),
        }
    }
}

impl core::error::Error for CookError {}

impl CookError {
    /// Location in the mesh, such as `triangle 7, vertex 12`; empty for the mesh as a whole.
    pub fn place(&self) -> String {
        match *self {
            Self::NoTriangles { .. } | Self::TooMany { .. } => String::new(),
            Self::IndexOutOfRange { triangle, .. } => format!("triangle {triangle}"),
            Self::NotFinite { triangle, vertex } => format!("triangle {triangle}, vertex {vertex}"),
        }
    }
}

/// Numbers of repaired faults of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repairs {
    /// Triangles without area, which are dropped.
    pub degenerate: usize,
    /// Duplicate triangles, which are dropped.
    pub repeated: usize,
    /// Edges that belong to one triangle only: the rims of holes and of sheets.
    pub open_edges: usize,
}

/// A mesh without degenerate triangles, with coinciding vertices welded.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceMesh {
    pub positions: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    /// Connected part of each triangle; two parts share no vertex.
    pub part: Vec<u32>,
    pub parts: usize,
    pub bounds: Aabb,
    pub repairs: Repairs,
}

impl SurfaceMesh {
    pub fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<Self, CookError> {
        let bounds = check(positions, triangles)?;
        let diagonal = (bounds.max - bounds.min).length();
        let (positions, welded) = weld(positions, triangles, diagonal * WELD);
        let mut repairs = Repairs::default();
        let mut kept = Vec::with_capacity(triangles.len());
        for triangle in triangles {
            let triangle = triangle.map(|i| welded[i as usize]);
            let [a, b, c] = triangle.map(|i| positions[i as usize]);
            // Uses the height over the longest side, so that slivers as narrow as the weld distance are dropped too.
            let doubled_area = (b - a).cross(c - a).length();
            let longest = (b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared();
            if doubled_area > 0.5 * WELD * diagonal * longest.sqrt() {
                kept.push(triangle);
            } else {
                repairs.degenerate += 1;
            }
        }
        repairs.repeated = remove_repeated(&mut kept);
        if kept.is_empty() {
            return Err(CookError::NoTriangles { degenerate: repairs.degenerate });
        }
        repairs.open_edges = open_edges(&kept);
        let (part, parts) = connected_parts(positions.len(), &kept);
        Ok(Self { positions, triangles: kept, part, parts, bounds, repairs })
    }

    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.positions[i as usize])
    }

    /// Returns twice the area times the unit normal.
    pub fn doubled_area(&self, triangle: usize) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }

    /// Diagonal of the mesh's bounds, metres.
    pub fn diagonal(&self) -> f32 {
        (self.bounds.max - self.bounds.min).length()
    }

    pub fn is_closed(&self) -> bool {
        self.repairs.open_edges == 0
    }

    /// Returns the triangle indices of each part.
    pub fn triangles_by_part(&self) -> Vec<Vec<u32>> {
        let mut by_part = vec![Vec::new(); self.parts];
        for (triangle, &part) in self.part.iter().enumerate() {
            by_part[part as usize].push(triangle as u32);
        }
        by_part
    }
}

/// Checks the mesh and returns the bounds of its used vertices.
fn check(positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<Aabb, CookError> {
    const FARTHEST: f32 = 1e6;
    if triangles.len() > MAX_TRIANGLES {
        return Err(CookError::TooMany { triangles: triangles.len() });
    }
    let mut bounds: Option<Aabb> = None;
    for (triangle, corners) in triangles.iter().enumerate() {
        for &index in corners {
            let Some(&p) = positions.get(index as usize) else {
                return Err(CookError::IndexOutOfRange { triangle, index, vertices: positions.len() });
            };
            // The comparison is false for NaN, so NaN is rejected.
            if !(p.x.abs() <= FARTHEST && p.y.abs() <= FARTHEST && p.z.abs() <= FARTHEST) {
                return Err(CookError::NotFinite { triangle, vertex: index });
            }
            let all = bounds.get_or_insert(Aabb { min: p, max: p });
            *all = Aabb { min: min3(all.min, p), max: max3(all.max, p) };
        }
    }
    bounds.ok_or(CookError::NoTriangles { degenerate: 0 })
}

/// Returns the used vertices, each once within `tolerance`, and the new index of each old vertex.
fn weld(positions: &[Vec3], triangles: &[[u32; 3]], tolerance: f32) -> (Vec<Vec3>, Vec<u32>) {
    const UNSEEN: u32 = u32::MAX;
    let cell = if tolerance > 0.0 { 8.0 * tolerance } else { 1.0 };
    let key = |p: Vec3| [p.x, p.y, p.z].map(|x| (x / cell).floor() as i64);
    // Used for lookup only, never iterated, so its order has no effect.
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let mut kept: Vec<Vec3> = Vec::new();
    let mut welded = vec![UNSEEN; positions.len()];
    for &index in triangles.iter().flatten() {
        if welded[index as usize] != UNSEEN {
            continue;
        }
        let p = positions[index as usize];
        let (low, high) = (key(p - Vec3::splat(tolerance)), key(p + Vec3::splat(tolerance)));
        let mut found = UNSEEN;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    for &other in cells.get(&[x, y, z]).into_iter().flatten() {
                        if (kept[other as usize] - p).length() <= tolerance {
                            found = u32::min(found, other);
                        }
                    }
                }
            }
        }
        if found == UNSEEN {
            found = kept.len() as u32;
            kept.push(p);
            cells.entry(key(p)).or_default().push(found);
        }
        welded[index as usize] = found;
    }
    (kept, welded)
}

/// Removes triangles with the corners and orientation of an earlier triangle; returns their number.
fn remove_repeated(triangles: &mut Vec<[u32; 3]>) -> usize {
    let before = triangles.len();
    for triangle in triangles.iter_mut() {
        let first = (0..3).min_by_key(|&k| triangle[k]).unwrap_or(0);
        triangle.rotate_left(first);
    }
    triangles.sort_unstable();
    triangles.dedup();
    before - triangles.len()
}

/// Counts the directed edges that have no edge in the opposite direction.
fn open_edges(triangles: &[[u32; 3]]) -> usize {
    let mut edges: Vec<(u32, u32, bool)> = Vec::with_capacity(3 * triangles.len());
    for &[a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            edges.push((u32::min(from, to), u32::max(from, to), from < to));
        }
    }
    edges.sort_unstable();
    let surplus = |run: &[(u32, u32, bool)]| {
        let forward = run.iter().filter(|edge| edge.2).count();
        forward.abs_diff(run.len() - forward)
    };
    edges.chunk_by(|p, q| (p.0, p.1) == (q.0, q.1)).map(surplus).sum()
}

/// Returns the part of each triangle, numbered in the order of triangles, and the number of parts.
fn connected_parts(vertices: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, usize) {
    let mut parent: Vec<u32> = (0..vertices as u32).collect();
    for &[a, b, c] in triangles {
        let root = find(&mut parent, a);
        for other in [b, c] {
            let other = find(&mut parent, other);
            parent[other as usize] = root;
        }
    }
    let mut number = vec![u32::MAX; vertices];
    let mut parts = 0;
    let mut of_triangle = |triangle: &[u32; 3]| {
        let root = find(&mut parent, triangle[0]) as usize;
        if number[root] == u32::MAX {
            number[root] = parts;
            parts += 1;
        }
        number[root]
    };
    let part = triangles.iter().map(&mut of_triangle).collect();
    (part, parts as usize)
}

/// Returns the representative of a set, halving the path to it.
fn find(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}
