//! Edges of a welded mesh, and ways along them.

use super::weld::Welded;
use core::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// Edges of a mesh.
pub(super) struct Graph {
    /// Vertices beside each, ascending, with the length of the edge, metres.
    pub beside: Vec<Vec<(usize, f32)>>,
    /// True for vertices of an edge that only one face has.
    pub is_border: Vec<bool>,
    /// Component that each vertex is of.
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

/// Distances along edges to the nearest of some vertices, and which that is.
pub(super) struct Ways {
    pub length: Vec<f32>,
    pub from: Vec<usize>,
}

impl Ways {
    /// From nowhere.
    pub fn new(count: usize) -> Self {
        Self { length: vec![f32::INFINITY; count], from: vec![usize::MAX; count] }
    }

    /// Begins at one vertex more (Dijkstra).
    pub fn add(&mut self, graph: &Graph, start: usize) {
        // Lengths are not negative, so their bits are in their order.
        let mut open = BinaryHeap::from([(Reverse(0), Reverse(start))]);
        (self.length[start], self.from[start]) = (0.0, start);
        while let Some((Reverse(bits), Reverse(at))) = open.pop() {
            let length = f32::from_bits(bits);
            if length > self.length[at] {
                continue;
            }
            for &(next, edge) in &graph.beside[at] {
                let way = length + edge;
                if way < self.length[next] {
                    (self.length[next], self.from[next]) = (way, start);
                    open.push((Reverse(way.to_bits()), Reverse(next)));
                }
            }
        }
    }
}
