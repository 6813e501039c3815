//! Prepares triangles for collision: checks and welds them, and finds their active edges.

use super::mesh::{MAX_COORDINATE, MAX_TRIANGLES, MeshError};
use super::triangle;
use sinew_math::Vec3;

/// Cosine of the angle (5°) by which a surface bends down at an active edge.
const FELT_COSINE: f32 = 0.996_194_7;
/// Height, relative to the longest side, below which a triangle has no area.
const THINNEST: f32 = 1e-6;

/// Numbers of triangles that were dropped from a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// Triangles without area.
    pub degenerate: usize,
    /// Duplicate triangles.
    pub repeated: usize,
}

/// Triangles that are kept, and their edges.
#[derive(Debug)]
pub(super) struct Sheet {
    pub vertices: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    /// Active edges of each triangle: bit k for the edge from corner k to the next.
    pub active: Vec<u8>,
    /// Indices of the triangles in the original list.
    pub numbers: Vec<u32>,
    pub dropped: Dropped,
}

pub(super) fn sheet(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<Sheet, MeshError> {
    check(vertices, triangles)?;
    let (vertices, welded) = weld(vertices);
    let mut dropped = Dropped::default();
    let mut kept = Vec::with_capacity(triangles.len());
    for (number, indices) in triangles.iter().enumerate() {
        let indices = indices.map(|i| welded[i as usize]);
        if has_area(indices.map(|i| vertices[i as usize])) {
            kept.push((indices, number as u32));
        } else {
            dropped.degenerate += 1;
        }
    }
    dropped.repeated = drop_repeated(&mut kept);
    if kept.is_empty() {
        return Err(MeshError::NoTriangles { degenerate: dropped.degenerate });
    }
    let (triangles, numbers): (Vec<_>, Vec<_>) = kept.into_iter().unzip();
    let active = active_edges(&vertices, &triangles);
    Ok(Sheet { vertices, triangles, active, numbers, dropped })
}

fn check(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    if triangles.len() >= MAX_TRIANGLES || vertices.len() > 3 * MAX_TRIANGLES {
        return Err(MeshError::TooMany { triangles: triangles.len() });
    }
    // The comparison is false for NaN, so NaN is rejected.
    let sane = |v: &Vec3| v.to_array().iter().all(|x| x.abs() <= MAX_COORDINATE);
    if let Some(vertex) = vertices.iter().position(|v| !sane(v)) {
        return Err(MeshError::NotFinite { vertex });
    }
    for (triangle, indices) in triangles.iter().enumerate() {
        if let Some(&index) = indices.iter().find(|&&index| index as usize >= vertices.len()) {
            return Err(MeshError::IndexOutOfRange { triangle, index, vertices: vertices.len() });
        }
    }
    Ok(())
}

/// Returns the unique positions in order of first use, and the new index of each vertex.
fn weld(vertices: &[Vec3]) -> (Vec<Vec3>, Vec<u32>) {
    // Adding 0 turns −0 into 0.
    let key = |i: u32| (vertices[i as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut order: Vec<u32> = (0..vertices.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (key(i), i));
    let mut first = vec![0; vertices.len()];
    for pair in order.chunk_by(|&i, &j| key(i) == key(j)) {
        for &i in pair {
            first[i as usize] = pair[0];
        }
    }
    let mut kept = Vec::new();
    let mut welded = vec![0; vertices.len()];
    for i in 0..vertices.len() {
        if first[i] as usize == i {
            welded[i] = kept.len() as u32;
            kept.push(vertices[i] + Vec3::ZERO);
        } else {
            welded[i] = welded[first[i] as usize];
        }
    }
    (kept, welded)
}

fn has_area([a, b, c]: [Vec3; 3]) -> bool {
    let longest = [b - a, c - b, a - c].into_iter().fold(0.0, |l, side| sinew_math::max(side.length(), l));
    (b - a).cross(c - a).length() > THINNEST * longest * longest
}

/// Removes triangles with the corners and orientation of an earlier triangle; returns their number.
fn drop_repeated(kept: &mut Vec<([u32; 3], u32)>) -> usize {
    let before = kept.len();
    let turned = |[a, b, c]: [u32; 3]| {
        if a < b && a < c {
            [a, b, c]
        } else if b < c {
            [b, c, a]
        } else {
            [c, a, b]
        }
    };
    kept.sort_unstable_by_key(|&(indices, number)| (turned(indices), number));
    kept.dedup_by_key(|(indices, _)| turned(*indices));
    kept.sort_unstable_by_key(|&(_, number)| number);
    before - kept.len()
}

/// A side of a triangle, with its edge: the two vertices, the smaller index first.
#[derive(Clone, Copy)]
struct Side {
    edge: (u32, u32),
    triangle: u32,
    corner: u32,
    /// True if the side leads from the smaller vertex index to the larger.
    forward: bool,
}

fn active_edges(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Vec<u8> {
    let mut sides: Vec<Side> = Vec::with_capacity(3 * triangles.len());
    for (triangle, indices) in triangles.iter().enumerate() {
        for corner in 0..3 {
            let (from, to) = (indices[corner], indices[(corner + 1) % 3]);
            let edge = super::ordered(from, to);
            sides.push(Side { edge, triangle: triangle as u32, corner: corner as u32, forward: from < to });
        }
    }
    sides.sort_unstable_by_key(|side| (side.edge, side.triangle));
    let corners = |triangle: u32| triangles[triangle as usize].map(|v| vertices[v as usize]);
    let mut active = vec![0_u8; triangles.len()];
    for around in sides.chunk_by(|p, q| p.edge == q.edge) {
        for side in around {
            // If several triangles share the edge, the one whose continuation bends least decides.
            let beyond = around.iter().filter(|other| other.forward != side.forward);
            let bends = beyond.map(|other| bends_down(&corners(side.triangle), &corners(other.triangle)));
            if bends.reduce(|a, b| a && b).unwrap_or(true) {
                active[side.triangle as usize] |= 1 << side.corner;
            }
        }
    }
    active
}

/// True if the edge between two triangles is active: the surface bends down there.
pub(super) fn bends_down(triangle: &[Vec3; 3], beyond: &[Vec3; 3]) -> bool {
    let (n, m) = (triangle::normal(triangle), triangle::normal(beyond));
    let middle = |&[a, b, c]: &[Vec3; 3]| (a + b + c) * (1.0 / 3.0);
    // The centroid of each triangle must be below the other triangle; both are tested, so that rounding does not give
    // different results for the two.
    let below = (middle(beyond) - middle(triangle)).dot(n - m) < 0.0;
    // The two triangles are the front and the back of the same sheet.
    let folded = n.dot(m) < -FELT_COSINE;
    folded || (n.dot(m) < FELT_COSINE && below)
}
