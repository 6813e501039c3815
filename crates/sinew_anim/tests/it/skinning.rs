use crate::toy;
use sinew_anim::{LocalTransform, Primitive, Rig, RigMesh, Skin, local_to_model, rest_pose, skin_vertices};
use sinew_math::{Affine, Rotation, Vec3};
use std::f32::consts::FRAC_PI_2;

/// Returns two joints along x, three vertices weighted 1:0, 1:1 and 0:1, and a rigid copy on the second joint.
fn bar() -> Rig {
    let mut rig = toy::chain(2, Vec3::X);
    let positions = vec![Vec3::new(1.0, 0.1, 0.0), Vec3::new(2.0, 0.1, 0.0), Vec3::new(3.0, 0.1, 0.0)];
    let skinned = Primitive {
        normals: vec![Vec3::Y; 3],
        joints: vec![[0, 1, 0, 0]; 3],
        weights: vec![[1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]],
        positions,
        ..Primitive::default()
    };
    let rigid = Primitive { joints: vec![], weights: vec![], ..skinned.clone() };
    let mesh = |skin, primitive| RigMesh { name: String::new(), joint: 1, skin, primitives: vec![primitive] };
    rig.meshes = vec![mesh(Some(0), skinned), mesh(None, rigid)];
    let inverse_bind = vec![
        Affine { translation: -Vec3::X, ..Affine::IDENTITY },
        Affine { translation: -Vec3::X * 2.0, ..Affine::IDENTITY },
    ];
    rig.skins = vec![Skin { name: String::new(), joints: vec![0, 1], inverse_bind }];
    rig
}

fn posed(rig: &Rig, local: &[LocalTransform], mesh: usize) -> (Vec<Vec3>, Vec<Vec3>) {
    let (mut model, mut positions, mut normals) = (Vec::new(), Vec::new(), Vec::new());
    local_to_model(rig, local, &Affine::IDENTITY, &mut model);
    skin_vertices(rig, mesh, 0, &model, &mut positions, &mut normals);
    (positions, normals)
}

#[test]
fn bind_pose_leaves_a_skinned_mesh_unchanged() {
    let rig = bar();
    let (positions, normals) = posed(&rig, &rest_pose(&rig), 0);
    for (got, expected) in positions.iter().zip(&rig.meshes[0].primitives[0].positions) {
        assert!((*got - *expected).length() < 1e-6);
    }
    assert!(normals.iter().all(|n| (*n - Vec3::Y).length() < 1e-6));
}

#[test]
fn bent_joint_moves_vertices_by_their_weights() {
    let rig = bar();
    let mut local = rest_pose(&rig);
    local[1].rotation = Rotation::from_axis_angle(Vec3::Z, FRAC_PI_2);
    let (positions, normals) = posed(&rig, &local, 0);
    // The joint at (2, 0, 0) rotates by a quarter turn: (3, 0.1) moves to (2 − 0.1, 1), (2, 0.1) to (1.9, 0).
    let expected = [Vec3::new(1.0, 0.1, 0.0), Vec3::new(1.95, 0.05, 0.0), Vec3::new(1.9, 1.0, 0.0)];
    for (got, expected) in positions.iter().zip(expected) {
        assert!((*got - expected).length() < 1e-6, "{got} for {expected}");
    }
    let diagonal = Vec3::new(-1.0, 1.0, 0.0).normalize();
    for (got, expected) in normals.iter().zip([Vec3::Y, diagonal, -Vec3::X]) {
        assert!((*got - expected).length() < 1e-6, "{got} for {expected}");
    }
}

#[test]
fn rigid_mesh_follows_its_joint_with_correct_normals() {
    let rig = bar();
    let mut local = rest_pose(&rig);
    local[1].rotation = Rotation::from_axis_angle(Vec3::Z, FRAC_PI_2);
    local[1].scale = Vec3::new(1.0, -0.5, 1.0);
    let (positions, normals) = posed(&rig, &local, 1);
    // Point (1, 0.1) in the joint's space, scaled and mirrored to (1, −0.05), rotated to (0.05, 1), translated by 2.
    assert!((positions[0] - Vec3::new(2.05, 1.0, 0.0)).length() < 1e-6, "{}", positions[0]);
    assert!((normals[0] - Vec3::X).length() < 1e-6, "{}", normals[0]);
}
