//! Decides which contacts with edges and corners of a surface are valid. A contact with an edge or corner is valid if
//! that feature is the closest one of every triangle to which it belongs. A triangle whose face is closest voids the
//! contacts at its edges and corners (compare Box2D's ghost vertices and Bullet's internal edges).

use super::patch::{MAX_PARTS, SAME_NORMAL};
use super::{Candidate, When};
use crate::triangles::Part;
use sinew_math::Vec3;

/// Cosine between a contact's normal and its triangle's normal above which the contact is valid at an inactive edge.
/// The angle, 5.7°, is slightly more than the 5° by which the surface may bend at an inactive edge.
const WITHIN_FACE: f32 = 0.995;

/// Cosine between a normal and its triangle's normal above which the shape counts as resting on the triangle.
const FACES: f32 = 0.9;

/// Cosine between two normals above which two contacts push toward the same side.
const SAME_SIDE: f32 = 0.5;

/// Edges and corners of one surface at which contacts are void, because another triangle with the feature is touched
/// elsewhere.
#[derive(Clone, Debug, Default)]
pub(super) struct Claims {
    edges: Vec<(u32, u32)>,
    vertices: Vec<u32>,
}

impl Claims {
    /// Sets [`Candidate::holds`] of each candidate. Overlaps up to `tolerance` (metres) do not count as overlaps.
    pub fn void_features(&mut self, candidates: &mut [Candidate], tolerance: f32) {
        self.edges.clear();
        self.vertices.clear();
        for candidate in candidates.iter().filter(|candidate| candidate.when == When::Now) {
            self.void_others(candidate);
        }
        self.edges.sort_unstable();
        self.vertices.sort_unstable();
        for candidate in candidates.iter_mut() {
            candidate.holds = self.holds(candidate);
        }
        // Because of rounding, triangles may void each other's contacts above a common corner, and in a steep crease
        // all contacts may be at inactive edges. Then the candidate whose normal is nearest to its triangle's is kept.
        let overlaps = |candidate: &Candidate| candidate.nearest < -tolerance;
        let is_deep = candidates.iter().any(overlaps);
        let counts = |candidate: &Candidate| !is_deep || overlaps(candidate);
        if !candidates.iter().any(|candidate| candidate.holds && counts(candidate)) {
            let facing = |c: &Candidate| c.normal.dot(c.triangle.normal);
            let better =
                |a: usize, b: usize| if facing(&candidates[b]) > facing(&candidates[a]) { b } else { a };
            let voided = (0..candidates.len()).filter(|&i| counts(&candidates[i]));
            if let Some(best) = voided.reduce(better) {
                candidates[best].holds = true;
            }
        }
        keep_facing_overlaps(candidates, &overlaps);
    }

    /// Voids the features of the candidate's triangle that are not touched. A contact at an edge also voids the corners
    /// at the edge's ends, but a contact at a corner does not void the two edges there: rounding decides whether a
    /// corner or an edge is closest.
    fn void_others(&mut self, candidate: &Candidate) {
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
                let voided = self.edges.binary_search(&triangle.edge_vertices(edge)).is_ok();
                !voided && may_have_normal(candidate, [edge, edge])
            }
            Part::Corner(corner) => {
                let voided = self.vertices.binary_search(&triangle.vertices[corner]).is_ok();
                !voided && may_have_normal(candidate, [corner, (corner + 2) % 3])
            }
        }
    }
}

/// Keeps a voided overlap that faces its triangle if no valid contact pushes toward that side. In a concave crease each
/// triangle otherwise voids the other triangle's contacts at the bottom.
fn keep_facing_overlaps(candidates: &mut [Candidate], overlaps: &impl Fn(&Candidate) -> bool) {
    let facing = |c: &Candidate| c.normal.dot(c.triangle.normal);
    for _ in 0..MAX_PARTS {
        let has_push = |normal: Vec3| candidates.iter().any(|c| c.holds && c.normal.dot(normal) > SAME_SIDE);
        let voided = candidates.iter().filter(|c| !c.holds && overlaps(c) && facing(c) > FACES);
        let unopposed = voided.filter(|c| !has_push(c.normal));
        let Some(best) = unopposed.reduce(|a, b| if facing(b) > facing(a) { b } else { a }) else { return };
        let normal = best.normal;
        for candidate in candidates.iter_mut() {
            candidate.holds |= overlaps(candidate) && candidate.normal.dot(normal) > SAME_NORMAL;
        }
    }
}

/// True if the contact's normal is possible at one of the edges: the edge is active, or the normal is nearly that of
/// the triangle.
fn may_have_normal(candidate: &Candidate, edges: [usize; 2]) -> bool {
    let triangle = &candidate.triangle;
    edges.into_iter().any(|edge| triangle.is_active(edge))
        || candidate.normal.dot(triangle.normal) >= WITHIN_FACE
}
