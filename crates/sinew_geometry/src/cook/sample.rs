//! Sample points of a mesh, uniform by area.

use super::mesh::SurfaceMesh;
use sinew_math::{Random, Vec3};

/// A point of a mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeshPoint {
    pub position: Vec3,
    /// Unit normal of the triangle.
    pub normal: Vec3,
}

/// Returns `count` points of the triangles, one in each of as many strata of equal area, and the area, m².
pub(crate) fn sample(
    mesh: &SurfaceMesh,
    triangles: &[u32],
    count: usize,
    random: &mut Random,
) -> (Vec<MeshPoint>, f32) {
    // Sum in f64, because there may be a million small areas.
    let area = |&t: &u32| f64::from(mesh.doubled_area(t as usize).length()) * 0.5;
    let total: f64 = triangles.iter().map(area).sum();
    let mut next = || f64::from(random.unit());
    let mut points = Vec::with_capacity(count);
    let (mut sum, mut at) = (0.0, next() / count as f64 * total);
    for triangle in triangles {
        sum += area(triangle);
        while points.len() < count && at < sum {
            points.push(*triangle);
            at = (points.len() as f64 + next()) / count as f64 * total;
        }
    }
    let points = points.into_iter().map(|triangle| point_on(mesh, triangle, random)).collect();
    (points, total as f32)
}

/// Returns a random point of a triangle, uniform by area (Osada et al. 2002, eq. 1).
fn point_on(mesh: &SurfaceMesh, triangle: u32, random: &mut Random) -> MeshPoint {
    let [a, b, c] = mesh.corners(triangle as usize);
    let (r, t) = (random.unit().sqrt(), random.unit());
    let position = a * (1.0 - r) + b * (r * (1.0 - t)) + c * (r * t);
    MeshPoint { position, normal: (b - a).cross(c - a).normalize() }
}
