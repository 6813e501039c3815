//! Stack of the nodes that a query has not visited yet.

use super::MOST_LEVELS;
use super::node::{Child, Node};
use sinew_math::lanes::WIDTH;

/// Capacity for pending children: all children of a node but one on each level. It is a power of two, so that a mask
/// keeps indices in range.
pub(super) const STACK: usize = ((WIDTH - 1) * MOST_LEVELS + 1).next_power_of_two();
pub(super) const MASK: usize = STACK - 1;

/// Pending children with their sort keys; the last one is visited next.
pub(super) struct Waiting {
    /// Entries: the bits of the key in the high half, the bits of the child in the low half. The bits of non-negative
    /// keys sort like the keys.
    children: [u64; STACK],
    count: usize,
}

impl Waiting {
    /// An empty stack.
    pub const NONE: Self = Self { children: [0; STACK], count: 0 };

    /// Creates a stack with only a root.
    #[inline(always)]
    pub fn new(root: u32) -> Self {
        let mut waiting = Self::NONE;
        waiting.start(root);
        waiting
    }

    /// Resets the stack to only a root.
    #[inline(always)]
    pub fn start(&mut self, root: u32) {
        self.children[0] = entry(0.0, Child::node(root));
        self.count = 1;
    }

    #[inline(always)]
    pub fn pop(&mut self) -> Option<(f32, Child)> {
        self.count = self.count.checked_sub(1)?;
        let entry = self.children[self.count & MASK];
        Some((f32::from_bits((entry >> 32) as u32), Child::from_bits(entry as u32)))
    }

    /// Pushes slots of a node so that the slot with the smallest key (≥ 0) is visited next.
    #[inline(always)]
    pub fn push(&mut self, node: &Node, mask: u8, keys: &[f32; WIDTH]) {
        let start = self.count;
        for (slot, child) in node.held(mask) {
            let mut next = entry(keys[slot], child);
            for at in start..self.count {
                let other = self.children[at & MASK];
                self.children[at & MASK] = u64::max(next, other);
                next = u64::min(next, other);
            }
            self.children[self.count & MASK] = next;
            self.count += 1;
        }
    }

    /// Pushes the slots of a mask. Up to two slots, the usual case, are pushed without a branch, because a branch would
    /// be mispredicted half of the time. Pushes empty slots too if they are in the mask.
    #[inline(always)]
    pub fn push_few(&mut self, node: &Node, mask: u8, keys: &[f32; WIDTH]) {
        let rest = mask & mask.wrapping_sub(1);
        if rest & rest.wrapping_sub(1) != 0 {
            return self.push(node, mask, keys);
        }
        let [a, b] = [mask, rest].map(|mask| {
            let slot = mask.trailing_zeros() as usize % WIDTH;
            entry(keys[slot], node.child(slot))
        });
        // If the mask has no second slot, its entry is 0, which sorts first and is beyond the count.
        let b = if rest != 0 { b } else { 0 };
        self.children[self.count & MASK] = u64::max(a, b);
        self.children[(self.count + 1) & MASK] = u64::min(a, b);
        self.count += usize::from(mask != 0) + usize::from(rest != 0);
    }
}

#[inline(always)]
fn entry(key: f32, child: Child) -> u64 {
    u64::from(key.to_bits()) << 32 | u64::from(child.bits())
}
