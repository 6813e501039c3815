//! A tree node: eight boxes, stored for SIMD, and their children.

use crate::boxes::Aabb;
use sinew_math::lanes::{LaneMask, Lanes, WIDTH};
use sinew_math::{Vec3, max3};

/// Bit that marks a leaf.
const LEAF: u32 = 1 << 31;
/// Value of an empty slot.
const NONE: u32 = u32::MAX;

/// Content of a slot of a node: a leaf, a node or nothing.
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

    /// Returns the child as a number, for [`from_bits`](Self::from_bits).
    #[inline(always)]
    pub fn bits(self) -> u32 {
        self.0
    }

    #[inline(always)]
    pub fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    #[inline(always)]
    pub fn is_none(self) -> bool {
        self == Self::NONE
    }

    /// Returns the number of a leaf, or the index of a node as the error.
    #[inline(always)]
    pub fn get(self) -> Result<u32, u32> {
        if self.0 & LEAF != 0 { Ok(self.0 & !LEAF) } else { Err(self.0) }
    }
}

/// Eight boxes stored row by row, so that a query tests all of them together, and their children. A node fills seven
/// rows of eight lanes; no row crosses a cache line.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub(super) struct Node {
    /// Lowest x, y and z, then highest x, y and z, metres.
    rows: [[f32; WIDTH]; 6],
    children: [Child; WIDTH],
}

/// Bounds that overlap nothing.
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

    /// Bounds of all children of the node.
    pub fn total(&self) -> Aabb {
        (0..WIDTH).fold(EMPTY, |sum, slot| sum.merge(&self.bounds(slot)))
    }

    pub fn free_slot(&self) -> Option<usize> {
        self.children.iter().position(|child| child.is_none())
    }

    pub fn is_empty(&self) -> bool {
        self.children.iter().all(|child| child.is_none())
    }

    /// Returns the slot whose box must grow least in surface area to contain another box; among equals, the slot whose
    /// box has the least surface area.
    #[inline(always)]
    pub fn least_growth<L: Lanes>(&self, other: &[L; 6]) -> usize {
        let mut low = [L::splat(0.0); 3];
        let mut sides = [L::splat(0.0); 3];
        let mut grown = [L::splat(0.0); 3];
        for axis in 0..3 {
            let high = L::load(&self.rows[3 + axis]);
            low[axis] = L::load(&self.rows[axis]);
            sides[axis] = high - low[axis];
            grown[axis] = L::max(high, other[3 + axis]) - L::min(low[axis], other[axis]);
        }
        let area = half_area_of(&sides);
        let is_empty = L::lt(sides[0], L::splat(0.0));
        let growth = L::select(is_empty, L::splat(f32::INFINITY), half_area_of(&grown) - area);
        let (mut growths, mut areas) = ([0.0; WIDTH], [0.0; WIDTH]);
        growth.store(&mut growths);
        area.store(&mut areas);
        let mut best = None;
        for slot in 0..WIDTH {
            let key = (growths[slot], areas[slot]);
            if best.is_none_or(|(_, least)| key < least) && !self.children[slot].is_none() {
                best = Some((slot, key));
            }
        }
        best.map_or(0, |(slot, _)| slot)
    }

    /// Iterates over the children in the slots of a mask, lowest slot first. Skips empty slots, which may be in the
    /// mask because infinite bounds and overflowing sums match them.
    #[inline(always)]
    pub fn held(&self, mut mask: u8) -> impl Iterator<Item = (usize, Child)> {
        let next_slot = move || {
            let slot = mask.trailing_zeros() as usize;
            mask &= mask.wrapping_sub(1);
            (slot < WIDTH).then_some(slot)
        };
        let children = core::iter::from_fn(next_slot).map(|slot| (slot, self.children[slot]));
        children.filter(|(_, child)| !child.is_none())
    }

    /// Returns the mask of the boxes that overlap another box: bit `k` for slot `k`. Bits of empty slots are undefined:
    /// see [`held`](Self::held).
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

    /// Returns the mask of the boxes that a line enters before `limit`, and writes the entry fractions; bits of empty
    /// slots are undefined, as in [`overlapping`](Self::overlapping).
    #[inline(always)]
    pub fn entered<L: Lanes>(&self, line: &Line, limit: f32, enter: &mut [f32; WIDTH]) -> u8 {
        let slack = L::splat(1.0 + PAD);
        let mut first = L::splat(0.0);
        let mut last = L::splat(f32::INFINITY);
        for axis in 0..3 {
            let inverse = L::splat(line.inverse[axis]);
            // A line in the plane of a face gives NaN, which leaves the value unchanged.
            first = L::max(self.beyond::<L>(&line.near, axis) * inverse, first);
            last = L::min(self.beyond::<L>(&line.far, axis) * inverse, last);
        }
        first.store(enter);
        (L::le(first, last * slack) & L::le(first, L::splat(limit) * slack)).bits()
    }

    /// Distances from the start of a line to faces along an axis, metres.
    #[inline(always)]
    fn beyond<L: Lanes>(&self, faces: &Faces, axis: usize) -> L {
        L::load(&self.rows[faces.row[axis]]) - L::splat(faces.origin[axis])
    }

    /// Writes lower bounds of the squared distances from a point to the boxes. Returns a mask with bit `k` set if slot
    /// `k` is within `limit`; bits of empty slots are undefined, as in [`overlapping`](Self::overlapping).
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
        L::le(sum, L::splat(limit)).bits()
    }
}

