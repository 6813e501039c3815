//! Humans whose names are plain and whose hierarchy or skin leaves something out.

use crate::toy;
use sinew_anim::skinning::lost_weights;
use sinew_anim::{
    Joint, LocalTransform, Primitive, Rig, RigAnalysis, RigMesh, Role, Side, Skin, analyze, characters,
};
use sinew_math::{Affine, Vec3};

/// Names of Mixamo for the parts of the toy.
fn mixamo(role: Role) -> String {
    let side = |side: Side| if side == Side::Left { "Left" } else { "Right" };
    let name = match role {
        Role::Hips => "Hips".to_owned(),
        Role::Spine => "Spine".to_owned(),
        Role::Chest => "Spine1".to_owned(),
        Role::Neck => "Neck".to_owned(),
        Role::Head => "Head".to_owned(),
        Role::UpperArm(s) => format!("{}Arm", side(s)),
        Role::LowerArm(s) => format!("{}ForeArm", side(s)),
        Role::Hand(s) => format!("{}Hand", side(s)),
        Role::UpperLeg(s) => format!("{}UpLeg", side(s)),
        Role::LowerLeg(s) => format!("{}Leg", side(s)),
        Role::Foot(s) => format!("{}Foot", side(s)),
        other => other.name(),
    };
    format!("mixamorig:{name}")
}

fn part(role: &str) -> usize {
    toy::BODY.iter().position(|(name, ..)| *name == role).expect("a part of the toy")
}

/// Gives the skin of one joint to another.
fn give_skin(rig: &mut Rig, from: usize, to: usize) {
    let slot = |joint: usize| u16::try_from(joint).expect("few");
    for slots in &mut rig.meshes[0].primitives[0].joints {
        if slots[0] == slot(from) {
            slots[0] = slot(to);
        }
    }
}

/// Every part of the toy that is there has its role, and a body that hangs on what anatomy says.
fn is_whole(rig: &Rig, missing: &[&str]) -> RigAnalysis {
    let found = analyze(rig).expect("a skin");
    assert!(found.humanoid, "{:?}", found.notes);
    for (name, parent, _) in toy::BODY.iter().filter(|(name, ..)| !missing.contains(name)) {
        let role = Role::from_name(name).expect("a VRM name");
        let joint = found.joint_with(role).unwrap_or_else(|| panic!("{name}: no role; {:?}", found.notes));
        assert_eq!(rig.joints[joint].name, mixamo(role), "{name}");
        let bone = found.kept_with(role).unwrap_or_else(|| panic!("{name}: no body"));
        if !parent.is_empty() && !missing.contains(parent) {
            let above = found.kept[bone].parent.map(|above| found.kept[above].role.name());
            assert_eq!(above.as_deref(), Some(*parent), "{name} hangs on something else");
        }
    }
    found
}

#[test]
fn limb_bones_without_skin_keep_their_role_and_a_body() {
    for bare in [
        vec![("leftUpperLeg", "hips")],
        vec![("leftUpperLeg", "hips"), ("rightUpperLeg", "hips")],
        vec![("leftLowerLeg", "leftUpperLeg")],
        vec![("rightUpperArm", "chest")],
        vec![("leftUpperArm", "chest"), ("leftLowerArm", "chest"), ("rightUpperLeg", "rightLowerLeg")],
    ] {
        let mut rig = toy::body(mixamo);
        for (from, to) in &bare {
            give_skin(&mut rig, part(from), part(to));
        }
        is_whole(&rig, &[]);
    }
}

#[test]
fn parts_that_are_roots_of_their_own_are_put_together_by_name() {
    let strays: [&[&str]; 3] = [
        &["leftUpperLeg", "rightUpperLeg", "leftUpperArm", "rightUpperArm"],
        &["spine", "neck", "head", "leftFoot", "rightHand"],
        &[
            "spine",
            "chest",
            "neck",
            "head",
            "leftUpperArm",
            "leftLowerArm",
            "leftHand",
            "rightUpperArm",
            "rightLowerArm",
            "rightHand",
            "leftUpperLeg",
            "leftLowerLeg",
            "leftFoot",
            "rightUpperLeg",
            "rightLowerLeg",
            "rightFoot",
        ],
    ];
    for strays in strays {
        let mut rig = toy::body(mixamo);
        for stray in strays {
            let joint = part(stray);
            rig.joints[joint].parent = None;
            rig.joints[joint].rest.translation = Vec3::from_array(toy::BODY[joint].2);
        }
        is_whole(&rig, &[]);
    }
}

#[test]
fn rigid_meshes_are_the_skin_of_parts_that_have_none() {
    let mut rig = toy::body(mixamo);
    let rigid = ["leftUpperArm", "rightUpperArm", "leftUpperLeg", "rightUpperLeg", "chest", "head"];
    for joint in rigid.map(part) {
        let skinned = &mut rig.meshes[0].primitives[0];
        let place = Vec3::from_array(toy::BODY[joint].2);
        let own = skinned.positions[4 * joint..4 * joint + 4].iter().map(|&at| at - place).collect();
        let indices = [0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2].to_vec();
        let primitive = Primitive { positions: own, indices, ..Primitive::default() };
        rig.meshes.push(RigMesh { name: String::new(), joint, skin: None, primitives: vec![primitive] });
        give_skin(&mut rig, joint, part("hips"));
        for corner in 4 * joint..4 * joint + 4 {
            rig.meshes[0].primitives[0].positions[corner] = Vec3::from_array(toy::BODY[0].2);
        }
    }
    is_whole(&rig, &[]);
}

