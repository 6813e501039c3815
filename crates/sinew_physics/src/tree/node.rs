//! A node: eight boxes side by side, and what each of them holds.

use crate::boxes::Aabb;
use sinew_math::lanes::{LaneMask, Lanes, WIDTH};
use sinew_math::{Vec3, max3};

/// Marks a child that is a leaf.
const LEAF: u32 = 1 << 31;
/// No child.
const NONE: u32 = u32::MAX;

/// What a slot of a node holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Child(u32);

impl Child {
    pub const NONE: Self = Self(NONE);

    pub fn node(index: u32) -> Self {
        debug_assert!(index < LEAF);
        Self(index)
    }

    pub fn leaf(leaf: u32) -> Self {
        debug_assert!(leaf < NONE - LEAF);
        Self(leaf | LEAF)
    }

    pub fn is_none(self) -> bool {
        self == Self::NONE
    }

    /// The number of a leaf, or else the index of a node.
    #[inline(always)]
    pub fn get(self) -> Result<u32, u32> {
        if self.0 & LEAF != 0 { Ok(self.0 & !LEAF) } else { Err(self.0) }
    }
}

/// Eight boxes, row by row, so that a query tries all of them at once. Seven times a register of eight lanes: no row
/// crosses a line of the cache.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub(super) struct Node {
    /// Lowest x, y, z, highest x, y, z.
    rows: [[f32; WIDTH]; 6],
    children: [Child; WIDTH],
}

