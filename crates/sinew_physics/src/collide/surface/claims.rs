//! Which contacts with the edges and corners of a surface are real. One is if every triangle that has the edge or corner is
//! nearest to the shape there: over whose face the shape lies, to that it touches none of its edges (the idea of voided
//! features: Box2D's ghost vertices, Bullet's internal edges), unless it is nearer to an edge than to that face: deep in a
//! ridge, with a corner over the slope far below.

use super::{Candidate, When};
use crate::triangles::Part;

/// Cosine of the angle between a normal and its triangle's up to which an edge that cannot be felt may give it: a little more
/// than the 5° by which the surface may turn there.
const WITHIN_FACE: f32 = 0.995;

/// Features of one surface that are not what a triangle which has them is touched at.
#[derive(Clone, Debug, Default)]
pub(super) struct Claims {
    edges: Vec<Denied<(u32, u32)>>,
    vertices: Vec<Denied<u32>>,
}

/// A feature, and how far what denies it is from the shape.
#[derive(Clone, Copy, Debug)]
struct Denied<T> {
    feature: T,
    nearest: f32,
}

impl<T: Ord + Copy> Denied<T> {
    /// By feature, the nearest first.
    fn sort(list: &mut [Self]) {
        list.sort_unstable_by(|a, b| a.feature.cmp(&b.feature).then(a.nearest.total_cmp(&b.nearest)));
    }

    /// Whether a feature at some distance is denied by something that is as near.
    fn denies(list: &[Self], feature: T, distance: f32) -> bool {
        let first = list.partition_point(|denied| denied.feature < feature);
        list.get(first).is_some_and(|denied| denied.feature == feature && denied.nearest <= distance)
    }
}

impl Claims {
    /// Marks the candidates that do not hold.
    pub fn settle(&mut self, candidates: &mut [Candidate], tolerance: f32) {
        self.edges.clear();
        self.vertices.clear();
        for candidate in candidates.iter().filter(|candidate| candidate.when == When::Now) {
            self.deny_others(candidate);
        }
        Denied::sort(&mut self.edges);
        Denied::sort(&mut self.vertices);
        for candidate in candidates.iter_mut() {
            candidate.holds = self.holds(candidate, tolerance);
        }
        // What lies above a corner may by rounding belong to no one: then it touches what faces it best.
        if !candidates.iter().any(|candidate| candidate.holds) {
            let facing = |c: &Candidate| c.normal.dot(c.triangle.normal);
            let better =
                |a: usize, b: usize| if facing(&candidates[b]) > facing(&candidates[a]) { b } else { a };
            if let Some(best) = (0..candidates.len()).reduce(better) {
                candidates[best].holds = true;
            }
        }
    }

    /// What a triangle is not touched at. Corners are denied by edges that end there, and not the other way round: between
    /// the two, rounding decides.
    fn deny_others(&mut self, candidate: &Candidate) {
        let Candidate { ref triangle, nearest, .. } = *candidate;
        let (edges, vertices): (&[usize], &[usize]) = match candidate.part {
            Part::Face => (&[0, 1, 2], &[0, 1, 2]),
            Part::Edge(0) => (&[1, 2], &[0, 1, 2]),
            Part::Edge(1) => (&[0, 2], &[0, 1, 2]),
            Part::Edge(_) => (&[0, 1], &[0, 1, 2]),
            Part::Corner(0) => (&[1], &[1, 2]),
            Part::Corner(1) => (&[2], &[0, 2]),
            Part::Corner(_) => (&[0], &[0, 1]),
        };
        self.edges
            .extend(edges.iter().map(|&edge| Denied { feature: triangle.edge_vertices(edge), nearest }));
        self.vertices
            .extend(vertices.iter().map(|&corner| Denied { feature: triangle.vertices[corner], nearest }));
    }

    fn holds(&self, candidate: &Candidate, tolerance: f32) -> bool {
        let triangle = &candidate.triangle;
        let distance = candidate.nearest + tolerance;
        match candidate.part {
            Part::Face => true,
            Part::Edge(edge) => {
                let denied = Denied::denies(&self.edges, triangle.edge_vertices(edge), distance);
                !denied && is_felt(candidate, [edge, edge])
            }
            Part::Corner(corner) => {
                let denied = Denied::denies(&self.vertices, triangle.vertices[corner], distance);
                !denied && is_felt(candidate, [corner, (corner + 2) % 3])
            }
        }
    }
}

/// Whether one of the edges can be felt, or else the normal is as good as the face's.
fn is_felt(candidate: &Candidate, edges: [usize; 2]) -> bool {
    let triangle = &candidate.triangle;
    edges.into_iter().any(|edge| triangle.is_active(edge))
        || candidate.normal.dot(triangle.normal) >= WITHIN_FACE
}
