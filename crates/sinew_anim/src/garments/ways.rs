//! Shortest paths along edges.

use core::cmp::Reverse;
use std::collections::BinaryHeap;

/// Path length along edges from each vertex to the nearest start, with the index of that start.
#[derive(Clone, Debug, PartialEq)]
pub struct Ways {
    /// Infinite if no path exists.
    pub length: Vec<f32>,
    /// Index of the start; `usize::MAX` if no path exists.
    pub from: Vec<usize>,
}

impl Ways {
    /// Creates paths for `count` vertices, without starts.
    pub fn new(count: usize) -> Self {
        Self { length: vec![f32::INFINITY; count], from: vec![usize::MAX; count] }
    }

    /// Adds starts (Dijkstra); `beside` has the neighbours of each vertex, with edge lengths (≥ 0).
    pub fn add(&mut self, beside: &[Vec<(usize, f32)>], starts: impl IntoIterator<Item = usize>) {
        let mut open = BinaryHeap::new();
        for start in starts {
            (self.length[start], self.from[start]) = (0.0, start);
            open.push((Reverse(0), Reverse(start)));
        }
        // Lengths are not negative, so their bits sort like the lengths.
        while let Some((Reverse(bits), Reverse(at))) = open.pop() {
            let length = f32::from_bits(bits);
            if length > self.length[at] {
                continue;
            }
            for &(next, edge) in &beside[at] {
                let way = length + edge;
                if way < self.length[next] {
                    (self.length[next], self.from[next]) = (way, self.from[at]);
                    open.push((Reverse(way.to_bits()), Reverse(next)));
                }
            }
        }
    }
}
