//! Boxes for a connected part of a mesh: a single box if it is close enough, otherwise boxes of cells.

use super::Scale;
use super::box_set::BoxSet;
use super::bvh::MeshBvh;
use super::cells::Grid;
use super::fit::{facet_directions, fit, orientations};
use super::fitted::{around, from_corners, shape};
use super::mesh::SurfaceMesh;
use super::plates::{plates, uncovered};
use super::sample::{MeshPoint, sample};
use crate::boxes::Obb;
use sinew_math::{Random, Rotation, Vec3, max};

/// Cosine (8°) above which a normal counts as along an axis.
const ALIGNED: f32 = 0.99;
/// Largest number of planes per axis of a part's grid.
const MOST_PLANES: usize = 40;
/// Number of cells along the longest side, for parts with slanted faces.
const CELLS: f32 = 24.0;
/// Largest number of boxes of one part.
const MOST_BOXES: usize = 256;
/// Share of a part's volume that may stay uncovered.
const LEFT_OUT: f32 = 0.005;

/// Returns boxes for a connected part. A part that is nearly a box gives one box. Other parts give boxes that fill the
/// inside, or plates behind the faces if those are closer to the part. Boxes that fill an open shell also have faces
/// across its holes, which count as error.
pub(super) fn blocks_of_part(
    mesh: &SurfaceMesh,
    bvh: &MeshBvh,
    triangles: &[u32],
    scale: Scale,
    random: &mut Random,
) -> Vec<Obb> {
    let (points, _) = sample(mesh, triangles, SAMPLES, random);
    let one = fit(mesh, triangles, scale.thinnest);
    if shape(&one).inner_radius() <= scale.thinnest {
        return plates(mesh, triangles, scale);
    }
    let [there, back] = rms_distances(bvh, &points, &[one], random);
    if there < scale.tolerance && back < scale.filled && !is_seen_from_inside(bvh, &one) {
        return vec![one];
    }
    let directions = facet_directions(mesh, triangles);
    let rotation = orientations(&directions).next().unwrap_or(Rotation::IDENTITY);
    let mut filled = boxes_of_cells(mesh, bvh, triangles, rotation, scale);
    let bare = uncovered(mesh, triangles, &filled, scale);
    filled.extend(plates(mesh, &bare, scale));
    let mut larger = |blocks: &[Obb]| {
        let [there, back] = rms_distances(bvh, &points, blocks, random);
        max(there, back)
    };
    let of_filled = larger(&filled);
    if of_filled < scale.filled {
        return filled;
    }
    let shell = plates(mesh, triangles, scale);
    if larger(&shell) < of_filled { shell } else { filled }
}

/// Number of points of a part with which boxes are compared.
const SAMPLES: usize = 400;

/// Returns the root mean square distances from points of a part to boxes, and from the boxes' outer surface to the
/// mesh, metres.
fn rms_distances(bvh: &MeshBvh, points: &[MeshPoint], blocks: &[Obb], random: &mut Random) -> [f32; 2] {
    let set = BoxSet::new(blocks);
    let rms = |distances: Vec<f32>| {
        let squares: f32 = distances.iter().map(|d| d * d).sum();
        (squares / usize::max(distances.len(), 1) as f32).sqrt()
    };
    let there = rms(points.iter().map(|p| set.distance_to_faces(p.position)).collect());
    let outer = set.outer_surface(SAMPLES, random);
    [there, rms(outer.iter().map(|&p| bvh.closest_point(p).distance).collect())]
}

/// True if the faces around the centre of a box point inward, as in a room.
pub(super) fn is_seen_from_inside(bvh: &MeshBvh, block: &Obb) -> bool {
    bvh.winding_number(block.center) < -0.5
}

fn is_inside(bvh: &MeshBvh, p: Vec3) -> bool {
    bvh.winding_number(p) > 0.5
}

