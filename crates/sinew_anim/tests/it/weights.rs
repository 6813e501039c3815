//! Tests of vertices without weights, and of skins whose weights are lost.

use crate::toy;
use sinew_anim::weights::{SkinPart, lost_weights, weigh_by_nearness, weigh_loose_vertices};
use sinew_anim::{Joint, LocalTransform, Rig, Role};
use sinew_math::{Affine, Vec3};

fn joint_named(role: &str) -> usize {
    toy::BODY.iter().position(|(name, ..)| *name == role).expect("a part of the toy")
}

fn body() -> Rig {
    toy::body(Role::name)
}

/// Adds a triangle around a point, weighted to a joint of the skin.
fn add_triangle(rig: &mut Rig, joint: usize, at: Vec3) -> [usize; 3] {
    let primitive = &mut rig.meshes[0].primitives[0];
    let first = primitive.positions.len();
    primitive.positions.extend([at, at + Vec3::X * 0.03, at + Vec3::Z * 0.03]);
    primitive.joints.extend([[u16::try_from(joint).expect("few"), 0, 0, 0]; 3]);
    primitive.weights.extend([[1.0, 0.0, 0.0, 0.0]; 3]);
    let corners = [first, first + 1, first + 2];
    primitive.indices.extend(corners.map(|corner| u32::try_from(corner).expect("few")));
    corners
}

/// Adds Blender's bone for unweighted vertices, as the last joint of the skin.
fn add_neutral_bone(rig: &mut Rig) -> usize {
    let joint = rig.joints.len();
    let rest = LocalTransform::default();
    rig.joints.push(Joint { name: "neutral_bone".into(), parent: None, rest, source: joint });
    rig.skins[0].joints.push(joint);
    rig.skins[0].inverse_bind.push(Affine::IDENTITY);
    joint
}

#[test]
fn hat_on_the_neutral_bone_follows_the_head() {
    let mut rig = body();
    let neutral = add_neutral_bone(&mut rig);
    let hat = add_triangle(&mut rig, neutral, Vec3::new(0.0, 1.85, 0.0));
    let buckle = add_triangle(&mut rig, neutral, Vec3::new(0.0, 0.97, 0.12));
    let before = rig.clone();
    let changed = weigh_loose_vertices(&mut rig, &[]);
    let vertices: Vec<usize> = hat.into_iter().chain(buckle).collect();
    assert_eq!(changed, [SkinPart { mesh: 0, primitive: 0, vertices }]);
    let primitive = &rig.meshes[0].primitives[0];
    for (piece, role) in [(hat, "head"), (buckle, "hips")] {
        for vertex in piece {
            assert_eq!(usize::from(primitive.joints[vertex][0]), joint_named(role), "{role}");
            assert_eq!(primitive.weights[vertex], [1.0, 0.0, 0.0, 0.0]);
        }
    }
    let untouched = hat[0];
    assert_eq!(primitive.joints[..untouched], before.meshes[0].primitives[0].joints[..untouched]);
    assert!(weigh_loose_vertices(&mut rig, &[]).is_empty(), "no vertex may remain unweighted");
}

#[test]
fn vertex_without_weights_follows_its_piece() {
    let mut rig = body();
    let hand = joint_named("leftHand");
    let primitive = &mut rig.meshes[0].primitives[0];
    // One corner of the hand's own tetrahedron, assigned to slot 0 by a reader.
    let corner = 4 * hand + 3;
    primitive.joints[corner] = [0; 4];
    let without = SkinPart { mesh: 0, primitive: 0, vertices: vec![corner] };
    assert_eq!(weigh_loose_vertices(&mut rig, core::slice::from_ref(&without)), [without]);
    assert_eq!(usize::from(rig.meshes[0].primitives[0].joints[corner][0]), hand);
}

#[test]
fn fully_unweighted_skin_is_unchanged() {
    let mut rig = body();
    let neutral = u16::try_from(add_neutral_bone(&mut rig)).expect("few");
    rig.meshes[0].primitives[0].joints.fill([neutral, 0, 0, 0]);
    let before = rig.clone();
    assert!(weigh_loose_vertices(&mut rig, &[]).is_empty());
    assert_eq!(rig, before);
}

#[test]
fn lost_weights_are_restored_by_distance() {
    let mut rig = body();
    rig.meshes[0].primitives[0].joints.fill([3, 0, 0, 0]);
    assert_eq!(lost_weights(&rig), Some(3));
    let changed = weigh_by_nearness(&mut rig);
    assert_eq!(changed.len(), 1);
    assert_eq!(lost_weights(&rig), None);
    let primitive = &rig.meshes[0].primitives[0];
    for (vertex, (slots, weights)) in primitive.joints.iter().zip(&primitive.weights).enumerate() {
        assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6, "weights of vertex {vertex}: {weights:?}");
        // A vertex is near its own joint, where the parent's bone ends and its own bone begins.
        let own = vertex / 4;
        let near = [Some(own), rig.joints[own].parent];
        let most = slots.iter().zip(weights).max_by(|a, b| a.1.total_cmp(b.1)).expect("four");
        let is_near = near.contains(&Some(usize::from(*most.0)))
            || rig.joints[usize::from(*most.0)].parent == Some(own);
        assert!(
            is_near,
            "vertex {vertex} of mesh {} is weighted to {}",
            toy::BODY[own].0,
            toy::BODY[usize::from(*most.0)].0
        );
        for (&slot, _) in slots.iter().zip(weights).filter(|(_, weight)| **weight > 0.05) {
            let is_left = |joint: usize| toy::BODY[joint].0.starts_with("left");
            let is_right = |joint: usize| toy::BODY[joint].0.starts_with("right");
            assert!(
                !(is_left(own) && is_right(usize::from(slot))),
                "vertex {vertex} is weighted to a joint of the other side"
            );
        }
    }
}
