//! Mapping of poses to bodies and back, on rigs with the peculiarities of real files.

use crate::actor::{in_centimetres_and_z_up, somewhere, walker};
use sinew_anim::{
    Joint, LocalTransform, Primitive, Rig, RigMesh, Wrap, analyze, local_to_model, rest_pose, sample,
};
use sinew_math::{Affine, Random, Rotation, Transform, Vec3};
use sinew_ragdoll::mapping::{Mapping, Physical};
use sinew_ragdoll::{BuildOptions, CharacterDef, build};
use sinew_scenes::mannequin::mannequin;

fn model_of(def: &CharacterDef, pose: &[LocalTransform]) -> Vec<Affine> {
    let mut model = Vec::new();
    local_to_model(&def.rig, pose, &Affine::IDENTITY, &mut model);
    model
}

fn walking(def: &CharacterDef, time: f32) -> Vec<LocalTransform> {
    let mut pose = def.rest().to_vec();
    sample(&def.motions().clips[0], &def.rig, time, Wrap::Loop, &mut pose);
    pose
}

/// Returns the largest distance between points 10 cm from each joint in the two poses, metres.
fn distance(def: &CharacterDef, a: &[LocalTransform], b: &[LocalTransform]) -> f32 {
    let to_metres = def.mapping().character_from_model();
    let (a, b) = (model_of(def, a), model_of(def, b));
    let mut worst = 0.0_f32;
    for (a, b) in a.iter().zip(&b) {
        // The reach is in the joint's own file units, so that its scale cancels.
        let reach = 0.1 / (to_metres.linear * a.linear).x_axis.length();
        for p in [Vec3::ZERO, Vec3::X * reach, Vec3::Y * reach, Vec3::Z * reach] {
            let gap = to_metres.vector(a.point(p) - b.point(p)).length();
            worst = if gap > worst { gap } else { worst };
        }
    }
    worst
}

/// Maps one pose to bodies and back, with another pose as the base.
fn round_trip(
    def: &CharacterDef,
    pose: &[LocalTransform],
    base: &[LocalTransform],
) -> (Vec<LocalTransform>, f32) {
    let mut bodies = Vec::new();
    def.mapping().bodies_from_model(&model_of(def, pose), somewhere(), &mut bodies);
    let mut physical = Physical::default();
    physical.rebase(def.mapping(), &def.rig, base);
    let mut back = base.to_vec();
    let stretch = physical.pose(def.mapping(), &def.rig, somewhere(), &bodies, &mut back);
    (back, stretch)
}

#[test]
fn pose_survives_the_round_trip_through_bodies() {
    for def in [walker(), in_centimetres_and_z_up()] {
        for k in 0..8 {
            let pose = walking(&def, 0.13 * k as f32);
            // The base is another pose, except for joints without a body.
            let mut base = walking(&def, 0.05);
            for (joint, local) in pose.iter().enumerate() {
                if def.ragdoll.bodies.iter().all(|body| body.joint != joint) {
                    base[joint] = *local;
                }
            }
            let (back, stretch) = round_trip(&def, &pose, &base);
            let gap = distance(&def, &pose, &back);
            assert!(gap < 1e-4, "pose {k}: {gap} m");
            assert!(stretch < 1e-4, "pose {k}: stretched by {stretch} m");
        }
    }
}

#[test]
fn joints_without_a_body_keep_their_local_pose() {
    let mut def = walker();
    // Hands without bodies keep their local pose on rotating forearms.
    let hand =
        def.rig.joints.iter().position(|joint| joint.name == "leftHand").expect("the character has hands");
    def.ragdoll.bodies.retain(|body| !body.role.contains("Hand"));
    let kept = def.ragdoll.bodies.len();
    def.ragdoll.joints.clear();
    let bind = model_of(&def, def.rest());
    let def = CharacterDef::new(def.rig, def.ragdoll, &bind);
    let mut random = Random::new(7);
    let bodies: Vec<_> = (0..kept).map(|_| Transform::new(random.in_cube(), random.rotation())).collect();
    let mut base = def.rest().to_vec();
    base[hand].rotation = Rotation::from_axis_angle(Vec3::X, 0.4);
    let mut physical = Physical::default();
    physical.rebase(def.mapping(), &def.rig, &base);
    let mut pose = base.clone();
    physical.pose(def.mapping(), &def.rig, Transform::IDENTITY, &bodies, &mut pose);
    assert_eq!(pose[hand], base[hand]);
}

