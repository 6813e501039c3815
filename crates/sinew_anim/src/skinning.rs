//! Computes the vertices of a posed mesh, for pictures.

use crate::rig::{JointIdx, Primitive, Rig, Skin};
use sinew_math::{Affine, Mat3, Vec3, normalize_or};

/// Computes the matrix per skin slot from mesh space (bind pose, file units) to the space of `model`: joint × inverse
/// bind. `model` has one transform per joint of the rig. `palette` is cleared and gets one entry per joint of the
/// skin; it allocates only when it must grow.
///
/// # Panics
/// If a joint of the skin is not in `model`.
pub fn skin_palette(skin: &Skin, model: &[Affine], palette: &mut Vec<Affine>) {
    palette.clear();
    palette
        .extend(skin.joints.iter().zip(&skin.inverse_bind).map(|(&joint, inverse)| model[joint] * *inverse));
}

/// Computes positions and normals of one primitive under the model pose `model`: linear blend skinning, or rigid
/// motion with its joint if the mesh has no skin or the primitive no weights. `model` has one transform per joint of
/// the rig. Both buffers are cleared and get one entry per vertex, in the space and unit of `model`, normals of length
/// 1; `normals` stays empty if the primitive has none. Allocates a palette.
///
/// # Panics
/// If `mesh` or `primitive` is out of range, `model` is shorter than the rig, or a vertex refers to a slot that its
/// skin does not have.
pub fn skin_vertices(
    rig: &Rig,
    mesh: usize,
    primitive: usize,
    model: &[Affine],
    positions: &mut Vec<Vec3>,
    normals: &mut Vec<Vec3>,
) {
    positions.clear();
    normals.clear();
    let mesh = &rig.meshes[mesh];
    let primitive = &mesh.primitives[primitive];
    match mesh.skin.filter(|_| !primitive.joints.is_empty()) {
        Some(skin) => deform(primitive, &rig.skins[skin], model, positions, normals),
        None => carry(primitive, mesh.joint, model, positions, normals),
    }
}

fn carry(
    primitive: &Primitive,
    joint: JointIdx,
    model: &[Affine],
    positions: &mut Vec<Vec3>,
    normals: &mut Vec<Vec3>,
) {
    let place = &model[joint];
    let turn = normal_matrix(&place.linear);
    positions.extend(primitive.positions.iter().map(|&p| place.point(p)));
    normals.extend(primitive.normals.iter().map(|&n| normalize_or(turn * n, n)));
}

fn deform(
    primitive: &Primitive,
    skin: &Skin,
    model: &[Affine],
    positions: &mut Vec<Vec3>,
    normals: &mut Vec<Vec3>,
) {
    let mut palette = Vec::new();
    skin_palette(skin, model, &mut palette);
    for (i, &p) in primitive.positions.iter().enumerate() {
        let place = blended(&palette, primitive.joints[i], primitive.weights[i]);
        positions.push(place.point(p));
        if let Some(&n) = primitive.normals.get(i) {
            normals.push(normalize_or(normal_matrix(&place.linear) * n, n));
        }
    }
}

fn blended(palette: &[Affine], slots: [u16; 4], weights: [f32; 4]) -> Affine {
    let mut sum = Affine { linear: Mat3::ZERO, translation: Vec3::ZERO };
    for (slot, weight) in slots.into_iter().zip(weights) {
        if weight > 0.0 {
            let matrix = &palette[usize::from(slot)];
            sum.linear += matrix.linear * weight;
            sum.translation += matrix.translation * weight;
        }
    }
    sum
}

/// Returns the matrix for normals under a linear map, up to length: its cofactors (inverse transpose times
/// determinant), without the sign of the determinant, so that the outside of a mirrored part stays outside.
fn normal_matrix(m: &Mat3) -> Mat3 {
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    let sign = if x.dot(y.cross(z)) < 0.0 { -1.0 } else { 1.0 };
    Mat3::from_cols(y.cross(z) * sign, z.cross(x) * sign, x.cross(y) * sign)
}
