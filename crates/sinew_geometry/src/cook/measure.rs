//! Deviation of a set of boxes from its mesh.

use super::box_set::BoxSet;
use super::bvh::MeshBvh;
use super::mesh::SurfaceMesh;
use super::sample::sample;
use crate::boxes::{Aabb, Obb, Overlap};
use sinew_math::{Random, Vec3, max};

/// Number of sample points on the mesh and on the boxes.
const SAMPLES: usize = 20_000;

/// Distances between the surfaces of the boxes and the mesh, and the ratio of their volumes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Volume of the boxes' union divided by that of the mesh; `None` if the mesh is open or has no volume.
    pub volume_ratio: Option<f32>,
    /// 95th percentile of the distance between the two surfaces, metres; the larger of the two directions.
    pub distance_p95: f32,
    /// Largest distance between the two surfaces, metres.
    pub distance_max: f32,
}

/// Compares boxes with their mesh by points uniform over both surfaces: points of the mesh to the nearest box face, and
/// points of the boxes' outer surface (without faces inside another box) to the mesh.
pub(super) fn measure(mesh: &SurfaceMesh, bvh: &MeshBvh, blocks: &[Obb], random: &mut Random) -> Deviation {
    let all: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    let (points, _) = sample(mesh, &all, SAMPLES, random);
    let tree = BoxSet::new(blocks);
    let to_boxes = points.iter().map(|p| tree.distance_to_faces(p.position));
    let [p95_there, max_there] = quantiles(to_boxes.collect());
    let outer = tree.outer_surface(SAMPLES, random);
    let [p95_back, max_back] = quantiles(outer.iter().map(|&p| bvh.closest_point(p).distance).collect());
    let ratio = mesh.is_closed().then(|| tree.volume(random) / enclosed_volume(mesh, bvh, random));
    Deviation {
        // The volumes of closed shells may cancel; then the enclosed volume is 0.
        volume_ratio: ratio.filter(|ratio| ratio.is_finite()),
        distance_p95: max(p95_there, p95_back),
        distance_max: max(max_there, max_back),
    }
}

/// Returns the 95th percentile and the maximum; zeros if there are no distances.
fn quantiles(mut distances: Vec<f32>) -> [f32; 2] {
    distances.sort_unstable_by(f32::total_cmp);
    let Some(&last) = distances.last() else { return [0.0; 2] };
    [distances[(distances.len() * 95).div_ceil(100) - 1], last]
}

/// Volume of a closed mesh, m³. Uses the divergence theorem if the bounds of its parts are apart, otherwise the winding
/// numbers of sample points.
fn enclosed_volume(mesh: &SurfaceMesh, bvh: &MeshBvh, random: &mut Random) -> f32 {
    const ACROSS: usize = 48;
    if !parts_meet(mesh) {
        let center = mesh.bounds.center();
        let sixfold = |t: usize| {
            let [a, b, c] = mesh.corners(t).map(|p| p - center);
            f64::from(a.dot(b.cross(c)))
        };
        // The sum is negative for a room, whose faces point inward.
        return ((0..mesh.triangles.len()).map(sixfold).sum::<f64>() / 6.0).abs() as f32;
    }
    let size = mesh.bounds.max - mesh.bounds.min;
    let mut inside = 0;
    for i in 0..ACROSS * ACROSS * ACROSS {
        let cell = [i / (ACROSS * ACROSS), i / ACROSS % ACROSS, i % ACROSS];
        let t = cell.map(|k| (k as f32 + random.unit()) / ACROSS as f32);
        let p = mesh.bounds.min + Vec3::new(size.x * t[0], size.y * t[1], size.z * t[2]);
        inside += usize::from(bvh.winding_number(p) > 0.5);
    }
    size.x * size.y * size.z * (inside as f32 / (ACROSS * ACROSS * ACROSS) as f32)
}

/// True if the bounds of two connected parts overlap.
fn parts_meet(mesh: &SurfaceMesh) -> bool {
    let mut bounds: Vec<Option<Aabb>> = vec![None; mesh.parts];
    for (triangle, &part) in mesh.part.iter().enumerate() {
        for p in mesh.corners(triangle) {
            let point = Aabb { min: p, max: p };
            let of_part = &mut bounds[part as usize];
            *of_part = Some(of_part.map_or(point, |all| all.merge(&point)));
        }
    }
    let mut bounds: Vec<Aabb> = bounds.into_iter().flatten().collect();
    bounds.sort_by(|a, b| a.min.x.total_cmp(&b.min.x));
    (0..bounds.len()).any(|i| {
        let later = bounds[i + 1..].iter().take_while(|b| b.min.x <= bounds[i].max.x);
        later.into_iter().any(|b| b.overlaps(&bounds[i]))
    })
}