#[test]
fn motion_of_nodes_above_the_pelvis_goes_into_the_pelvis() {
    for def in [walker(), in_centimetres_and_z_up()] {
        let mut pose = walking(&def, 0.2);
        let root = def.rig.joints.iter().position(|joint| joint.name == "mannequin").expect("it has a root");
        pose[root].rotation = Rotation::from_axis_angle(Vec3::Z, 0.8) * pose[root].rotation;
        pose[root].translation += Vec3::new(0.3, -0.2, 0.5);
        let mut flat = pose.clone();
        def.mapping().flatten(&def.rig, &mut flat);
        assert_eq!(flat[root], def.rest()[root]);
        let pelvis = def.ragdoll.bodies[0].joint;
        let (moved, flattened) = (model_of(&def, &pose), model_of(&def, &flat));
        for joint in pelvis..def.rig.joints.len() {
            let gap = def
                .mapping()
                .character_from_model()
                .vector(moved[joint].translation - flattened[joint].translation);
            assert!(gap.length() < 1e-4, "joint {joint}: {gap}");
        }
    }
}

#[test]
fn world_pose_is_independent_of_the_characters_frame() {
    for def in [walker(), in_centimetres_and_z_up()] {
        let pose = walking(&def, 0.4);
        let to = Transform::new(Vec3::new(-0.5, 0.3, 4.0), Rotation::from_axis_angle(Vec3::Y, -2.0));
        let mut moved = pose.clone();
        def.mapping().reframe(&mut moved, somewhere(), to);
        let (mut here, mut there) = (Vec::new(), Vec::new());
        def.mapping().bodies_from_model(&model_of(&def, &pose), somewhere(), &mut here);
        def.mapping().bodies_from_model(&model_of(&def, &moved), to, &mut there);
        for (a, b) in here.iter().zip(&there) {
            assert!((a.translation - b.translation).length() < 1e-4);
            assert!(a.rotation.angle_to(b.rotation) < 1e-3);
        }
    }
}

/// Body poses computed from a pose and from its model transforms are equal for any uniform joint scales.
#[test]
fn body_poses_agree_for_pose_and_model_transforms() {
    let mut random = Random::new(11);
    for def in [walker(), in_centimetres_and_z_up()] {
        let (mut frames, mut quick, mut slow) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..20 {
            let mut pose = walking(&def, 0.05 * k as f32);
            for local in &mut pose {
                local.rotation = local.rotation * Rotation::from_scaled_axis(random.in_cube());
                local.scale *= 0.9 + 0.2 * random.unit();
            }
            assert!(def.mapping().bodies_from_pose(&pose, somewhere(), &mut frames, &mut quick));
            def.mapping().bodies_from_model(&model_of(&def, &pose), somewhere(), &mut slow);
            assert_eq!(quick.len(), slow.len());
            for (quick, slow) in quick.iter().zip(&slow) {
                assert!((quick.translation - slow.translation).length() < 2e-5);
                assert!(quick.rotation.angle_to(slow.rotation) < 1e-3);
            }
            pose[def.ragdoll.bodies[0].joint].scale.x *= 1.1;
            assert!(!def.mapping().bodies_from_pose(&pose, somewhere(), &mut frames, &mut quick));
        }
    }
}

/// A mesh that is a child of the root beside the skeleton moves with its body, and with the character while clips play.
#[test]
fn an_object_beside_the_skeleton_goes_with_the_character() {
    let mut rig = mannequin().rig;
    let at = |rig: &Rig, name: &str| {
        rig.joints.iter().position(|joint| joint.name == name).expect("the joint exists")
    };
    let (root, head) = (rig.joints[at(&rig, "hips")].parent, at(&rig, "head"));
    let (mut model, rest) = (Vec::new(), rest_pose(&rig));
    local_to_model(&rig, &rest, &Affine::IDENTITY, &mut model);
    let place = model[root.expect("the rig has a root")].inverse().point(model[head].translation);
    let hat = rig.joints.len();
    let rest = LocalTransform { translation: place, ..LocalTransform::default() };
    rig.joints.push(Joint { name: "hat".into(), parent: root, rest, source: hat });
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|corner| corner * 0.1).to_vec();
    let indices = [0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2].to_vec();
    let primitive = Primitive { positions, indices, ..Primitive::default() };
    rig.meshes.push(RigMesh { name: String::new(), joint: hat, skin: None, primitives: vec![primitive] });
    let analysis = analyze(&rig).expect("the rig has a skin");
    let (ragdoll, _) = build(&rig, &analysis, &BuildOptions::default()).expect("the ragdoll can be built");
    let carrier = ragdoll.bodies.iter().find(|body| body.merged.contains(&hat) || body.joint == hat);
    assert!(carrier.is_some(), "no body carries the hat");
    let mapping = Mapping::new(&rig, &ragdoll, &analysis.bind_model);
    assert!(mapping.heads().any(|joint| joint == hat), "the hat must keep the file's position");
}
