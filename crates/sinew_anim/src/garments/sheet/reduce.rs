//! Chooses the particles of a sheet among the vertices of its mesh.

use super::graph::Graph;
use super::weld::Welded;
use super::{SheetError, SheetOptions};
use crate::garments::ways::Ways;
use crate::tuning::{COARSER, FINEST};
use sinew_math::{Vec3, max, max3, min3};
use std::collections::BTreeSet;

/// A mesh reduced to particles.
pub(super) struct Reduced {
    /// Vertex of each particle.
    pub seeds: Vec<usize>,
    /// Particle of each vertex; `None` if its part of the mesh is not connected to a held vertex.
    pub owner: Vec<Option<usize>>,
    pub faces: Vec<[u32; 3]>,
    pub links: Vec<[u32; 2]>,
    /// Area of the mesh around each particle, m².
    pub areas: Vec<f32>,
    /// True if every vertex is a particle.
    pub is_whole: bool,
}

/// Reduces a mesh to particles within the limit; also returns the particle of each welded vertex.
///
/// # Errors
/// If the held part has no area, is less than half of the mesh, or has more pieces than particles are allowed.
pub(super) fn reduce(
    welded: &Welded,
    graph: &Graph,
    is_held: impl Fn(usize) -> bool,
    options: &SheetOptions<'_>,
) -> Result<Reduced, SheetError> {
    let count = welded.places.len();
    let held: BTreeSet<usize> =
        (0..count).filter(|&vertex| is_held(vertex)).map(|vertex| graph.component[vertex]).collect();
    let hangs: Vec<usize> = (0..count).filter(|&vertex| held.contains(&graph.component[vertex])).collect();
    let sum = |faces: &mut dyn Iterator<Item = &[usize; 3]>| faces.map(|face| welded.area(face)).sum::<f32>();
    let hanging =
        sum(&mut welded.faces.iter().filter(|&&[corner, ..]| held.contains(&graph.component[corner])));
    if hanging.partial_cmp(&0.0) != Some(core::cmp::Ordering::Greater) || !hanging.is_finite() {
        return Err(SheetError::Empty);
    }
    if hanging < 0.5 * sum(&mut welded.faces.iter()) {
        return Err(SheetError::MostlyLoose);
    }
    let is_whole = hangs.len() <= options.most_particles;
    let mut owner = vec![None; count];
    let seeds = if is_whole {
        hangs.iter().enumerate().for_each(|(particle, &vertex)| owner[vertex] = Some(particle));
        hangs
    } else if held.len() > options.most_particles {
        return Err(SheetError::TooManyPieces(held.len()));
    } else {
        let (seeds, ways) = spread(welded, graph, &hangs, is_held, options);
        let mut particle_of = vec![None; count];
        seeds.iter().enumerate().for_each(|(particle, &seed)| particle_of[seed] = Some(particle));
        hangs.iter().for_each(|&vertex| owner[vertex] = particle_of[ways.from[vertex]]);
        seeds
    };
    Ok(Reduced::new(welded, seeds, owner, is_whole))
}

impl Reduced {
    /// Builds triangles and links between particles, and the mesh area of each particle: a vertex has a third of its
    /// triangles' area.
    fn new(welded: &Welded, seeds: Vec<usize>, owner: Vec<Option<usize>>, is_whole: bool) -> Self {
        let (mut known, mut faces, mut links) = (BTreeSet::new(), Vec::new(), BTreeSet::new());
        let mut areas = vec![0.0; seeds.len()];
        for face in &welded.faces {
            let [Some(a), Some(b), Some(c)] = face.map(|vertex| owner[vertex]) else { continue };
            let share = welded.area(face) / 3.0;
            [a, b, c].iter().for_each(|&corner| areas[corner] += share);
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
        Self { seeds, owner, faces, links: links.into_iter().collect(), areas, is_whole }
    }
}

trait IntoSorted {
    fn into_sorted(self) -> Self;
}

impl IntoSorted for [u32; 2] {
    fn into_sorted(self) -> Self {
        [u32::min(self[0], self[1]), u32::max(self[0], self[1])]
    }
}

/// Spreads vertices over a mesh, each the farthest from those before it (Gonzalez 1985): first the held part, so that
/// every held piece has one, then borders, so that hems keep their shape. No vertex is farther than half the spacing
/// from one of them; if that needs too many vertices, the spacing grows.
fn spread(
    welded: &Welded,
    graph: &Graph,
    among: &[usize],
    is_held: impl Fn(usize) -> bool,
    options: &SheetOptions<'_>,
) -> (Vec<usize>, Ways) {
    let only = |is_wanted: &dyn Fn(usize) -> bool| -> Vec<usize> {
        among.iter().copied().filter(|&vertex| is_wanted(vertex)).collect()
    };
    let held_border = only(&|vertex| graph.is_border[vertex] && is_held(vertex));
    let (held, border) = (only(&is_held), only(&|vertex| graph.is_border[vertex]));
    let places = || among.iter().map(|&vertex| welded.places[vertex]);
    let extent = places().fold(Vec3::NEG_INFINITY, max3) - places().fold(Vec3::INFINITY, min3);
    let mut reach = max(0.5 * options.spacing, FINEST * extent.length());
    loop {
        let (mut seeds, mut ways) = (Vec::new(), Ways::new(graph.beside.len()));
        for part in [held_border.as_slice(), held.as_slice(), border.as_slice(), among] {
            while let Some(farthest) = farthest(&ways, part).filter(|&vertex| ways.length[vertex] > reach) {
                if seeds.len() > options.most_particles {
                    break;
                }
                seeds.push(farthest);
                ways.add(&graph.beside, [farthest]);
            }
        }
        if seeds.len() <= options.most_particles {
            return (seeds, ways);
        }
        reach *= COARSER;
    }
}

/// Returns the first of the farthest vertices in `among`.
fn farthest(ways: &Ways, among: &[usize]) -> Option<usize> {
    among
        .iter()
        .copied()
        .reduce(|most, vertex| if ways.length[vertex] > ways.length[most] { vertex } else { most })
}
