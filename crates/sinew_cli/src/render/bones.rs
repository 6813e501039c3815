//! Draws a skeleton without a skin: an octahedron for each bone.

use sinew::anim::{JointIdx, Primitive, Rig, RigAnalysis, RigMesh, Skin, local_to_model, rest_pose};
use sinew::math::{Affine, Vec3};

/// Half the width of a bone, as a share of its length.
const WIDTH: f32 = 0.11;
/// Position of a bone's widest section, as a share of its length.
const WAIST: f32 = 0.2;
/// Distance below which joints coincide, as a share of the farthest joint's distance from the root.
const COINCIDENT: f32 = 0.005;
/// Colour of bones, linear RGBA.
const COLOR: [f32; 4] = [0.60, 0.55, 0.45, 1.0];

/// Adds a skin over all joints, and a mesh with a bone from each joint to each child. Binds it in the body's upright
/// pose, because many captures have an unusable rest pose.
pub fn add_bone_models(rig: &mut Rig, analysis: Option<&RigAnalysis>) {
    let mut model = Vec::new();
    match analysis {
        Some(analysis) => model.clone_from(&analysis.bind_model),
        None => local_to_model(rig, &rest_pose(rig), &Affine::IDENTITY, &mut model),
    }
    let mut bones = Primitive { base_color: COLOR, ..Primitive::default() };
    let carriers = carriers(rig, &model);
    for (joint, at) in rig.joints.iter().enumerate() {
        if let Some(parent) = at.parent
            && let Ok(slot) = u16::try_from(carriers[parent])
        {
            add_bone(&mut bones, slot, model[parent].translation, model[joint].translation);
        }
    }
    if bones.indices.is_empty() {
        return;
    }
    let joints: Vec<JointIdx> = (0..rig.joints.len()).collect();
    let inverse_bind = model.iter().map(Affine::inverse).collect();
    rig.skins.push(Skin { name: "bones".into(), joints, inverse_bind });
    let skin = Some(rig.skins.len() - 1);
    rig.meshes.push(RigMesh { name: "bones".into(), joint: 0, skin, primitives: vec![bones] });
}

/// Returns, for each joint, the joint to which its bones are skinned: for a joint that coincides with its parent (CMU
/// captures have eleven), that of the parent, else the joint itself.
fn carriers(rig: &Rig, model: &[Affine]) -> Vec<JointIdx> {
    let reach =
        |from: Vec3| model.iter().map(|joint| (joint.translation - from).length()).fold(0.0, f32::max);
    let near = COINCIDENT * model.first().map_or(0.0, |root| reach(root.translation));
    let mut carriers: Vec<JointIdx> = Vec::with_capacity(model.len());
    for (joint, at) in rig.joints.iter().enumerate() {
        let apart = |above: JointIdx| (model[joint].translation - model[above].translation).length();
        let above = at.parent.map(|parent| carriers[parent]).filter(|&above| apart(above) < near);
        carriers.push(above.unwrap_or(joint));
    }
    carriers
}

/// Adds eight triangles with separate corners for flat shading.
fn add_bone(bones: &mut Primitive, slot: u16, from: Vec3, to: Vec3) {
    let way = to - from;
    let length = way.length();
    if !(length > 1e-6 && length.is_finite()) {
        return;
    }
    let along = way / length;
    let side = along.any_orthonormal_vector() * (WIDTH * length);
    let other = along.cross(side);
    let middle = from + way * WAIST;
    let ring = [middle + side, middle + other, middle - side, middle - other];
    for k in 0..4 {
        let (a, b) = (ring[k], ring[(k + 1) % 4]);
        for corners in [[from, b, a], [to, a, b]] {
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
            for corner in corners {
                bones.indices.push(bones.positions.len() as u32);
                bones.positions.push(corner);
                bones.normals.push(normal);
                bones.joints.push([slot, 0, 0, 0]);
                bones.weights.push([1.0, 0.0, 0.0, 0.0]);
            }
        }
    }
}
