//! Splits meshes that are coarser than their particle spacing by halving long edges.

use super::SheetOptions;
use super::graph::Graph;
use super::weld::Welded;
use crate::tuning::{DIAGONAL, SQUARE_CORNER};
use sinew_math::direction;
use std::collections::BTreeMap;

/// An edge: two vertices, the smaller index first.
type Edge = [usize; 2];

fn edge(a: usize, b: usize) -> Edge {
    [usize::min(a, b), usize::max(a, b)]
}

impl Welded {
    fn length(&self, [a, b]: Edge) -> f32 {
        (self.places[b] - self.places[a]).length()
    }

    /// Longest edge of the mesh's triangles, metres.
    pub fn longest_edge(&self) -> f32 {
        let edges = self.faces.iter().flat_map(|&[a, b, c]| [edge(a, b), edge(b, c), edge(c, a)]);
        edges.map(|edge| self.length(edge)).fold(0.0, sinew_math::max)
    }

    /// Splits the components that have a vertex at least as high as `above` (m).
    pub fn split_connected(&mut self, above: f32, options: &SheetOptions<'_>) {
        let graph = Graph::new(self);
        let mut is_held = vec![false; self.places.len()];
        for (place, &component) in self.places.iter().zip(&graph.component) {
            is_held[component] |= place.y >= above;
        }
        self.split(options.spacing, options.most_particles, |vertex| is_held[graph.component[vertex]]);
    }

    /// Halves edges of the held components that are longer than `spacing` (diagonals of square cells may be
    /// longer), the longest first, up to `most` vertices. New vertices are appended and belong to no vertex of
    /// the mesh.
    fn split(&mut self, spacing: f32, most: usize, hangs: impl Fn(usize) -> bool) {
        let all = self.places.len();
        let others = (0..all).filter(|&vertex| !hangs(vertex)).count();
        loop {
            let mut long = self.long_edges(spacing, |vertex| vertex >= all || hangs(vertex));
            long.truncate(most.saturating_sub(self.places.len() - others));
            if long.is_empty() {
                return;
            }
            let middles: BTreeMap<Edge, usize> =
                long.into_iter().map(|edge| (edge, self.halve(edge))).collect();
            let faces = core::mem::take(&mut self.faces);
            for face in faces {
                self.cut(face, &middles);
            }
        }
    }

    /// Returns the edges that are too long, the longest first.
    fn long_edges(&self, spacing: f32, hangs: impl Fn(usize) -> bool) -> Vec<Edge> {
        let mut long: BTreeMap<Edge, f32> = BTreeMap::new();
        // Parts without area do not become cloth.
        for &[a, b, c] in self.faces.iter().filter(|face| hangs(face[0]) && self.area(face) > 0.0) {
            for [from, to, tip] in [[a, b, c], [b, c, a], [c, a, b]] {
                let length = self.length(edge(from, to));
                let [p, q] = [from, to].map(|end| direction(self.places[end] - self.places[tip]));
                let is_square = p.zip(q).is_some_and(|(p, q)| p.dot(q) < SQUARE_CORNER);
                if length > spacing * if is_square { DIAGONAL } else { 1.0 } {
                    long.insert(edge(from, to), length);
                }
            }
        }
        let mut long: Vec<(Edge, f32)> = long.into_iter().collect();
        long.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        long.into_iter().map(|(edge, _)| edge).collect()
    }

    /// Adds a vertex at the midpoint of an edge, in the component of its first end.
    fn halve(&mut self, [a, b]: Edge) -> usize {
        self.places.push((self.places[a] + self.places[b]) * 0.5);
        self.at.push((self.at[a] + self.at[b]) * 0.5);
        self.slots.push(self.slots[a]);
        self.places.len() - 1
    }

    /// Replaces a triangle by parts with the same winding.
    fn cut(&mut self, [a, b, c]: [usize; 3], middles: &BTreeMap<Edge, usize>) {
        let middle = |from: usize, to: usize| middles.get(&edge(from, to)).copied();
        match [middle(a, b), middle(b, c), middle(c, a)] {
            [None, None, None] => self.faces.push([a, b, c]),
            [Some(m), Some(n), Some(o)] => self.faces.extend([[a, m, o], [m, b, n], [o, n, c], [m, n, o]]),
            // Rotates the corners so that the first side is split and the last is not.
            [None, Some(_), _] => self.cut([b, c, a], middles),
            [_, None, Some(_)] => self.cut([c, a, b], middles),
            [Some(m), None, None] => self.faces.extend([[a, m, c], [m, b, c]]),
            [Some(m), Some(n), None] => {
                self.faces.push([m, b, n]);
                if self.length([a, n]) < self.length([m, c]) {
                    self.faces.extend([[a, m, n], [a, n, c]]);
                } else {
                    self.faces.extend([[a, m, c], [m, n, c]]);
                }
            }
        }
    }
}