fn boxes_of_cells(
    mesh: &SurfaceMesh,
    bvh: &MeshBvh,
    triangles: &[u32],
    rotation: Rotation,
    scale: Scale,
) -> Vec<Obb> {
    let planes = planes(mesh, triangles, rotation, scale);
    let grid = Grid::new(planes, |low, high| {
        // Centre of each eighth.
        let full = (0..8).filter(|i| {
            let t = |axis: usize| if i >> axis & 1 == 1 { 0.75 } else { 0.25 };
            let local = [0, 1, 2].map(|a| low[a] + (high[a] - low[a]) * t(a));
            is_inside(bvh, rotation * Vec3::from_array(local))
        });
        full.count() >= 5
    });
    let boxes = grid.cover(LEFT_OUT, MOST_BOXES);
    let block = |cells| {
        let (low, high) = grid.corners(cells);
        from_corners(Vec3::from_array(low), Vec3::from_array(high), rotation, scale.thinnest)
    };
    boxes.iter().map(block).collect()
}

/// Returns the positions of the planes that divide the part into cells, along each axis of the frame: those of the
/// part's facets, and regular planes if much of the part is slanted.
fn planes(mesh: &SurfaceMesh, triangles: &[u32], rotation: Rotation, scale: Scale) -> [Vec<f32>; 3] {
    let mut facets: [Vec<(f32, f32)>; 3] = Default::default();
    let (mut slanted, mut area) = (0.0, 0.0);
    let bounds = around(triangles.iter().flat_map(|&t| mesh.corners(t as usize)), rotation, 0.0);
    for &triangle in triangles {
        let doubled = rotation.inverse() * mesh.doubled_area(triangle as usize);
        let [a, b, c] = mesh.corners(triangle as usize);
        let middle = rotation.inverse() * ((a + b + c) / 3.0);
        let size = doubled.length();
        area += size;
        match (0..3).find(|&axis| doubled[axis].abs() > ALIGNED * size) {
            Some(axis) => facets[axis].push((middle[axis], size)),
            None => slanted += size,
        }
    }
    let center = rotation.inverse() * bounds.center;
    let h = bounds.half_extents;
    let longest = 2.0 * max(max(h.x, h.y), h.z);
    let step = if slanted > 0.05 * area { scale.finer * longest / CELLS } else { longest };
    let mut axis = 0;
    facets.map(|facets| {
        let ends = [center[axis] - h[axis], center[axis] + h[axis]];
        axis += 1;
        subdivided(&distinct(facets, ends, 0.5 * scale.tolerance), step)
    })
}

/// Returns the two ends and the coordinates of largest weight between them, at least `apart` from each other.
fn distinct(mut weighted: Vec<(f32, f32)>, ends: [f32; 2], apart: f32) -> Vec<f32> {
    weighted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut clusters: Vec<(f32, f32, f32)> = Vec::new();
    for (x, weight) in weighted {
        match clusters.last_mut() {
            Some((start, moment, total)) if x - *start < apart => {
                *moment += x * weight;
                *total += weight;
            }
            _ => clusters.push((x, x * weight, weight)),
        }
    }
    clusters.sort_by(|a, b| b.2.total_cmp(&a.2));
    let mut planes = ends.to_vec();
    for (_, moment, weight) in clusters.into_iter().take(MOST_PLANES) {
        let x = moment / weight;
        if planes.iter().all(|&other| (x - other).abs() >= apart) {
            planes.push(x);
        }
    }
    planes.sort_by(f32::total_cmp);
    planes
}

/// Returns the planes, and regular planes between them so that neighbours are at most `step` apart.
fn subdivided(planes: &[f32], step: f32) -> Vec<f32> {
    let mut out = vec![planes[0]];
    for pair in planes.windows(2) {
        let pieces = usize::max(((pair[1] - pair[0]) / step).ceil() as usize, 1);
        out.extend((1..=pieces).map(|i| pair[0] + (pair[1] - pair[0]) * (i as f32 / pieces as f32)));
    }
    out
}
