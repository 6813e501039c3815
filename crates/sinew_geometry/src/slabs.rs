//! Slab test of a line and a box, for one or eight boxes at a time (Kay & Kajiya, "Ray tracing complex scenes",
//! SIGGRAPH 1986).

use sinew_math::lanes::{Real, Vector3};

/// Intersection of a line with the three slabs of a box, in the box's frame. A slab is the space between two opposite
/// faces.
pub struct Slabs<R: Real> {
    /// Fraction of the line at which it enters the last of the slabs to which it is not parallel.
    pub enter: R,
    /// Fraction of the line at which it leaves the first of these slabs.
    leave: R,
    /// True if the line is parallel to a slab and outside it.
    beside: R::Mask,
    /// Fraction at which the line enters each slab, and the sign of the face that it enters.
    each: [(R, R); 3],
}

impl<R: Real> Slabs<R> {
    /// Computes the slabs of the box with these half extents around the origin.
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

    /// Unit normal of the entry face, in the box's frame; the first if there are several.
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
