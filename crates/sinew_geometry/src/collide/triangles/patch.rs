//! Merges the contacts of triangles into a few manifolds.

use super::Candidate;
use crate::collide::reduce::push_best;
use crate::collide::{MAX_POINTS, Manifold, ManifoldPoint};
use sinew_math::{Transform, Vec3};

/// Largest number of manifolds of a shape and a surface. The last manifold also takes contacts with less similar
/// normals.
pub const MAX_PARTS: usize = 8;
/// Cosine between two normals (5°) above which the contacts share one normal.
pub(super) const SAME_NORMAL: f32 = 0.996;

/// Manifolds of a surface and a shape.
#[derive(Clone, Copy, Debug, Default)]
pub struct Patch {
    manifolds: [Manifold; MAX_PARTS],
    count: usize,
}

impl Patch {
    /// Removes all manifolds.
    #[inline]
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Manifolds, at most [`MAX_PARTS`].
    #[inline]
    pub fn manifolds(&self) -> &[Manifold] {
        &self.manifolds[..self.count]
    }

    /// Flips all manifolds, so that A is the shape and B the surface.
    pub fn flip(&mut self) {
        for manifold in &mut self.manifolds[..self.count] {
            manifold.flip();
        }
    }

    /// Converts from the surface's axes around the shape's centre to the world; drops manifolds that are not finite.
    pub fn finish(&mut self, world_from_surface: &Transform, center: Vec3) {
        let mut kept = 0;
        for k in 0..self.count {
            let mut manifold = self.manifolds[k];
            manifold.normal = world_from_surface.rotation * manifold.normal;
            for point in &mut manifold.points[..manifold.count] {
                point.position = world_from_surface.point(center + point.position);
            }
            manifold.finish(Vec3::ZERO);
            if manifold.count > 0 {
                self.manifolds[kept] = manifold;
                kept += 1;
            }
        }
        self.count = kept;
    }
}

/// Buffers that calls of [`merge`] reuse, to avoid allocations.
#[derive(Clone, Debug, Default)]
pub(super) struct Merging {
    /// Indices of the valid candidates, the deepest first.
    order: Vec<u32>,
    /// Points of one manifold.
    points: Vec<ManifoldPoint>,
}

/// Merges contacts with the same normal, the deepest first, and keeps at most four points per normal.
pub(super) fn merge(
    candidates: &[Candidate],
    points: &[ManifoldPoint],
    tolerance: f32,
    merging: &mut Merging,
    out: &mut Patch,
) {
    let Merging { order, points: gathered } = merging;
    order.clear();
    order.extend((0..candidates.len() as u32).filter(|&i| candidates[i as usize].holds));
    // Candidates of nearly equal depth are ordered by index, so that rounding does not change which normal the merged
    // manifold gets.
    let depth = |i: u32| (candidates[i as usize].nearest / (4.0 * tolerance)).floor();
    order.sort_unstable_by(|&i, &j| depth(i).total_cmp(&depth(j)).then(i.cmp(&j)));
    while let Some(&first) = order.first()
        && out.count < MAX_PARTS
    {
        let normal = candidates[first as usize].normal;
        let last = out.count + 1 == MAX_PARTS;
        let joins = |i: u32| {
            let cosine = candidates[i as usize].normal.dot(normal);
            cosine >= SAME_NORMAL || (last && cosine > 0.5)
        };
        gathered.clear();
        for &i in order.iter().filter(|&&i| joins(i)) {
            let Candidate { first, count, .. } = candidates[i as usize];
            for point in &points[first as usize..(first + count) as usize] {
                push_once(gathered, point, tolerance);
            }
        }
        order.retain(|&i| !joins(i));
        let manifold = &mut out.manifolds[out.count];
        *manifold = Manifold { normal, ..Manifold::default() };
        push_best(gathered, tolerance, manifold);
        out.count += 1;
    }
}

/// Adds a point unless it is near a recent one: adjacent triangles share corners. Only the last few points are
/// compared.
fn push_once(points: &mut Vec<ManifoldPoint>, point: &ManifoldPoint, tolerance: f32) {
    const FEW: usize = 4 * MAX_POINTS;
    let near = |p: &&mut ManifoldPoint| (p.position - point.position).length() <= 2.0 * tolerance;
    match points.iter_mut().rev().take(FEW).find(near) {
        // Prefers the name of a face, because all triangles have the same name for their faces.
        Some(known) => {
            if super::name::is_face(point.feature as u16) {
                known.feature = point.feature;
            }
        }
        None => points.push(*point),
    }
}
