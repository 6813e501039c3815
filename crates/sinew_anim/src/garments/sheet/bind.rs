//! Weights vertices to the particles of their sheet.

use super::reduce::Reduced;
use super::weld::Welded;
use sinew_math::{Vec3, triangle};

/// Particles that move a vertex, with their weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bound {
    pub particles: [usize; 4],
    pub weights: [f32; 4],
}

impl Bound {
    fn to_one(particle: usize) -> Self {
        Self { particles: [particle; 4], weights: [1.0, 0.0, 0.0, 0.0] }
    }
}

/// Weights each vertex to its own particle, or to the particles of the nearest triangle: among the triangles of its
/// particle if it has any, else among all.
pub(super) fn bind(welded: &Welded, reduced: &Reduced) -> Vec<Bound> {
    let area = |face: u32| welded.area(&reduced.faces[face as usize].map(|at| reduced.seeds[at as usize]));
    // Triangles without area are skipped.
    let all: Vec<u32> = (0..reduced.faces.len() as u32).filter(|&face| area(face) > 0.0).collect();
    let mut of_particle: Vec<Vec<u32>> = vec![Vec::new(); reduced.seeds.len()];
    for &face in &all {
        reduced.faces[face as usize].iter().for_each(|&corner| of_particle[corner as usize].push(face));
    }
    let bound = |(vertex, owner): (usize, &Option<usize>)| match *owner {
        Some(own) if reduced.is_whole => Bound::to_one(own),
        Some(own) => nearest(welded, reduced, vertex, &of_particle[own]).unwrap_or(Bound::to_one(own)),
        None => nearest(welded, reduced, vertex, &all).unwrap_or(Bound::to_one(0)),
    };
    reduced.owner.iter().enumerate().map(bound).collect()
}

/// Returns the triangle of `faces` that is nearest to a vertex.
fn nearest(welded: &Welded, reduced: &Reduced, vertex: usize, faces: &[u32]) -> Option<Bound> {
    let place = welded.places[vertex];
    let mut best: Option<(f32, Bound)> = None;
    for &face in faces {
        let [a, b, c] = reduced.faces[face as usize].map(|corner| corner as usize);
        let corners: [Vec3; 3] = [a, b, c].map(|particle| welded.places[reduced.seeds[particle]]);
        let [u, v, w] = triangle::nearest(&corners, place).shares();
        let off = (corners[0] * u + corners[1] * v + corners[2] * w - place).length_squared();
        // NaN is never nearer.
        if off < best.map_or(f32::INFINITY, |(least, _)| least) {
            best = Some((off, Bound { particles: [a, b, c, a], weights: [u, v, w, 0.0] }));
        }
    }
    best.map(|(_, bound)| bound)
}
