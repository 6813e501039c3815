//! Data for a renderer: matrices of a skin.

use sinew_math::Affine;

/// Returns the upper three rows of a matrix, row after row.
pub(super) fn rows(m: &Affine) -> [f32; 12] {
    let ([x, y, z], t) = ([m.linear.x_axis, m.linear.y_axis, m.linear.z_axis], m.translation);
    [x.x, y.x, z.x, t.x, x.y, y.y, z.y, t.y, x.z, y.z, z.z, t.z]
}