#[test]
fn limbs_of_one_bone_are_a_humans() {
    let mut rig = toy::body(mixamo);
    let gone = ["leftLowerLeg", "leftFoot", "rightLowerLeg", "rightFoot"];
    for (from, to) in gone.map(part).into_iter().zip([11, 11, 14, 14]) {
        give_skin(&mut rig, from, to);
        rig.joints[from].name = format!("helper {from}");
    }
    rig.joints[part("leftUpperLeg")].name = "mixamorig:LeftLeg".into();
    rig.joints[part("rightUpperLeg")].name = "mixamorig:RightLeg".into();
    let found = analyze(&rig).expect("a skin");
    assert!(found.humanoid, "{:?}", found.notes);
    assert_eq!(found.joint_with(Role::UpperLeg(Side::Left)), Some(part("leftUpperLeg")));
    assert_eq!(found.joint_with(Role::Head), Some(part("head")));
}

#[test]
fn plain_names_count_where_a_pose_has_no_mirror() {
    let mut rig = toy::body(mixamo);
    // One arm is raised, one leg kicks: every joint below is elsewhere.
    for (name, by) in [
        ("leftLowerArm", Vec3::new(-0.2, 0.25, 0.0)),
        ("leftHand", Vec3::new(-0.4, 0.5, 0.0)),
        ("rightLowerLeg", Vec3::new(0.0, 0.1, 0.3)),
        ("rightFoot", Vec3::new(0.0, 0.3, 0.5)),
        ("rightLowerArm", Vec3::new(0.15, -0.2, 0.1)),
        ("rightHand", Vec3::new(0.3, -0.4, 0.3)),
    ] {
        let joint = part(name);
        rig.skins[0].inverse_bind[joint].translation -= by;
        rig.meshes[0].primitives[0].positions[4 * joint..4 * joint + 4].iter_mut().for_each(|at| *at += by);
    }
    is_whole(&rig, &[]);
}

/// A second skeleton of one joint that moves a tetrahedron of that size at a place.
fn add_skeleton(rig: &mut Rig, name: &str, place: Vec3, size: f32) -> usize {
    let joint = rig.joints.len();
    let rest = LocalTransform { translation: place, ..LocalTransform::default() };
    rig.joints.push(Joint { name: name.into(), parent: None, rest, source: joint });
    let inverse_bind = vec![Affine { translation: -place, ..Affine::IDENTITY }];
    rig.skins.push(Skin { name: name.into(), joints: vec![joint], inverse_bind });
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|corner| place + corner * size);
    let primitive = Primitive {
        positions: corners.to_vec(),
        joints: vec![[0; 4]; 4],
        weights: vec![[1.0, 0.0, 0.0, 0.0]; 4],
        indices: [0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2].to_vec(),
        ..Primitive::default()
    };
    let skin = Some(rig.skins.len() - 1);
    rig.meshes.push(RigMesh { name: name.into(), joint, skin, primitives: vec![primitive] });
    joint
}

#[test]
fn a_hat_with_a_skeleton_of_its_own_goes_with_the_head() {
    let mut rig = toy::body(mixamo);
    let head = Vec3::from_array(toy::BODY[part("head")].2);
    let hat = add_skeleton(&mut rig, "Bone", head + Vec3::Y * 0.15, 0.2);
    let found = is_whole(&rig, &[]);
    assert_eq!(characters(&rig).len(), 1);
    assert_eq!(found.merge_into[hat], Some(part("head")));
}

#[test]
fn who_stands_beside_is_another_character() {
    let mut rig = toy::body(mixamo);
    let other = add_skeleton(&mut rig, "Bone", Vec3::new(2.0, 0.0, 0.0), 1.2);
    assert_eq!(characters(&rig), vec![vec![0], vec![1]]);
    // As some exporters do, each within nodes of its own below one root.
    for joint in &mut rig.joints {
        joint.parent = Some(joint.parent.map_or(1, |parent| parent + 3));
    }
    rig.joints[other].parent = Some(2);
    for name in ["second", "first", "RootNode"] {
        let parent = (name != "RootNode").then_some(0);
        rig.joints.insert(0, Joint { name: name.into(), parent, rest: LocalTransform::default(), source: 0 });
    }
    rig.skins.iter_mut().flat_map(|skin| &mut skin.joints).for_each(|joint| *joint += 3);
    rig.meshes.iter_mut().for_each(|mesh| mesh.joint += 3);
    assert_eq!(characters(&rig), vec![vec![0], vec![1]]);
}

