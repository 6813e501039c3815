//! Edges of a welded mesh.

use super::weld::Welded;
use std::collections::BTreeMap;

/// Edges of a mesh.
pub(super) struct Graph {
    /// Neighbours of each vertex, ascending, with the edge length, metres.
    pub beside: Vec<Vec<(usize, f32)>>,
    /// True for vertices of an edge that only one face has.
    pub is_border: Vec<bool>,
    /// Component of each vertex.
    pub component: Vec<usize>,
}

impl Graph {
    pub fn new(welded: &Welded) -> Self {
        let count = welded.places.len();
        let mut edges: BTreeMap<[usize; 2], u32> = BTreeMap::new();
        for &[a, b, c] in &welded.faces {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *edges.entry([usize::min(from, to), usize::max(from, to)]).or_default() += 1;
            }
        }
        let (mut beside, mut is_border) = (vec![Vec::new(); count], vec![false; count]);
        for (&[a, b], &faces) in &edges {
            let length = (welded.places[b] - welded.places[a]).length();
            beside[a].push((b, length));
            beside[b].push((a, length));
            for end in [a, b].into_iter().filter(|_| faces == 1) {
                is_border[end] = true;
            }
        }
        let component = components(&beside);
        Self { beside, is_border, component }
    }
}

fn components(beside: &[Vec<(usize, f32)>]) -> Vec<usize> {
    let mut component = vec![usize::MAX; beside.len()];
    let mut stack = Vec::new();
    for start in 0..beside.len() {
        if component[start] == usize::MAX {
            stack.push(start);
        }
        while let Some(at) = stack.pop() {
            if component[at] == usize::MAX {
                component[at] = start;
                stack.extend(beside[at].iter().map(|&(other, _)| other));
            }
        }
    }
    component
}
