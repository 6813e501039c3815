//! Decides which contacts with edges and corners of a surface are valid. A contact is valid if the edge or corner is
//! the closest feature of every triangle that has it; a triangle whose face is closest voids its edges (compare Box2D's
//! ghost vertices and Bullet's internal edges).

use super::patch::{MAX_PARTS, SAME_NORMAL};
use super::{Candidate, When};
use crate::triangles::Part;
use sinew_math::Vec3;

/// Cosine between a normal and its triangle's normal above which an inactive edge may have that normal: slightly more
/// than the 5° by which the surface may bend there.
const WITHIN_FACE: f32 = 0.995;

/// Cosine between a normal and its triangle's normal above which the shape counts as resting on the triangle.
const FACES: f32 = 0.9;

/// Cosine between two normals above which the contacts push to the same side.
const SAME_SIDE: f32 = 0.5;

/// Features of one surface that are void, because another triangle with the feature is touched elsewhere.
#[derive(Clone, Debug, Default)]
pub(super) struct Claims {
    edges: Vec<(u32, u32)>,
    vertices: Vec<u32>,
}

impl Claims {
    /// Marks the voided candidates. Overlaps up to the tolerance are ignored.
    pub fn settle(&mut self, candidates: &mut [Candidate], tolerance: f32) {
        self.edges.clear();
        self.vertices.clear();
        for candidate in candidates.iter().filter(|candidate| candidate.when == When::Now) {
            self.deny_others(candidate);
        }
        self.edges.sort_unstable();
        self.vertices.sort_unstable();
        for candidate in candidates.iter_mut() {
            candidate.holds = self.holds(candidate);
        }
        // Because of rounding, a point above a corner may belong to no triangle, and in a steep valley only inactive
        // edges may be in contact: then the best aligned candidate is kept.
        let overlaps = |candidate: &Candidate| candidate.nearest < -tolerance;
        let is_deep = candidates.iter().any(overlaps);
        let counts = |candidate: &Candidate| !is_deep || overlaps(candidate);
        if !candidates.iter().any(|candidate| candidate.holds && counts(candidate)) {
            let facing = |c: &Candidate| c.normal.dot(c.triangle.normal);
            let better =
                |a: usize, b: usize| if facing(&candidates[b]) > facing(&candidates[a]) { b } else { a };
            let unheard = (0..candidates.len()).filter(|&i| counts(&candidates[i]));
            if let Some(best) = unheard.reduce(better) {
                candidates[best].holds = true;
            }
        }
        keep_facing_overlaps(candidates, &overlaps);
    }

    /// Voids the features at which a triangle is not touched. An edge voids the corners at its ends, but a corner does
    /// not void its edges, because rounding decides between the two.
    fn deny_others(&mut self, candidate: &Candidate) {
        let triangle = &candidate.triangle;
        let (edges, vertices): (&[usize], &[usize]) = match candidate.part {
            Part::Face => (&[0, 1, 2], &[0, 1, 2]),
            Part::Edge(0) => (&[1, 2], &[0, 1, 2]),
            Part::Edge(1) => (&[0, 2], &[0, 1, 2]),
            Part::Edge(_) => (&[0, 1], &[0, 1, 2]),
            Part::Corner(0) => (&[1], &[1, 2]),
            Part::Corner(1) => (&[2], &[0, 2]),
            Part::Corner(_) => (&[0], &[0, 1]),
        };
        self.edges.extend(edges.iter().map(|&edge| triangle.edge_vertices(edge)));
        self.vertices.extend(vertices.iter().map(|&corner| triangle.vertices[corner]));
    }

    fn holds(&self, candidate: &Candidate) -> bool {
        let triangle = &candidate.triangle;
        match candidate.part {
            Part::Face => true,
            Part::Edge(edge) => {
                let denied = self.edges.binary_search(&triangle.edge_vertices(edge)).is_ok();
                !denied && is_felt(candidate, [edge, edge])
            }
            Part::Corner(corner) => {
                let denied = self.vertices.binary_search(&triangle.vertices[corner]).is_ok();
                !denied && is_felt(candidate, [corner, (corner + 2) % 3])
            }
        }
    }
}

/// Keeps an overlap that faces its triangle if no kept contact pushes from that side. In a concave crease each triangle
/// otherwise suppresses the other's contacts at the bottom.
fn keep_facing_overlaps(candidates: &mut [Candidate], overlaps: &impl Fn(&Candidate) -> bool) {
    let facing = |c: &Candidate| c.normal.dot(c.triangle.normal);
    for _ in 0..MAX_PARTS {
        let felt = |normal: Vec3| candidates.iter().any(|c| c.holds && c.normal.dot(normal) > SAME_SIDE);
        let unheard = candidates.iter().filter(|c| !c.holds && overlaps(c) && facing(c) > FACES);
        let unfelt = unheard.filter(|c| !felt(c.normal));
        let Some(best) = unfelt.reduce(|a, b| if facing(b) > facing(a) { b } else { a }) else { return };
        let normal = best.normal;
        for candidate in candidates.iter_mut() {
            candidate.holds |= overlaps(candidate) && candidate.normal.dot(normal) > SAME_NORMAL;
        }
    }
}

/// True if one of the edges is active, or the normal is nearly that of the face.
fn is_felt(candidate: &Candidate, edges: [usize; 2]) -> bool {
    let triangle = &candidate.triangle;
    edges.into_iter().any(|edge| triangle.is_active(edge))
        || candidate.normal.dot(triangle.normal) >= WITHIN_FACE
}