/// Overlaps nothing.
const EMPTY: Aabb = Aabb { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

impl Node {
    pub const EMPTY: Self = Self {
        rows: [
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        children: [Child::NONE; WIDTH],
    };

    #[inline(always)]
    pub fn child(&self, slot: usize) -> Child {
        self.children[slot]
    }

    pub fn bounds(&self, slot: usize) -> Aabb {
        let at = |row: usize| self.rows[row][slot];
        Aabb { min: Vec3::new(at(0), at(1), at(2)), max: Vec3::new(at(3), at(4), at(5)) }
    }

    pub fn set_bounds(&mut self, slot: usize, bounds: &Aabb) {
        for axis in 0..3 {
            self.rows[axis][slot] = bounds.min[axis];
            self.rows[3 + axis][slot] = bounds.max[axis];
        }
    }

    pub fn set(&mut self, slot: usize, child: Child, bounds: &Aabb) {
        self.children[slot] = child;
        self.set_bounds(slot, bounds);
    }

    pub fn clear(&mut self, slot: usize) {
        self.set(slot, Child::NONE, &EMPTY);
    }

    /// Of all that it holds.
    pub fn total(&self) -> Aabb {
        (0..WIDTH).fold(EMPTY, |sum, slot| sum.merge(&self.bounds(slot)))
    }

    pub fn free_slot(&self) -> Option<usize> {
        self.children.iter().position(|child| child.is_none())
    }

    pub fn is_empty(&self) -> bool {
        self.children.iter().all(|child| child.is_none())
    }

    /// Slots that hold something.
    pub fn slots(&self) -> impl Iterator<Item = usize> {
        (0..WIDTH).filter(|&slot| !self.children[slot].is_none())
    }

    /// The slot whose box has to grow least to hold another, by its surface; of equals the one with the least surface.
    pub fn least_growth(&self, bounds: &Aabb) -> usize {
        let mut best = (f32::INFINITY, f32::INFINITY, 0);
        for slot in self.slots() {
            let own = self.bounds(slot);
            let area = half_area(&own);
            let cost = (half_area(&own.merge(bounds)) - area, area, slot);
            // What is infinite or NaN never wins: then it is the first.
            if (cost.0, cost.1) < (best.0, best.1) {
                best = cost;
            }
        }
        if self.children[best.2].is_none() { self.slots().next().unwrap_or(0) } else { best.2 }
    }

    /// Which boxes overlap another one: bit `k` for slot `k`.
    #[inline(always)]
    pub fn overlapping<L: Lanes>(&self, other: &[L; 6]) -> u8 {
        let [x, y, z, u, v, w] = &self.rows;
        let mask = L::le(L::load(x), other[3])
            & L::le(other[0], L::load(u))
            & L::le(L::load(y), other[4])
            & L::le(other[1], L::load(v))
            & L::le(L::load(z), other[5])
            & L::le(other[2], L::load(w));
        mask.bits()
    }

    /// Which boxes a line meets before `limit`, and where it enters each.
    #[inline(always)]
    pub fn entered<L: Lanes>(&self, line: &Line<L>, limit: f32, enter: &mut [f32; WIDTH]) -> u8 {
        let mut first = L::splat(0.0);
        let mut last = L::splat(f32::INFINITY);
        for axis in 0..3 {
            let near =
                (L::load(&self.rows[line.near_row[axis]]) - line.near_origin[axis]) * line.inverse[axis];
            let far = (L::load(&self.rows[line.far_row[axis]]) - line.far_origin[axis]) * line.inverse[axis];
            // NaN, where a line runs in a face, leaves what is there.
            first = L::max(near, first);
            last = L::min(far, last);
        }
        first.store(enter);
        (L::le(first, last * line.slack) & L::le(first, L::splat(limit) * line.slack)).bits()
    }

    /// Squares of the distances from a point to the boxes, as they are at least; bit `k` of the mask tells whether slot `k` is
    /// not farther than `limit`.
    #[inline(always)]
    pub fn distances<L: Lanes>(&self, point: &[L; 3], pad: L, limit: f32, squares: &mut [f32; WIDTH]) -> u8 {
        let zero = L::splat(0.0);
        let mut sum = zero;
        for axis in 0..3 {
            let (low, high) = (L::load(&self.rows[axis]), L::load(&self.rows[3 + axis]));
            let beyond = L::max(low - point[axis], point[axis] - high) - pad;
            let outside = L::max(beyond, zero);
            sum = sum + outside * outside;
        }
        sum.store(squares);
        // Beyond any limit: what is empty.
        (L::le(sum, L::splat(limit)) & L::lt(sum, L::splat(f32::INFINITY))).bits()
    }
}

/// Half the surface of a box: what the surface area heuristic counts with.
pub(super) fn half_area(bounds: &Aabb) -> f32 {
    let Vec3 { x, y, z } = max3(bounds.max - bounds.min, Vec3::ZERO);
    x * y + y * z + z * x
}

/// Share of the coordinates at hand by which boxes and lines are thicker than they are, so that what rounding does in an
/// exact test never brings a hit that the boxes leave out (as in Ize, "Robust BVH ray traversal", JCGT 2013, but for tests
/// whose error is that of the places, not of the boxes).
pub(crate) const PAD: f32 = 4e-6;

/// A stretch of a line, prepared: slabs (Kay & Kajiya 1986) of which the near and the far one are known beforehand.
pub(super) struct Line<L> {
    near_row: [usize; 3],
    far_row: [usize; 3],
    near_origin: [L; 3],
    far_origin: [L; 3],
    inverse: [L; 3],
    slack: L,
}

impl<L: Lanes> Line<L> {
    /// Of a box with these half extents that goes from `origin` along `direction`, at most `limit` times.
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3, half_extents: Vec3, limit: f32) -> Self {
        let far = origin.abs() + direction.abs() * limit + half_extents;
        let pad = PAD * sinew_math::max(far.x, sinew_math::max(far.y, far.z));
        let mut line = Self {
            near_row: [0, 1, 2],
            far_row: [3, 4, 5],
            near_origin: [L::splat(0.0); 3],
            far_origin: [L::splat(0.0); 3],
            inverse: [L::splat(f32::INFINITY); 3],
            slack: L::splat(1.0 + PAD),
        };
        for axis in 0..3 {
            let reach = half_extents[axis] + pad;
            let (low, high) = (origin[axis] - reach, origin[axis] + reach);
            let (mut near, mut far) = (high, low);
            if direction[axis] < 0.0 {
                (near, far) = (low, high);
                (line.near_row[axis], line.far_row[axis]) = (3 + axis, axis);
            }
            line.near_origin[axis] = L::splat(near);
            line.far_origin[axis] = L::splat(far);
            if direction[axis] != 0.0 {
                line.inverse[axis] = L::splat(1.0 / direction[axis]);
            }
        }
        line
    }
}
