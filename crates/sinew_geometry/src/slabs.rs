//! Lines through boxes, one at a time or eight: slabs (Kay & Kajiya, "Ray tracing complex scenes", SIGGRAPH 1986).

use sinew_math::lanes::{Real, Vector3};

/// A line and the three slabs that a box is the intersection of, in the box's frame.
pub struct Slabs<R: Real> {
    /// Fraction at which the line has entered all slabs that it does not run along.
    pub enter: R,
    /// Fraction at which it leaves the first of them.
    leave: R,
    /// True if it runs along a slab, outside of it.
    beside: R::Mask,
    /// Fraction at which it enters each slab, and from which side.
    each: [(R, R); 3],
}

impl<R: Real> Slabs<R> {
    /// Slabs of the box with these half extents around the origin.
    #[inline(always)]
    pub fn new(half_extents: Vector3<R>, origin: Vector3<R>, direction: Vector3<R>) -> Self {
        let (half, origin, way) = (half_extents.to_array(), origin.to_array(), direction.to_array());
        let zero = R::splat(0.0);
        let (never, ever) = (R::splat(f32::INFINITY), R::splat(f32::NEG_INFINITY));
        let mut slabs =
            Self { enter: ever, leave: never, beside: R::lt(zero, zero), each: [(ever, zero); 3] };
        for k in 0..3 {
            let along = R::eq(way[k], zero);
            let side = R::select(R::gt(way[k], zero), R::splat(-1.0), R::splat(1.0));
            let face = side * half[k];
            let near = R::select(along, ever, (face - origin[k]) / way[k]);
            let far = R::select(along, never, (-face - origin[k]) / way[k]);
            slabs.enter = R::max(near, slabs.enter);
            slabs.leave = R::min(far, slabs.leave);
            slabs.beside = slabs.beside | (along & R::gt(origin[k].abs(), half[k]));
            slabs.each[k] = (near, side);
        }
        slabs
    }

    /// True if the line enters the box, at its start or later.
    #[inline(always)]
    pub fn is_entered(&self) -> R::Mask {
        R::le(self.enter, self.leave) & R::ge(self.enter, R::splat(0.0)) & !self.beside
    }

    /// Normal of the entry face, unit, in the box's frame; the first of several.
    #[inline(always)]
    pub fn normal(&self) -> Vector3<R> {
        let zero = R::splat(0.0);
        let [(x, x_side), (y, y_side), (z, z_side)] = self.each;
        let (by_x, by_y, by_z) = (R::eq(x, self.enter), R::eq(y, self.enter), R::eq(z, self.enter));
        Vector3::new(
            R::select(by_x, x_side, zero),
            R::select(by_y & !by_x, y_side, zero),
            R::select(by_z & !by_x & !by_y, z_side, zero),
        )
    }
}
