//! One line of several that go through a tree by turns. What a line waits for, its next node to come from memory and the
//! processor to find out which that is, the others use.

use super::node::Line;
use super::waiting::Waiting;
use super::{PAD, Sweep, Tree};
use sinew_math::Vec3;
use sinew_math::lanes::{Lanes, WIDTH};

/// A line, how far it counts, and what it has still to see.
pub struct Traversal {
    line: Line,
    /// Fraction beyond which nothing counts any more, ≥ 0.
    pub limit: f32,
    waiting: Waiting,
}

/// Next place on the way of a line.
pub enum Stop {
    /// A leaf that it may meet.
    Leaf(u32),
    /// A node, to be [entered](Traversal::enter).
    Node(u32),
    /// It has seen all.
    End,
}

impl Traversal {
    /// Has seen all.
    pub fn ended() -> Self {
        let line = Line::new(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, 0.0);
        Self { line, limit: 0.0, waiting: Waiting::NONE }
    }

    /// Sets out along another line.
    #[inline(always)]
    pub fn start(&mut self, tree: &Tree, sweep: &Sweep) {
        let Sweep { origin, direction, half_extents, limit } = *sweep;
        if let Some(root) = tree.root {
            self.line = Line::new(origin, direction, half_extents, limit);
            self.limit = limit;
            self.waiting.start(root);
        }
    }

    /// The nearest of what it has still to see.
    #[inline(always)]
    pub fn next_stop(&mut self) -> Stop {
        while let Some((key, child)) = self.waiting.pop() {
            if key > self.limit * (1.0 + PAD) || child.is_none() {
                continue;
            }
            return match child.get() {
                Ok(leaf) => Stop::Leaf(leaf),
                Err(node) => Stop::Node(node),
            };
        }
        Stop::End
    }

    /// Has those children of a node before it that it may meet.
    #[inline(always)]
    pub fn enter<L: Lanes>(&mut self, tree: &Tree, node: u32) {
        let node = &tree.nodes[node as usize];
        let mut enter = [0.0; WIDTH];
        let mask = node.entered::<L>(&self.line, self.limit, &mut enter);
        self.waiting.push_few(node, mask, &enter);
    }
}
