//! A box in the form that batches store: centre, rotation, half extents.

use crate::boxes::Obb;
use sinew_math::lanes::{Lanes, Real, Vector3, WIDTH};

/// Number of values in a [`Record`].
pub const NUMBERS: usize = 10;

/// A box as numbers, or one box per SIMD lane; metres.
#[derive(Clone, Copy)]
pub struct Record<R> {
    /// Centre.
    pub center: Vector3<R>,
    /// Coefficients of i, j and k of the rotation's quaternion.
    pub vector: Vector3<R>,
    /// Scalar part of the rotation.
    pub w: R,
    /// Half extents.
    pub half: Vector3<R>,
}

impl Record<f32> {
    /// Returns the record of one box.
    #[inline]
    pub fn of(obb: &Obb) -> Self {
        let q = obb.rotation;
        Self { center: obb.center.into(), vector: q.vector().into(), w: q.w, half: obb.half_extents.into() }
    }

    /// Returns the numbers in the order of the rows of a block.
    #[inline]
    pub fn to_array(self) -> [f32; NUMBERS] {
        let ([cx, cy, cz], [x, y, z]) = (self.center.to_array(), self.vector.to_array());
        let [hx, hy, hz] = self.half.to_array();
        [cx, cy, cz, x, y, z, self.w, hx, hy, hz]
    }
}

impl<L: Lanes> Record<L> {
    /// Loads the numbers from the rows of a block.
    #[inline(always)]
    pub fn load(rows: [&[f32; WIDTH]; NUMBERS]) -> Self {
        let [cx, cy, cz, x, y, z, w, hx, hy, hz] = rows;
        Self {
            center: Vector3::load(cx, cy, cz),
            vector: Vector3::load(x, y, z),
            w: L::load(w),
            half: Vector3::load(hx, hy, hz),
        }
    }
}

impl<R: Real> Record<R> {
    /// Converts a direction to the box's frame, with the same bits as `Rotation` computes.
    #[inline(always)]
    pub fn inverse_vector(&self, direction: Vector3<R>) -> Vector3<R> {
        let back = -self.vector;
        let t = back.cross(direction) * R::splat(2.0);
        direction + t * self.w + back.cross(t)
    }

    /// Converts a point to the box's frame, with the same bits as `Transform::inverse_point`.
    #[inline(always)]
    pub fn inverse_point(&self, point: Vector3<R>) -> Vector3<R> {
        self.inverse_vector(point - self.center)
    }

    /// Unit vectors along the box's axes.
    #[inline(always)]
    pub fn axes(&self) -> [Vector3<R>; 3] {
        let [x, y, z] = matrix(self.vector, self.w);
        [Vector3::new(x[0], y[0], z[0]), Vector3::new(x[1], y[1], z[1]), Vector3::new(x[2], y[2], z[2])]
    }
}

/// Returns the rows of a rotation's matrix, with the same bits as `Rotation::to_mat3`.
#[inline(always)]
pub(super) fn matrix<R: Real>(vector: Vector3<R>, w: R) -> [[R; 3]; 3] {
    let Vector3 { x, y, z } = vector;
    let one = R::splat(1.0);
    // Doubling is exact, so doubling a factor gives the same bits as doubling the product.
    let (x2, y2, z2) = (x + x, y + y, z + z);
    let (xx, yy, zz) = (x * x2, y * y2, z * z2);
    let (xy, xz, yz) = (x * y2, x * z2, y * z2);
    let (wx, wy, wz) = (w * x2, w * y2, w * z2);
    [
        [one - (yy + zz), xy - wz, xz + wy],
        [xy + wz, one - (xx + zz), yz - wx],
        [xz - wy, yz + wx, one - (xx + yy)],
    ]
}
