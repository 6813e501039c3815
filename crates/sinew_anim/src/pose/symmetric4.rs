//! Symmetric 4×4 matrices; the exact mean of rotations is an eigenvector of one.

use super::quaternions::Quaternions;
use sinew_math::lanes::{Lanes, Vector3};

/// A symmetric 4×4 matrix per lane: rows of the upper triangle.
#[derive(Clone, Copy)]
pub(super) struct Symmetric4<L> {
    xx: L,
    xy: L,
    xz: L,
    xw: L,
    yy: L,
    yz: L,
    yw: L,
    zz: L,
    zw: L,
    ww: L,
}

impl<L: Lanes> Symmetric4<L> {
    /// Computes `weight q qᵀ`.
    #[inline(always)]
    pub(super) fn outer(q: Quaternions<L>, weight: L) -> Self {
        let (Vector3 { x, y, z }, w) = (q.v, q.w);
        let [a, b, c, d] = [x * weight, y * weight, z * weight, w * weight];
        Self {
            xx: a * x,
            xy: a * y,
            xz: a * z,
            xw: a * w,
            yy: b * y,
            yz: b * z,
            yw: b * w,
            zz: c * z,
            zw: c * w,
            ww: d * w,
        }
    }

    #[inline(always)]
    pub(super) fn plus(self, o: Self) -> Self {
        Self {
            xx: self.xx + o.xx,
            xy: self.xy + o.xy,
            xz: self.xz + o.xz,
            xw: self.xw + o.xw,
            yy: self.yy + o.yy,
            yz: self.yz + o.yz,
            yw: self.yw + o.yw,
            zz: self.zz + o.zz,
            zw: self.zw + o.zw,
            ww: self.ww + o.ww,
        }
    }

    /// Scales to trace 1, so that squares neither overflow nor vanish.
    #[inline(always)]
    pub(super) fn normalized(self) -> Self {
        let s = L::splat(1.0) / (self.xx + self.yy + (self.zz + self.ww));
        Self {
            xx: self.xx * s,
            xy: self.xy * s,
            xz: self.xz * s,
            xw: self.xw * s,
            yy: self.yy * s,
            yz: self.yz * s,
            yw: self.yw * s,
            zz: self.zz * s,
            zw: self.zw * s,
            ww: self.ww * s,
        }
    }

    #[inline(always)]
    pub(super) fn squared(self) -> Self {
        let Self { xx, xy, xz, xw, yy, yz, yw, zz, zw, ww } = self;
        Self {
            xx: xx * xx + xy * xy + (xz * xz + xw * xw),
            xy: xx * xy + xy * yy + (xz * yz + xw * yw),
            xz: xx * xz + xy * yz + (xz * zz + xw * zw),
            xw: xx * xw + xy * yw + (xz * zw + xw * ww),
            yy: xy * xy + yy * yy + (yz * yz + yw * yw),
            yz: xy * xz + yy * yz + (yz * zz + yw * zw),
            yw: xy * xw + yy * yw + (yz * zw + yw * ww),
            zz: xz * xz + yz * yz + (zz * zz + zw * zw),
            zw: xz * xw + yz * yw + (zz * zw + zw * ww),
            ww: xw * xw + yw * yw + (zw * zw + ww * ww),
        }
    }

    #[inline(always)]
    pub(super) fn times(self, q: Quaternions<L>) -> Quaternions<L> {
        let (Vector3 { x, y, z }, w) = (q.v, q.w);
        let v = Vector3::new(
            self.xx * x + self.xy * y + (self.xz * z + self.xw * w),
            self.xy * x + self.yy * y + (self.yz * z + self.yw * w),
            self.xz * x + self.yz * y + (self.zz * z + self.zw * w),
        );
        Quaternions { v, w: self.xw * x + self.yw * y + (self.zw * z + self.ww * w) }
    }
}