/// Half the surface area of a box, m²: the cost measure of the surface area heuristic.
pub(super) fn half_area(bounds: &Aabb) -> f32 {
    let Vec3 { x, y, z } = max3(bounds.max - bounds.min, Vec3::ZERO);
    x * y + y * z + z * x
}

/// Like [`half_area`], in each SIMD lane, for boxes with these sides.
#[inline(always)]
fn half_area_of<L: Lanes>([x, y, z]: &[L; 3]) -> L {
    *x * *y + *y * *z + *z * *x
}

/// Relative widening of boxes and lines. It exceeds the rounding error of the exact tests, so that a query never skips
/// a leaf that its exact test would hit (compare Ize, "Robust BVH ray traversal", JCGT 2013, where only the rounding of
/// the box test counts).
pub const PAD: f32 = 4e-6;

/// A line prepared for the slab test (Kay & Kajiya 1986), with known near and far faces.
pub(super) struct Line {
    near: Faces,
    far: Faces,
    inverse: [f32; 3],
}

/// Near or far faces of boxes, along each axis.
struct Faces {
    /// For each axis, the index of the node's row that holds these faces.
    row: [usize; 3],
    /// Start of the line, shifted by the half extents of the swept box and by rounding.
    origin: [f32; 3],
}

impl Line {
    /// Prepares the path of a box with these half extents from `origin` along `limit` times `direction`.
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3, half_extents: Vec3, limit: f32) -> Self {
        let end = origin.abs() + direction.abs() * limit + half_extents;
        let pad = PAD * sinew_math::max(end.x, sinew_math::max(end.y, end.z));
        let reach = half_extents + Vec3::splat(pad);
        let mut near = Faces { row: [0, 1, 2], origin: (origin + reach).to_array() };
        let mut far = Faces { row: [3, 4, 5], origin: (origin - reach).to_array() };
        let mut inverse = [f32::INFINITY; 3];
        for axis in 0..3 {
            if direction[axis] < 0.0 {
                core::mem::swap(&mut near.row[axis], &mut far.row[axis]);
                core::mem::swap(&mut near.origin[axis], &mut far.origin[axis]);
            }
            if direction[axis] != 0.0 {
                inverse[axis] = 1.0 / direction[axis];
            }
        }
        Self { near, far, inverse }
    }
}
