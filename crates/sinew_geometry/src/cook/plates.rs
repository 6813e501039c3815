//! Plates: boxes behind flat regions of the mesh that are far from all other boxes.

use super::Scale;
use super::bvh::MeshBvh;
use super::cells::Grid;
use super::fitted::from_corners;
use super::mesh::SurfaceMesh;
use crate::boxes::{Cuboid, Obb};
use sinew_math::{Mat3, Rotation, Vec3, any_orthonormal, max, min, normalize_or};

/// Least cosine (20°) between the normals of a region and its first normal.
const FLAT: f32 = 0.94;
/// Number of cells along the longer side of a region that is not a rectangle.
const CELLS: usize = 24;
/// Largest number of boxes of one region.
const MOST_BOXES: usize = 64;

/// Returns the triangles whose centroid or a point near a corner is farther from all boxes than the tolerance.
pub(super) fn uncovered(mesh: &SurfaceMesh, triangles: &[u32], blocks: &[Obb], scale: Scale) -> Vec<u32> {
    let blocks: Vec<_> = blocks.iter().map(Cuboid::placed).collect();
    let near = |p: Vec3| blocks.iter().any(|block| block.signed_distance(p).abs() <= scale.tolerance);
    let is_bare = |&triangle: &u32| {
        let corners = mesh.corners(triangle as usize);
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let size = (corners[1] - corners[0]).length() + (corners[2] - corners[0]).length();
        // The centroid suffices for small triangles.
        !near(middle)
            || (size > scale.tolerance
                && corners.iter().any(|&corner| !near(corner + (middle - corner) * 0.2)))
    };
    triangles.iter().copied().filter(is_bare).collect()
}

/// Returns plates behind the triangles, region by region.
pub(super) fn plates(mesh: &SurfaceMesh, triangles: &[u32], scale: Scale) -> Vec<Obb> {
    flat_regions(mesh, triangles, scale)
        .iter()
        .flat_map(|region| plates_of_region(mesh, region, scale))
        .collect()
}

/// Returns regions of connected triangles near a common plane. Each region grows from its largest triangle.
fn flat_regions(mesh: &SurfaceMesh, triangles: &[u32], scale: Scale) -> Vec<Vec<u32>> {
    let neighbors = neighbors(mesh, triangles);
    let area: Vec<f32> = triangles.iter().map(|&t| mesh.doubled_area(t as usize).length()).collect();
    let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
    order.sort_by(|&a, &b| area[b as usize].total_cmp(&area[a as usize]).then(a.cmp(&b)));
    let mut taken = vec![false; triangles.len()];
    let mut regions = Vec::new();
    for seed in order {
        if taken[seed as usize] {
            continue;
        }
        let normal = normalize_or(mesh.doubled_area(triangles[seed as usize] as usize), Vec3::Y);
        let height = normal.dot(mesh.corners(triangles[seed as usize] as usize)[0]);
        let is_flat = |i: u32| {
            let triangle = triangles[i as usize] as usize;
            let facing = mesh.doubled_area(triangle).dot(normal) > FLAT * area[i as usize];
            facing && mesh.corners(triangle).iter().all(|p| (p.dot(normal) - height).abs() < scale.tolerance)
        };
        let mut region = Vec::new();
        let mut open = vec![seed];
        taken[seed as usize] = true;
        while let Some(i) = open.pop() {
            region.push(triangles[i as usize]);
            for &j in &neighbors[i as usize] {
                if j != u32::MAX && !taken[j as usize] && is_flat(j) {
                    taken[j as usize] = true;
                    open.push(j);
                }
            }
        }
        regions.push(region);
    }
    regions
}

/// Returns the neighbour across each side of each triangle, by position in the list; `u32::MAX` if there is none.
fn neighbors(mesh: &SurfaceMesh, triangles: &[u32]) -> Vec<[u32; 3]> {
    let mut edges: Vec<(u32, u32, u32, u32)> = Vec::with_capacity(3 * triangles.len());
    for (i, &triangle) in triangles.iter().enumerate() {
        let corners = mesh.triangles[triangle as usize];
        for side in 0..3 {
            let (from, to) = (corners[side], corners[(side + 1) % 3]);
            edges.push((u32::min(from, to), u32::max(from, to), i as u32, side as u32));
        }
    }
    edges.sort_unstable();
    let mut neighbors = vec![[u32::MAX; 3]; triangles.len()];
    for pair in edges.windows(2) {
        let (p, q) = (pair[0], pair[1]);
        if (p.0, p.1) == (q.0, q.1) {
            neighbors[p.2 as usize][p.3 as usize] = q.2;
            neighbors[q.2 as usize][q.3 as usize] = p.2;
        }
    }
    neighbors
}

