//! Interleaved traversal: traversals of several lines take turns, so that the processor works on other lines while one
//! waits for memory or a mispredicted branch.

use super::node::Line;
use super::waiting::Waiting;
use super::{PAD, Sweep, Tree};
use sinew_math::Vec3;
use sinew_math::lanes::{Lanes, WIDTH};

/// State of one line: its limit and its pending children.
pub struct Traversal {
    line: Line,
    /// Fraction beyond which hits are ignored, ≥ 0.
    pub limit: f32,
    waiting: Waiting,
}

/// Next item of a line.
pub enum Stop {
    /// A leaf that the line may hit.
    Leaf(u32),
    /// A node to [enter](Traversal::enter).
    Node(u32),
    /// The traversal is complete.
    End,
}

impl Traversal {
    /// Returns a traversal that is complete.
    pub fn ended() -> Self {
        let line = Line::new(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, 0.0);
        Self { line, limit: 0.0, waiting: Waiting::NONE }
    }

    /// Starts a new traversal, of a tree along a sweep.
    #[inline(always)]
    pub fn start(&mut self, tree: &Tree, sweep: &Sweep) {
        let Sweep { origin, direction, half_extents, limit } = *sweep;
        if let Some(root) = tree.root {
            self.line = Line::new(origin, direction, half_extents, limit);
            self.limit = limit;
            self.waiting.start(root);
        }
    }

    /// Pops the nearest pending child.
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

    /// Pushes the children of a node that the line may hit.
    #[inline(always)]
    pub fn enter<L: Lanes>(&mut self, tree: &Tree, node: u32) {
        let node = &tree.nodes[node as usize];
        let mut enter = [0.0; WIDTH];
        let mask = node.entered::<L>(&self.line, self.limit, &mut enter);
        self.waiting.push_few(node, mask, &enter);
    }
}
