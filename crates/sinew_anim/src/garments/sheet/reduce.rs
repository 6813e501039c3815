//! Particles of a sheet among the vertices of its mesh.

use super::SheetOptions;
use super::graph::{Graph, Ways};
use super::weld::Welded;
use crate::tuning::COARSER;
use std::collections::BTreeSet;

/// A mesh reduced to particles.
pub(super) struct Reduced {
    /// Vertex of each particle.
    pub seeds: Vec<usize>,
    /// Particle that each vertex belongs to; `None` where nothing holds its part of the mesh.
    pub owner: Vec<Option<usize>>,
    pub faces: Vec<[u32; 3]>,
    pub links: Vec<[u32; 2]>,
    /// Every vertex is a particle of its own.
    pub is_whole: bool,
}

pub(super) fn reduce(
    welded: &Welded,
    graph: &Graph,
    is_held: impl Fn(usize) -> bool,
    options: &SheetOptions<'_>,
) -> Reduced {
    let count = welded.places.len();
    let held: BTreeSet<usize> =
        (0..count).filter(|&vertex| is_held(vertex)).map(|vertex| graph.component[vertex]).collect();
    let hangs: Vec<usize> = (0..count).filter(|&vertex| held.contains(&graph.component[vertex])).collect();
    let is_whole = hangs.len() <= options.most_particles;
    let mut owner = vec![None; count];
    let seeds = if is_whole {
        hangs.iter().enumerate().for_each(|(particle, &vertex)| owner[vertex] = Some(particle));
        hangs
    } else {
        let (seeds, ways) = spread(graph, &hangs, options);
        let mut particle_of = vec![None; count];
        seeds.iter().enumerate().for_each(|(particle, &seed)| particle_of[seed] = Some(particle));
        hangs.iter().for_each(|&vertex| owner[vertex] = particle_of[ways.from[vertex]]);
        seeds
    };
    let (mut known, mut faces, mut links) = (BTreeSet::new(), Vec::new(), BTreeSet::new());
    for face in &welded.faces {
        let [Some(a), Some(b), Some(c)] = face.map(|vertex| owner[vertex]) else { continue };
        for [from, to] in [[a, b], [b, c], [c, a]] {
            if from != to {
                links.insert([from, to].map(|at| at as u32).into_sorted());
            }
        }
        let mut sorted = [a, b, c];
        sorted.sort_unstable();
        if a != b && b != c && c != a && known.insert(sorted) {
            faces.push([a, b, c].map(|at| at as u32));
        }
    }
    Reduced { seeds, owner, faces, links: links.into_iter().collect(), is_whole }
}

trait IntoSorted {
    fn into_sorted(self) -> Self;
}

impl IntoSorted for [u32; 2] {
    fn into_sorted(self) -> Self {
        [u32::min(self[0], self[1]), u32::max(self[0], self[1])]
    }
}

/// Vertices that lie all over a mesh, each the farthest from those before it (Gonzalez 1985): first along its borders, so that a hem stays a hem. No vertex is
/// farther from one of them than half the spacing; if that takes too many, the spacing grows.
fn spread(graph: &Graph, among: &[usize], options: &SheetOptions<'_>) -> (Vec<usize>, Ways) {
    let border: Vec<usize> = among.iter().copied().filter(|&vertex| graph.is_border[vertex]).collect();
    let mut reach = 0.5 * options.spacing;
    loop {
        let (mut seeds, mut ways) = (Vec::new(), Ways::new(graph.beside.len()));
        for part in [border.as_slice(), among] {
            while let Some(farthest) = farthest(&ways, part).filter(|&vertex| ways.length[vertex] > reach) {
                if seeds.len() > options.most_particles {
                    break;
                }
                seeds.push(farthest);
                ways.add(graph, farthest);
            }
        }
        if seeds.len() <= options.most_particles {
            return (seeds, ways);
        }
        reach *= COARSER;
    }
}

/// The first of those vertices that are farthest.
fn farthest(ways: &Ways, among: &[usize]) -> Option<usize> {
    among
        .iter()
        .copied()
        .reduce(|most, vertex| if ways.length[vertex] > ways.length[most] { vertex } else { most })
}