fn plates_of_region(mesh: &SurfaceMesh, region: &[u32], scale: Scale) -> Vec<Obb> {
    let (rotation, low, high) = smallest_rectangle(mesh, region);
    // The box is behind the face, so that objects stand on the drawn surface.
    let low = low - Vec3::Y * scale.thickness;
    let area: f32 = region.iter().map(|&t| 0.5 * mesh.doubled_area(t as usize).length()).sum();
    let size = high - low;
    if area > 0.8 * size.x * size.z || max(size.x, size.z) < 4.0 * scale.tolerance {
        return vec![from_corners(low, high, rotation, scale.thinnest)];
    }
    let corners: Vec<_> = region.iter().map(|&t| mesh.corners(t as usize)).collect();
    let bvh = MeshBvh::new(&corners);
    let step = max(max(size.x, size.z) / CELLS as f32, scale.tolerance);
    let even = |low: f32, high: f32| {
        let pieces = usize::max(((high - low) / step).ceil() as usize, 1);
        (0..=pieces).map(|i| low + (high - low) * (i as f32 / pieces as f32)).collect::<Vec<_>>()
    };
    let top = high.y;
    let planes = [even(low.x, high.x), vec![low.y, high.y], even(low.z, high.z)];
    let grid = Grid::new(planes, |low, high| {
        let middle = Vec3::new(0.5 * (low[0] + high[0]), top, 0.5 * (low[2] + high[2]));
        let away = rotation.inverse() * (bvh.closest_point(rotation * middle).point) - middle;
        // The point is beside the region, not over one of its triangles.
        away.x * away.x + away.z * away.z < 0.05 * step * step
    });
    let boxes = grid.cover(0.01, MOST_BOXES);
    let block = |cells| {
        let (low, high) = grid.corners(cells);
        from_corners(Vec3::from_array(low), Vec3::from_array(high), rotation, scale.thinnest)
    };
    boxes.iter().map(block).collect()
}

/// Returns the frame with y along the region's normal and x along one of its edges in which its bounds are smallest,
/// and the low and the high corner of these bounds.
fn smallest_rectangle(mesh: &SurfaceMesh, region: &[u32]) -> (Rotation, Vec3, Vec3) {
    const TRIED: usize = 8;
    let doubled: Vec3 = region.iter().map(|&t| mesh.doubled_area(t as usize)).sum();
    let up = normalize_or(doubled, Vec3::Y);
    let mut edges: Vec<Vec3> = Vec::new();
    for &triangle in region {
        let [a, b, c] = mesh.corners(triangle as usize);
        edges.extend([b - a, c - b, a - c].map(|edge| edge - up * up.dot(edge)));
    }
    edges.sort_by(|a, b| b.length_squared().total_cmp(&a.length_squared()));
    edges.truncate(TRIED);
    edges.push(any_orthonormal(up));
    let frames = edges.iter().map(|&edge| {
        let right = normalize_or(edge, any_orthonormal(up));
        let rotation = Rotation::from_mat3_lossy(&Mat3::from_cols(right, up, right.cross(up)));
        let (mut low, mut high) = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
        for p in region.iter().flat_map(|&t| mesh.corners(t as usize)) {
            let local = rotation.inverse() * p;
            low = Vec3::new(min(low.x, local.x), min(low.y, local.y), min(low.z, local.z));
            high = Vec3::new(max(high.x, local.x), max(high.y, local.y), max(high.z, local.z));
        }
        (rotation, low, high)
    });
    let area = |(_, low, high): &(Rotation, Vec3, Vec3)| (high.x - low.x) * (high.z - low.z);
    let smallest = frames.reduce(|a, b| if area(&b) < area(&a) { b } else { a });
    smallest.unwrap_or((Rotation::IDENTITY, Vec3::ZERO, Vec3::ZERO))
}
