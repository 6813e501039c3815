//! Orientation in which a box fits a part of a mesh closely.

use super::fitted::around;
use super::mesh::SurfaceMesh;
use crate::boxes::{Cuboid, Obb};
use sinew_math::{Mat3, Rotation, Vec3, any_orthonormal, normalize_or};

/// Cosine (10°) above which normals count as one direction.
const SAME: f32 = 0.985;
/// Cosine (1.8°) of the angle to a world axis above which a direction is replaced by that axis.
const LEVEL: f32 = 0.9995;
/// An oriented box replaces the axis-aligned box if its volume is below this share of the axis-aligned box's volume.
const GAIN: f32 = 0.92;

/// Returns the smallest of the boxes along the world's axes and along the largest facets of a part of a mesh.
pub(super) fn fit(mesh: &SurfaceMesh, triangles: &[u32], least: f32) -> Obb {
    let corners = || triangles.iter().flat_map(|&t| mesh.corners(t as usize));
    let boxed = |rotation| around(corners(), rotation, least);
    let level = boxed(Rotation::IDENTITY);
    let directions = facet_directions(mesh, triangles);
    let mut best = level;
    for rotation in orientations(&directions) {
        let turned = boxed(rotation);
        if turned.volume() < best.volume() * if best == level { GAIN } else { 1.0 } {
            best = turned;
        }
    }
    best
}

/// Directions of a part's faces, ignoring sign, weighted by area.
pub(super) fn facet_directions(mesh: &SurfaceMesh, triangles: &[u32]) -> Vec<(Vec3, f32)> {
    let normals = triangles.iter().map(|&t| mesh.doubled_area(t as usize));
    cluster(normals.map(|doubled| {
        let length = doubled.length();
        (doubled / length, length)
    }))
}

/// Merges weighted directions that nearly agree except for sign; returns them in the order of decreasing weight.
pub(super) fn cluster(weighted: impl Iterator<Item = (Vec3, f32)>) -> Vec<(Vec3, f32)> {
    /// Largest number of directions; further directions of a round surface do not improve the fit.
    const MOST: usize = 24;
    let mut clusters: Vec<(Vec3, f32)> = Vec::new();
    // Summed weights of the directions that are along the world's axes.
    let mut along: Vec<Vec3> = Vec::new();
    for (direction, weight) in weighted {
        let same = |(sum, _): &(Vec3, f32)| direction.dot(normalize_or(*sum, Vec3::Y)).abs() > SAME;
        let at = match clusters.iter().position(same) {
            Some(at) => {
                let (sum, total) = &mut clusters[at];
                *sum += direction * if sum.dot(direction) < 0.0 { -weight } else { weight };
                *total += weight;
                at
            }
            None if clusters.len() < MOST => {
                clusters.push((direction * weight, weight));
                along.push(Vec3::ZERO);
                clusters.len() - 1
            }
            None => continue,
        };
        if let Some(axis) = axis_along(direction) {
            along[at][axis] += weight;
        }
    }
    for ((sum, total), along) in clusters.iter_mut().zip(along) {
        // Level treads with worn edges count as level.
        let axis = (0..3).find(|&axis| along[axis] >= 0.5 * *total);
        let direction = axis.map_or(*sum, |axis| Vec3::AXES[axis] * Vec3::AXES[axis].dot(*sum));
        *sum = normalize_or(direction, Vec3::Y);
    }
    clusters.sort_by(|a, b| b.1.total_cmp(&a.1));
    clusters
}

/// Returns frames with one axis along a direction of large weight, and another along the perpendicular direction of the
/// largest weight.
pub(super) fn orientations(directions: &[(Vec3, f32)]) -> impl Iterator<Item = Rotation> {
    const TRIED: usize = 3;
    let first = directions.iter().take(TRIED).map(|&(x, _)| snap(x));
    first.map(|x| {
        let flat = directions.iter().filter(|(d, _)| d.dot(x).abs() < 0.5);
        let y = flat.map(|&(d, _)| snap(normalize_or(d - x * d.dot(x), any_orthonormal(x)))).next();
        // If no other direction is perpendicular, use the vertical.
        let y = y.unwrap_or_else(|| normalize_or(Vec3::Y - x * x.y, any_orthonormal(x)));
        let y = normalize_or(y - x * x.dot(y), any_orthonormal(x));
        frame(x, y)
    })
}

/// Returns the world axis that a direction is close to, otherwise the direction itself.
fn snap(direction: Vec3) -> Vec3 {
    axis_along(direction).map_or(direction, |axis| Vec3::AXES[axis])
}

/// Index of the world axis that a direction is close to.
fn axis_along(direction: Vec3) -> Option<usize> {
    (0..3).find(|&axis| direction[axis].abs() > LEVEL)
}

/// Returns the rotation whose axes are, in some order and sign, x, y and their cross product, and which is closest to
/// the identity. The y half extent of the box is then half its height.
fn frame(x: Vec3, y: Vec3) -> Rotation {
    let axes = [x, y, x.cross(y)];
    let most = |world: Vec3, taken: Option<usize>| {
        let free = (0..3).filter(|&k| Some(k) != taken);
        free.max_by(|&a, &b| axes[a].dot(world).abs().total_cmp(&axes[b].dot(world).abs())).unwrap_or(0)
    };
    let toward = |k: usize, world: Vec3| if axes[k].dot(world) < 0.0 { -axes[k] } else { axes[k] };
    let up = most(Vec3::Y, None);
    let right = most(Vec3::X, Some(up));
    let (right, up) = (toward(right, Vec3::X), toward(up, Vec3::Y));
    let turned = Mat3::from_cols(right, up, right.cross(up));
    if turned == Mat3::IDENTITY { Rotation::IDENTITY } else { Rotation::from_mat3_lossy(&turned) }
}