#[test]
fn a_mesh_within_the_body_that_hangs_on_no_bone_goes_with_the_nearest() {
    let mut rig = toy::body(mixamo);
    let place = Vec3::from_array(toy::BODY[part("head")].2) + Vec3::Y * 0.14;
    let hat = add_skeleton(&mut rig, "hat", place, 0.02);
    let floor = add_skeleton(&mut rig, "floor", Vec3::new(-2.0, -0.1, -2.0), 4.0);
    rig.skins.truncate(1);
    for mesh in &mut rig.meshes[1..] {
        mesh.skin = None;
        for primitive in &mut mesh.primitives {
            primitive.joints.clear();
            primitive.weights.clear();
            let by = if mesh.joint == hat { place } else { Vec3::new(-2.0, -0.1, -2.0) };
            primitive.positions.iter_mut().for_each(|at| *at -= by);
        }
    }
    let found = is_whole(&rig, &[]);
    assert_eq!(found.merge_into[hat], Some(part("head")));
    assert_eq!(found.merge_into[floor], None);
}

#[test]
fn skinned_joints_outside_the_chain_go_with_what_their_skin_runs_into() {
    let mut rig = toy::body(mixamo);
    // The root of a coat beside the body, sewn to the chest.
    let coat = rig.joints.len();
    let place = Vec3::new(0.0, 1.2, -0.1);
    let rest = LocalTransform { translation: place, ..LocalTransform::default() };
    rig.joints.push(Joint { name: "Coat".into(), parent: None, rest, source: coat });
    rig.skins[0].joints.push(coat);
    rig.skins[0].inverse_bind.push(Affine { translation: -place, ..Affine::IDENTITY });
    let primitive = &mut rig.meshes[0].primitives[0];
    let first = u32::try_from(primitive.positions.len()).expect("few");
    let chest = u32::try_from(4 * part("chest")).expect("few");
    primitive.positions.extend([place, place + Vec3::X * 0.2, place - Vec3::Y * 0.3]);
    primitive.joints.extend([[u16::try_from(coat).expect("few"), 0, 0, 0]; 3]);
    primitive.weights.extend([[1.0, 0.0, 0.0, 0.0]; 3]);
    primitive.indices.extend([first, first + 1, first + 2, first, first + 1, chest]);
    let found = is_whole(&rig, &[]);
    assert_eq!(found.merge_into[coat], Some(part("chest")));
}

#[test]
fn clavicles_that_begin_on_the_midline_are_arms_all_the_same() {
    let mut number = 0;
    let mut rig = toy::body(|_| String::new());
    for joint in &mut rig.joints {
        number += 1;
        joint.name = format!("Bone.{number:03}");
    }
    let place = Vec3::new(0.0, 1.45, 0.0);
    for (before, arm) in ["leftUpperArm", "rightUpperArm"].map(part).into_iter().enumerate() {
        let arm = arm + before;
        // In place of the neck's own joint, so that parents come first.
        let clavicle = part("chest");
        let twin =
            Joint { name: format!("Bone.1{arm:02}"), parent: Some(clavicle), ..rig.joints[arm].clone() };
        let at = arm;
        for joint in &mut rig.joints {
            joint.parent = joint.parent.map(|parent| if parent >= at { parent + 1 } else { parent });
        }
        rig.joints.insert(at, Joint { rest: LocalTransform::default(), ..twin });
        rig.joints[at + 1].parent = Some(at);
        rig.skins[0].joints = (0..rig.joints.len()).collect();
        rig.skins[0].inverse_bind.insert(at, Affine { translation: -place, ..Affine::IDENTITY });
        let primitive = &mut rig.meshes[0].primitives[0];
        for slots in &mut primitive.joints {
            slots[0] += u16::from(usize::from(slots[0]) >= at);
        }
        let first = u32::try_from(primitive.positions.len()).expect("few");
        primitive.positions.extend([place, place + Vec3::Y * 0.05, place + Vec3::Z * 0.05]);
        primitive.joints.extend([[u16::try_from(at).expect("few"), 0, 0, 0]; 3]);
        primitive.weights.extend([[1.0, 0.0, 0.0, 0.0]; 3]);
        primitive.indices.extend([first, first + 1, first + 2]);
    }
    let found = analyze(&rig).expect("a skin");
    assert!(found.humanoid, "{:?}", found.notes);
    assert!(found.joint_with(Role::Hand(Side::Left)).is_some());
}

#[test]
fn who_has_wings_for_arms_is_no_human() {
    let rig = toy::body(|role| match role {
        Role::UpperArm(_) => "WING_BASE".into(),
        Role::LowerArm(_) => "WING_END".into(),
        Role::Hand(_) => "WING_TIP".into(),
        _ => "part".into(),
    });
    assert!(!analyze(&rig).expect("a skin").humanoid);
    assert!(analyze(&toy::body(|_| "part".into())).expect("a skin").humanoid);
}

#[test]
fn a_skin_whose_weights_were_lost_is_known() {
    let mut rig = toy::body(mixamo);
    assert_eq!(lost_weights(&rig), None);
    for slots in &mut rig.meshes[0].primitives[0].joints {
        slots[0] = 5;
    }
    assert_eq!(lost_weights(&rig), Some(5));
}
