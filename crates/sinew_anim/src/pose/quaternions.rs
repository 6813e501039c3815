//! Quaternions with one value per lane.

use super::soa::{ROTATION, ROWS};
use sinew_math::lanes::{Block, Lanes, Vector3};

/// A quaternion per lane. Sums use the order of additions of `Rotation`.
#[derive(Clone, Copy)]
pub(crate) struct Quaternions<L> {
    pub v: Vector3<L>,
    pub w: L,
}

impl<L: Lanes> Quaternions<L> {
    #[inline(always)]
    pub(crate) fn zero() -> Self {
        let zero = L::splat(0.0);
        Self { v: Vector3::new(zero, zero, zero), w: zero }
    }

    /// Loads the rotations of a block of joints.
    #[inline(always)]
    pub(crate) fn load(block: &Block<ROWS>) -> Self {
        let rows = &block.0;
        let v = Vector3::load(&rows[ROTATION], &rows[ROTATION + 1], &rows[ROTATION + 2]);
        Self { v, w: L::load(&rows[ROTATION + 3]) }
    }

    #[inline(always)]
    pub(crate) fn store(self, block: &mut Block<ROWS>) {
        self.v.x.store(&mut block.0[ROTATION]);
        self.v.y.store(&mut block.0[ROTATION + 1]);
        self.v.z.store(&mut block.0[ROTATION + 2]);
        self.w.store(&mut block.0[ROTATION + 3]);
    }

    #[inline(always)]
    pub(crate) fn plus(self, other: Self) -> Self {
        Self { v: self.v + other.v, w: self.w + other.w }
    }

    #[inline(always)]
    pub(crate) fn minus(self, other: Self) -> Self {
        Self { v: self.v - other.v, w: self.w - other.w }
    }

    #[inline(always)]
    pub(crate) fn times(self, factor: L) -> Self {
        Self { v: self.v * factor, w: self.w * factor }
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> L {
        self.v.x * other.v.x + self.v.y * other.v.y + (self.v.z * other.v.z + self.w * other.w)
    }

    /// Returns `a` where the mask is true, `b` where it is false.
    #[inline(always)]
    pub(crate) fn select(mask: L::Mask, a: Self, b: Self) -> Self {
        let v = Vector3::new(
            L::select(mask, a.v.x, b.v.x),
            L::select(mask, a.v.y, b.v.y),
            L::select(mask, a.v.z, b.v.z),
        );
        Self { v, w: L::select(mask, a.w, b.w) }
    }

    /// Chooses the sign of each quaternion on the hemisphere of `reference`.
    #[inline(always)]
    pub(crate) fn toward(self, reference: Self) -> Self {
        let away = L::lt(self.dot(reference), L::splat(0.0));
        Self::select(away, Self { v: -self.v, w: -self.w }, self)
    }

    /// Scales to length 1; `square` is the squared length, above zero.
    #[inline(always)]
    pub(crate) fn unit(self, square: L) -> Self {
        self.times(L::splat(1.0) / square.sqrt())
    }

    /// Hamilton's product: the rotation `other`, then `self`.
    #[inline(always)]
    pub(crate) fn after(self, other: Self) -> Self {
        let (a, b) = (self, other);
        let (p, q) = (a.v, b.v);
        let v = Vector3::new(
            a.w * q.x + p.x * b.w + (p.y * q.z - p.z * q.y),
            a.w * q.y + p.y * b.w + (p.z * q.x - p.x * q.z),
            a.w * q.z + p.z * b.w + (p.x * q.y - p.y * q.x),
        );
        Self { v, w: a.w * b.w - p.x * q.x - (p.y * q.y + p.z * q.z) }
    }
}
