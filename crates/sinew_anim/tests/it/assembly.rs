//! Tests of humans with unambiguous names whose hierarchy or skin is incomplete.

use crate::toy;
use sinew_anim::riders::Riders;
use sinew_anim::weights::lost_weights;
use sinew_anim::{
    Channel, Clip, Hints, Interpolation, Joint, LocalTransform, Primitive, Property, Rig, RigAnalysis,
    RigMesh, Role, Side, Skin, analyze, analyze_hinted, characters,
};
use sinew_math::{Affine, Rotation, Transform, Vec3};

/// Returns the Mixamo name of a part of the toy body.
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

/// Moves the skin of one joint to another.
fn give_skin(rig: &mut Rig, from: usize, to: usize) {
    let slot = |joint: usize| u16::try_from(joint).expect("few");
    for slots in &mut rig.meshes[0].primitives[0].joints {
        if slots[0] == slot(from) {
            slots[0] = slot(to);
        }
    }
}

/// Checks that every present part of the toy body has its role, and a body attached to its anatomical parent.
fn is_whole(rig: &Rig, missing: &[&str]) -> RigAnalysis {
    let found = analyze(rig).expect("the rig has a skin");
    assert!(found.humanoid, "{:?}", found.notes);
    for (name, parent, _) in toy::BODY.iter().filter(|(name, ..)| !missing.contains(name)) {
        let role = Role::from_name(name).expect("a VRM name");
        let joint = found.joint_with(role).unwrap_or_else(|| panic!("{name}: no role; {:?}", found.notes));
        assert_eq!(rig.joints[joint].name, mixamo(role), "{name}");
        let bone = found.kept_with(role).unwrap_or_else(|| panic!("{name}: no body"));
        if !parent.is_empty() && !missing.contains(parent) {
            let above = found.kept[bone].parent.map(|above| found.kept[above].role.name());
            assert_eq!(above.as_deref(), Some(*parent), "{name} has another parent");
        }
    }
    found
}

#[test]
fn limb_bones_without_skin_keep_role_and_body() {
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
fn separate_root_parts_are_connected_by_name() {
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
fn rigid_meshes_serve_as_skin_of_parts_without_any() {
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
fn human_with_one_bone_limbs_is_recognised() {
    let mut rig = toy::body(mixamo);
    let gone = ["leftLowerLeg", "leftFoot", "rightLowerLeg", "rightFoot"];
    for (from, to) in gone.map(part).into_iter().zip([11, 11, 14, 14]) {
        give_skin(&mut rig, from, to);
        rig.joints[from].name = format!("helper {from}");
    }
    rig.joints[part("leftUpperLeg")].name = "mixamorig:LeftLeg".into();
    rig.joints[part("rightUpperLeg")].name = "mixamorig:RightLeg".into();
    let found = analyze(&rig).expect("the rig has a skin");
    assert!(found.humanoid, "{:?}", found.notes);
    assert_eq!(found.joint_with(Role::UpperLeg(Side::Left)), Some(part("leftUpperLeg")));
    assert_eq!(found.joint_with(Role::Head), Some(part("head")));
}

/// Raises one arm and bends one leg; descendants keep their rest positions.
fn kick(rig: &mut Rig) {
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
}

#[test]
fn names_decide_where_the_pose_is_asymmetric() {
    let mut rig = toy::body(mixamo);
    kick(&mut rig);
    is_whole(&rig, &[]);
}

/// Adds a second skeleton: one joint that moves a tetrahedron of the given size at a position.
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
fn hat_with_its_own_skeleton_joins_the_head() {
    let mut rig = toy::body(mixamo);
    let head = Vec3::from_array(toy::BODY[part("head")].2);
    let hat = add_skeleton(&mut rig, "Bone", head + Vec3::Y * 0.15, 0.2);
    let found = is_whole(&rig, &[]);
    assert_eq!(characters(&rig).len(), 1);
    assert_eq!(found.merge_into[hat], Some(part("head")));
}

/// A cape with its own skeleton, behind the back, half of it outside the body's bounding box.
#[test]
fn cape_with_its_own_skeleton_joins_the_body() {
    let mut rig = toy::body(mixamo);
    let chest = Vec3::from_array(toy::BODY[part("chest")].2);
    let place = chest - Vec3::new(0.02, 0.4, 0.41);
    let cape = add_skeleton(&mut rig, "Bone", place, 0.46);
    let cloth = rig.meshes.last_mut().expect("just added");
    cloth.primitives[0].positions.iter_mut().for_each(|at| at.x = place.x + 0.1 * (at.x - place.x));
    let found = is_whole(&rig, &[]);
    assert_eq!(characters(&rig).len(), 1);
    assert!(found.merge_into[cape].is_some(), "{:?}", found.notes);
}

/// Long hair with its own skeleton is attached to the head as a whole, although its tip is nearest to the chest.
#[test]
fn hair_with_its_own_skeleton_joins_the_head_as_a_whole() {
    let mut rig = toy::body(mixamo);
    let head = Vec3::from_array(toy::BODY[part("head")].2);
    let root = add_skeleton(&mut rig, "hairjnt", head + Vec3::new(0.0, 0.12, -0.06), 0.05);
    let tip = add_skeleton(&mut rig, "hairjnt2", head + Vec3::new(0.0, -0.25, -0.08), 0.05);
    let (root_place, tip_place) = (rig.joints[root].rest.translation, rig.joints[tip].rest.translation);
    rig.joints[tip].parent = Some(root);
    rig.joints[tip].rest.translation = tip_place - root_place;
    let found = is_whole(&rig, &[]);
    assert_eq!(found.merge_into[root], Some(part("head")));
    assert_eq!(found.merge_into[tip], Some(part("head")));
}

/// In a bent rest pose, hair with its own skeleton is placed and bound at the head.
#[test]
fn separate_hair_joins_the_head_of_a_bent_rest_pose() {
    let mut rig = toy::body(mixamo);
    rig.joints[part("neck")].rest.rotation = Rotation::from_axis_angle(Vec3::X, 1.2);
    let rest: Vec<LocalTransform> = rig.joints.iter().map(|joint| joint.rest).collect();
    let mut model = Vec::new();
    sinew_anim::local_to_model(&rig, &rest, &Affine::IDENTITY, &mut model);
    let off = Vec3::new(0.0, 0.12, 0.0);
    let hair = add_skeleton(&mut rig, "hairjnt", model[part("head")].point(off), 0.05);
    let found = is_whole(&rig, &[]);
    let bound = found.bind_model[hair].translation - found.bind_model[part("head")].translation;
    assert!((bound - off).length() < 1e-3, "{bound}");
    assert_eq!(found.merge_into[hair], Some(part("head")));
}

#[test]
fn second_character_is_not_merged_into_the_first() {
    let mut rig = toy::body(mixamo);
    let other = add_skeleton(&mut rig, "Bone", Vec3::new(2.0, 0.0, 0.0), 1.2);
    assert_eq!(characters(&rig), vec![vec![0], vec![1]]);
    // As from some exporters, each skeleton has its own nodes below one root.
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
fn unattached_mesh_inside_the_body_joins_the_nearest_bone() {
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
fn outside_skinned_joint_joins_the_adjacent_skin() {
    let mut rig = toy::body(mixamo);
    // The root of a coat is outside the body, and its skin borders on the chest's.
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
fn clavicles_on_the_midline_belong_to_the_arms() {
    let mut number = 0;
    let mut rig = toy::body(|_| String::new());
    for joint in &mut rig.joints {
        number += 1;
        joint.name = format!("Bone.{number:03}");
    }
    let place = Vec3::new(0.0, 1.45, 0.0);
    for (before, arm) in ["leftUpperArm", "rightUpperArm"].map(part).into_iter().enumerate() {
        let arm = arm + before;
        // The parent is the chest instead of the neck, so that parents come first.
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
    let found = analyze(&rig).expect("the rig has a skin");
    assert!(found.humanoid, "{:?}", found.notes);
    assert!(found.joint_with(Role::Hand(Side::Left)).is_some());
}

#[test]
fn figure_with_wings_is_not_human() {
    let rig = toy::body(|role| match role {
        Role::UpperArm(_) => "WING_BASE".into(),
        Role::LowerArm(_) => "WING_END".into(),
        Role::Hand(_) => "WING_TIP".into(),
        _ => "part".into(),
    });
    assert!(!analyze(&rig).expect("the rig has a skin").humanoid);
    assert!(analyze(&toy::body(|_| "part".into())).expect("the rig has a skin").humanoid);
}

#[test]
fn skin_with_lost_weights_is_detected() {
    let mut rig = toy::body(mixamo);
    assert_eq!(lost_weights(&rig), None);
    for slots in &mut rig.meshes[0].primitives[0].joints {
        slots[0] = 5;
    }
    assert_eq!(lost_weights(&rig), Some(5));
}

/// Rotates a limb (skin and joints from `from` on) about its first joint.
fn bend(rig: &mut Rig, from: usize, turn: Rotation) {
    let is_below =
        |joint: usize| core::iter::successors(Some(joint), |&at| rig.joints[at].parent).any(|at| at == from);
    let below: Vec<bool> = (0..rig.joints.len()).map(is_below).collect();
    let pivot = rig.skins[0].inverse_bind[from].inverse().translation;
    let about = Affine::from(Transform::new(pivot - turn * pivot, turn));
    rig.joints[from].rest.rotation = turn;
    for (inverse, _) in rig.skins[0].inverse_bind.iter_mut().zip(&below).filter(|(_, is_below)| **is_below) {
        *inverse = *inverse * about.inverse();
    }
    let primitive = &mut rig.meshes[0].primitives[0];
    for (position, slots) in primitive.positions.iter_mut().zip(&primitive.joints) {
        if below[usize::from(slots[0])] {
            *position = about.point(*position);
        }
    }
}

#[test]
fn nameless_human_with_unequally_bent_arms_is_recognised() {
    let mut rig = toy::body(|_| String::new());
    for (number, joint) in rig.joints.iter_mut().enumerate() {
        joint.name = format!("Bone.{number:03}");
    }
    assert!(analyze(&rig).expect("the rig has a skin").humanoid);
    for (role, turn) in [
        ("leftUpperArm", Rotation::from_axis_angle(Vec3::Y, -0.3)),
        ("leftLowerArm", Rotation::from_axis_angle(Vec3::Y, -0.7)),
        ("rightLowerArm", Rotation::from_axis_angle(Vec3::Z, 0.4)),
    ] {
        bend(&mut rig, part(role), turn);
    }
    let found = analyze(&rig).expect("the rig has a skin");
    assert!(found.humanoid, "{:?}", found.notes);
    for role in [Role::LowerArm(Side::Left), Role::Hand(Side::Left), Role::Hand(Side::Right)] {
        let joint = found.joint_with(role).unwrap_or_else(|| panic!("no {role:?}"));
        assert_eq!(toy::BODY[joint].0, role.name());
    }
}

/// Adds a joint with skin between trunk and limb, on the midline.
fn insert_inner_end(rig: &mut Rig, limb: usize) {
    let parent = rig.joints[limb].parent.expect("a limb has a parent");
    let at = -rig.skins[0].inverse_bind[parent].translation;
    let joint = rig.joints.len();
    rig.joints.push(Joint {
        name: format!("inner {joint}"),
        parent: Some(parent),
        rest: LocalTransform::default(),
        source: joint,
    });
    rig.joints[limb].parent = Some(joint);
    rig.skins[0].joints.push(joint);
    rig.skins[0].inverse_bind.push(Affine { translation: -at, ..Affine::IDENTITY });
    let primitive = &mut rig.meshes[0].primitives[0];
    let first = u32::try_from(primitive.positions.len()).expect("few");
    let out = -rig.skins[0].inverse_bind[limb].translation;
    primitive.positions.extend([at, at.lerp(out, 0.5), at.lerp(out, 0.5) + Vec3::Z * 0.02]);
    primitive.joints.extend([[u16::try_from(joint).expect("few"), 0, 0, 0]; 3]);
    primitive.weights.extend([[1.0, 0.0, 0.0, 0.0]; 3]);
    primitive.indices.extend([first, first + 1, first + 2]);
}

#[test]
fn human_with_inner_limb_joints_and_no_hands_or_feet_is_recognised() {
    let mut rig = toy::body(|_| "part".into());
    for side in ["left", "right"] {
        for (end, onto) in [("Foot", "LowerLeg"), ("Hand", "LowerArm")] {
            let (end, onto) = (part(&format!("{side}{end}")), part(&format!("{side}{onto}")));
            give_skin(&mut rig, end, onto);
        }
        insert_inner_end(&mut rig, part(&format!("{side}UpperLeg")));
        insert_inner_end(&mut rig, part(&format!("{side}UpperArm")));
    }
    // Moves the new joints in front of their descendants, because parents come before children.
    let rig = in_order(&rig);
    let found = analyze(&rig).expect("the rig has a skin");
    assert!(found.humanoid, "{:?}", found.notes);
    for (role, place) in [
        (Role::UpperLeg(Side::Left), [0.1, 0.9, 0.0]),
        (Role::LowerLeg(Side::Left), [0.1, 0.5, 0.0]),
        (Role::UpperArm(Side::Right), [-0.18, 1.45, 0.0]),
        (Role::LowerArm(Side::Right), [-0.46, 1.45, 0.0]),
    ] {
        let joint = found.joint_with(role).unwrap_or_else(|| panic!("no {role:?}"));
        let at = found.bind_model[joint].translation;
        assert!((at - Vec3::from_array(place)).length() < 1e-4, "{role:?} at {at}");
    }
}

/// Returns the rig with parents before children.
fn in_order(rig: &Rig) -> Rig {
    let depth = |joint: usize| core::iter::successors(Some(joint), |&at| rig.joints[at].parent).count();
    let mut order: Vec<usize> = (0..rig.joints.len()).collect();
    order.sort_by_key(|&joint| depth(joint));
    let new = |joint: usize| order.iter().position(|&old| old == joint).expect("all are there");
    let mut sorted = rig.clone();
    sorted.joints = order.iter().map(|&old| rig.joints[old].clone()).collect();
    for joint in &mut sorted.joints {
        joint.parent = joint.parent.map(new);
    }
    for skin in &mut sorted.skins {
        skin.joints.iter_mut().for_each(|joint| *joint = new(*joint));
    }
    sorted.meshes.iter_mut().for_each(|mesh| mesh.joint = new(mesh.joint));
    sorted
}

#[test]
fn quadruped_with_human_names_is_not_human() {
    // The trunk is along z at hip height, with arms and legs straight down.
    let place = |role: &str, at: [f32; 3]| match role {
        "hips" => [0.0, 1.0, -0.6],
        "spine" => [0.0, 1.0, -0.3],
        "chest" => [0.0, 1.0, 0.1],
        "neck" => [0.0, 1.1, 0.3],
        "head" => [0.0, 1.15, 0.5],
        _ => {
            let side = at[0].signum();
            let (z, down) =
                if role.contains("Arm") || role.contains("Hand") { (0.15, 0.0) } else { (-0.6, 0.0) };
            let level = if role.contains("Upper") {
                0.9
            } else if role.contains("Lower") {
                0.5
            } else {
                0.1
            };
            [0.15 * side, level + down, z]
        }
    };
    let mut rig = toy::body(mixamo);
    let places: Vec<Vec3> =
        toy::BODY.iter().map(|(role, _, at)| Vec3::from_array(place(role, *at))).collect();
    let primitive = &mut rig.meshes[0].primitives[0];
    for (position, slots) in primitive.positions.iter_mut().zip(&primitive.joints) {
        let joint = usize::from(slots[0]);
        *position += places[joint] - Vec3::from_array(toy::BODY[joint].2);
    }
    for (joint, &place) in places.iter().enumerate() {
        rig.skins[0].inverse_bind[joint].translation = -place;
        let parent = rig.joints[joint].parent.map_or(Vec3::ZERO, |parent| places[parent]);
        rig.joints[joint].rest.translation = place - parent;
    }
    let hints = Hints { up: Some(Vec3::Y), ..Hints::default() };
    let found = analyze_hinted(&rig, &hints).expect("the rig has a skin");
    assert!(!found.humanoid, "{:?}", found.notes);
    assert!((found.up_axis - Vec3::Y).length() < 1e-6);
}

/// Adds a joint without skin at a position.
fn add_bare(rig: &mut Rig, name: &str, parent: Option<usize>, place: Vec3, under: Vec3) -> usize {
    let rest = LocalTransform { translation: place - under, ..LocalTransform::default() };
    rig.joints.push(Joint { name: name.into(), parent, rest, source: rig.joints.len() });
    rig.joints.len() - 1
}

/// Reparents a joint of the toy body without moving it.
fn hang(rig: &mut Rig, joint: usize, parent: usize, place: Vec3) {
    rig.joints[joint].parent = Some(parent);
    rig.joints[joint].rest.translation = Vec3::from_array(toy::BODY[joint].2) - place;
}

#[test]
fn trunk_on_a_separate_branch_is_found() {
    let rigify = |role: Role| {
        let side = |side: Side| if side == Side::Left { "L" } else { "R" };
        match role {
            Role::Hips => "DEF-spine".to_owned(),
            Role::Spine => "DEF-spine.001".into(),
            Role::Chest => "DEF-spine.002".into(),
            Role::Neck => "DEF-neck".into(),
            Role::Head => "DEF-head".into(),
            Role::UpperArm(s) => format!("DEF-upper_arm.{}", side(s)),
            Role::LowerArm(s) => format!("DEF-forearm.{}", side(s)),
            Role::Hand(s) => format!("DEF-hand.{}", side(s)),
            Role::UpperLeg(s) => format!("DEF-thigh.{}", side(s)),
            Role::LowerLeg(s) => format!("DEF-shin.{}", side(s)),
            Role::Foot(s) => format!("DEF-foot.{}", side(s)),
            other => other.name(),
        }
    };
    let mut rig = toy::body(rigify);
    let [low, high] = ["hips", "chest"].map(|name| Vec3::from_array(toy::BODY[part(name)].2));
    // Limbs and neck are children of controls without skin. The trunk's bones were moved by constraints, which files do
    // not contain.
    let torso = add_bare(&mut rig, "MCH-torso.parent", None, low, Vec3::ZERO);
    let chest = add_bare(&mut rig, "ORG-spine.002", Some(torso), high, low);
    ["leftUpperLeg", "rightUpperLeg"].into_iter().for_each(|thigh| hang(&mut rig, part(thigh), torso, low));
    ["leftUpperArm", "rightUpperArm", "neck"]
        .into_iter()
        .for_each(|limb| hang(&mut rig, part(limb), chest, high));
    kick(&mut rig);
    for limb in ["leftUpperArm", "leftUpperLeg"] {
        let joint = part(limb);
        let by = Vec3::new(0.0, -0.1, 0.12);
        rig.skins[0].inverse_bind[joint].translation -= by;
        rig.meshes[0].primitives[0].positions[4 * joint..4 * joint + 4].iter_mut().for_each(|at| *at += by);
    }
    let found = analyze(&in_order(&rig)).expect("the rig has a skin");
    assert!(found.humanoid, "{:?}", found.notes);
    for (name, ..) in toy::BODY {
        let role = Role::from_name(name).expect("a VRM name");
        let joint = found.joint_with(role).map(|joint| in_order(&rig).joints[joint].name.clone());
        let expected = rigify(role);
        // The spine's parts may be numbered differently.
        assert!(
            joint.as_deref() == Some(&expected) || expected.contains("spine.00"),
            "the joint of {name} is {joint:?}, expected {expected}"
        );
    }
}

/// Converts the skin of a toy joint to a rigid mesh of `carrier`, which is at `at`.
fn make_rigid(rig: &mut Rig, joint: usize, carrier: usize, at: Vec3) {
    let skinned = &mut rig.meshes[0].primitives[0];
    let own = skinned.positions[4 * joint..4 * joint + 4].iter().map(|&corner| corner - at).collect();
    let indices = [0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2].to_vec();
    let primitive = Primitive { positions: own, indices, ..Primitive::default() };
    let corner = skinned.indices[12 * joint];
    skinned.indices[12 * joint..12 * joint + 12].fill(corner);
    for (other, slots) in skinned.weights.iter_mut().enumerate() {
        if other / 4 == joint {
            *slots = [0.0; 4];
        }
    }
    rig.meshes.push(RigMesh { name: String::new(), joint: carrier, skin: None, primitives: vec![primitive] });
}

#[test]
fn rigid_trunk_above_the_legs_is_the_hips() {
    // In this toy body the trunk is one rigid mesh of a nameless bone, which is also the parent of the thighs.
    let mut rig = toy::body(mixamo);
    let low = Vec3::from_array(toy::BODY[part("hips")].2);
    let bone = add_bare(&mut rig, "Bone", None, low, Vec3::ZERO);
    rig.skins[0].joints.push(bone);
    rig.skins[0].inverse_bind.push(Affine { translation: -low, ..Affine::IDENTITY });
    ["hips", "leftUpperLeg", "rightUpperLeg"]
        .into_iter()
        .for_each(|own| hang(&mut rig, part(own), bone, low));
    let trunk = add_bare(&mut rig, "Torso", Some(bone), low, low);
    for bare in ["chest", "spine", "hips", "neck"] {
        make_rigid(&mut rig, part(bare), trunk, low);
    }
    // One arm is bent, so that only names can decide.
    bend(&mut rig, part("leftUpperArm"), Rotation::from_axis_angle(Vec3::Z, 0.9));
    let sorted = in_order(&rig);
    let found = analyze(&sorted).expect("the rig has a skin");
    assert!(found.humanoid, "{:?}", found.notes);
    let hips = found.joint_with(Role::Hips).map(|joint| sorted.joints[joint].name.as_str());
    assert_eq!(hips, Some("Bone"));
    let thigh = found.joint_with(Role::UpperLeg(Side::Right)).map(|joint| sorted.joints[joint].name.as_str());
    assert_eq!(thigh, Some("mixamorig:RightUpLeg"));
}

#[test]
fn head_mesh_parented_to_the_armature_moves_with_the_head() {
    let mut rig = toy::body(mixamo);
    let head = part("head");
    // The head is half a metre high, larger than any human's.
    let armature = add_bare(&mut rig, "Armature", None, Vec3::ZERO, Vec3::ZERO);
    rig.joints[part("hips")].parent = Some(armature);
    let place = Vec3::from_array(toy::BODY[head].2);
    let mesh = add_bare(&mut rig, "Goblin_head", Some(armature), Vec3::ZERO, Vec3::ZERO);
    let hair = add_bare(&mut rig, "Hair", Some(mesh), place, Vec3::ZERO);
    let beside = add_bare(&mut rig, "Table", Some(armature), Vec3::X * 3.0, Vec3::ZERO);
    make_rigid(&mut rig, head, mesh, Vec3::ZERO);
    make_rigid(&mut rig, part("leftHand"), beside, Vec3::from_array(toy::BODY[part("leftHand")].2));
    let own = rig.meshes.iter_mut().find(|other| other.joint == mesh).expect("just added");
    // One of four corners touches the neck. The mesh surrounds the bone of the head.
    let corners = own.primitives[0].positions.iter_mut().enumerate();
    corners.for_each(|(k, corner)| {
        *corner = place + (*corner - place) * 6.0 + Vec3::Y * if k == 0 { -0.1 } else { 0.6 };
    });
    let sorted = in_order(&rig);
    let at = |name: &str| {
        sorted.joints.iter().position(|joint| joint.name == name).expect("the rig has this joint")
    };
    let found = analyze(&sorted).expect("the rig has a skin");
    // The hat protrudes enough to get its own body.
    let body = |name: &str| found.kept.iter().find(|bone| bone.joint == at(name));
    let carrier = body("Goblin_head").and_then(|head| found.kept[head.parent?].joint.into());
    assert_eq!(carrier, Some(at(&rig.joints[head].name)), "{:?}", found.notes);
    assert!(body("Table").is_none() && found.merge_into[at("Table")].is_none());
    assert_eq!(found.merge_into[at(&rig.joints[hair].name)], Some(at("Goblin_head")));
}

#[test]
fn eyes_with_their_own_skeleton_join_the_head() {
    let mut rig = toy::body(mixamo);
    // The eyes are on both sides of a wide head, and their centre is nearest to the nape.
    let head = Vec3::from_array(toy::BODY[part("head")].2);
    for corner in 4 * part("head")..4 * part("head") + 4 {
        let at = &mut rig.meshes[0].primitives[0].positions[corner];
        *at = head + (*at - head) * Vec3::new(6.0, 1.0, 6.0);
    }
    let eyes = add_skeleton(&mut rig, "Bone", head + Vec3::new(0.28, 0.0, 0.0), 0.03);
    let other = rig.meshes[1].primitives[0].clone();
    let first = u32::try_from(other.positions.len()).expect("few");
    let both = &mut rig.meshes[1].primitives[0];
    both.positions.extend(other.positions.iter().map(|at| *at * Vec3::new(-1.0, 1.0, 1.0)));
    both.joints.extend(other.joints);
    both.weights.extend(other.weights);
    both.indices.extend(other.indices.iter().map(|index| index + first));
    // The neck is so thick that it is nearer to the centre of both eyes than any corner of the head.
    let neck = Vec3::from_array(toy::BODY[part("neck")].2);
    rig.meshes[0].primitives[0].positions[4 * part("neck") + 3] = neck + Vec3::Y * 0.11;
    let found = is_whole(&rig, &[]);
    assert_eq!(found.merge_into[eyes], Some(part("head")));
}

#[test]
fn skinless_hand_on_the_forearm_is_preferred() {
    let mut rig = toy::body(mixamo);
    let [hand, forearm] = ["leftHand", "leftLowerArm"].map(part);
    give_skin(&mut rig, hand, forearm);
    add_bare(&mut rig, "ORG-mixamorig:LeftHand", None, Vec3::from_array(toy::BODY[hand].2), Vec3::ZERO);
    let sorted = in_order(&rig);
    let found = analyze(&sorted).expect("the rig has a skin");
    let joint = found.joint_with(Role::Hand(Side::Left)).expect("a hand");
    assert_eq!(sorted.joints[joint].name, "mixamorig:LeftHand");
}

#[test]
fn rootless_figure_with_squatting_rest_pose_stands_in_the_bind_pose() {
    let mut rig = toy::body(mixamo);
    let [low, high] = ["hips", "chest"].map(|name| Vec3::from_array(toy::BODY[part(name)].2));
    let torso = add_bare(&mut rig, "MCH-torso", None, low, Vec3::ZERO);
    let chest = add_bare(&mut rig, "ORG-chest", Some(torso), high, low);
    for limb in ["leftUpperLeg", "rightUpperLeg", "hips"] {
        hang(&mut rig, part(limb), torso, low);
    }
    for limb in ["leftUpperArm", "rightUpperArm", "neck"] {
        hang(&mut rig, part(limb), chest, high);
    }
    give_skin(&mut rig, part("spine"), part("hips"));
    // Every joint except those of the trunk is rotated relative to its bind pose, the thighs most; the trunk leans.
    let turn = |rig: &mut Rig, name: &str, about: Vec3, by: f32| {
        rig.joints[part(name)].rest.rotation = Rotation::from_axis_angle(about, by);
    };
    for (name, by) in [("leftUpperLeg", -1.5), ("rightUpperLeg", -1.5), ("neck", 0.4), ("hips", 0.2)] {
        turn(&mut rig, name, Vec3::X, by);
    }
    turn(&mut rig, "chest", Vec3::X, 0.1);
    turn(&mut rig, "leftUpperArm", Vec3::Z, -1.2);
    turn(&mut rig, "rightUpperArm", Vec3::Z, 1.2);
    for shin in ["leftLowerLeg", "rightLowerLeg"] {
        turn(&mut rig, shin, Vec3::X, 0.1);
    }
    for foot in ["leftFoot", "rightFoot", "head"] {
        turn(&mut rig, foot, Vec3::X, 0.05);
    }
    let found = analyze(&in_order(&rig)).expect("the rig has a skin");
    let place = |role: Role| found.bind_model[found.joint_with(role).expect("a joint")].translation;
    let up = (place(Role::Head) - place(Role::Hips)).normalize();
    assert!(up.y > 0.9, "the direction from hips to head is {up}; notes {:?}", found.notes);
}

/// A mesh that is a node below its object, as in some converted files.
#[test]
fn head_object_on_the_armature_keeps_its_mesh_and_hair() {
    let mut rig = toy::body(mixamo);
    let head = part("head");
    let armature = add_bare(&mut rig, "Armature", None, Vec3::ZERO, Vec3::ZERO);
    rig.joints[part("hips")].parent = Some(armature);
    let place = Vec3::from_array(toy::BODY[head].2);
    let object = add_bare(&mut rig, "Goblin_head", Some(armature), Vec3::ZERO, Vec3::ZERO);
    let mesh = add_bare(&mut rig, "Sphere", Some(object), Vec3::ZERO, Vec3::ZERO);
    make_rigid(&mut rig, head, mesh, Vec3::ZERO);
    let own = rig.meshes.iter_mut().find(|other| other.joint == mesh).expect("just added");
    let corners = own.primitives[0].positions.iter_mut().enumerate();
    corners.for_each(|(k, corner)| {
        *corner = place + (*corner - place) * 6.0 + Vec3::Y * if k == 0 { -0.1 } else { 0.6 };
    });
    // Hair is a child of the object, and touches only the head.
    let hair = add_bare(&mut rig, "Hair", Some(object), place + Vec3::Y * 0.9, Vec3::ZERO);
    let strands = add_bare(&mut rig, "Circle", Some(hair), place + Vec3::Y * 0.9, place + Vec3::Y * 0.9);
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|corner| corner * 0.2).to_vec();
    let indices = [0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2].to_vec();
    let primitive = Primitive { positions, indices, ..Primitive::default() };
    rig.meshes.push(RigMesh { name: String::new(), joint: strands, skin: None, primitives: vec![primitive] });
    // The eyes are inside the head, far from all skin.
    let eyes = add_bare(&mut rig, "Goblin_eyes", Some(armature), place + Vec3::Y * 0.5, Vec3::ZERO);
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|corner| corner * 0.05).to_vec();
    let indices = [0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2].to_vec();
    let primitive = Primitive { positions, indices, ..Primitive::default() };
    rig.meshes.push(RigMesh { name: String::new(), joint: eyes, skin: None, primitives: vec![primitive] });
    let sorted = in_order(&rig);
    let at = |name: &str| {
        sorted.joints.iter().position(|joint| joint.name == name).expect("the rig has this joint")
    };
    let found = analyze(&sorted).expect("the rig has a skin");
    let body = found.kept.iter().find(|bone| bone.joint == at("Goblin_head")).expect("the object has a body");
    let carrier = body.parent.map(|parent| found.kept[parent].joint);
    assert_eq!(carrier, Some(at(&rig.joints[head].name)), "{:?}", found.notes);
    for worn in ["Sphere", "Hair", "Circle"] {
        assert_eq!(found.merge_into[at(worn)], Some(at("Goblin_head")), "{worn}");
    }
    let goes = found.merge_into[at("Goblin_eyes")].is_some()
        || found.kept.iter().any(|b| b.joint == at("Goblin_eyes"));
    assert!(goes, "the eyes are merged into the head's parent");
}

/// The hat is a separate skeleton. It is on the head in the bent rest pose, and was bound there in the upright pose.
#[test]
fn separate_hat_is_bound_on_the_head_of_a_bent_rest_pose() {
    let mut rig = toy::body(mixamo);
    let place = Vec3::from_array(toy::BODY[part("head")].2);
    rig.joints[part("neck")].rest.rotation = Rotation::from_axis_angle(Vec3::X, 0.8);
    let mut model = Vec::new();
    let rest: Vec<LocalTransform> = rig.joints.iter().map(|joint| joint.rest).collect();
    sinew_anim::local_to_model(&rig, &rest, &Affine::IDENTITY, &mut model);
    let on_head = Transform::from_translation(Vec3::Y * 0.2);
    let hat_place = model[part("head")].to_rigid() * on_head;
    let hat = rig.joints.len();
    let rest = LocalTransform {
        translation: hat_place.translation,
        rotation: hat_place.rotation,
        ..LocalTransform::default()
    };
    rig.joints.push(Joint { name: "hat".into(), parent: None, rest, source: hat });
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|corner| corner * 0.1).to_vec();
    let indices = [0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2].to_vec();
    let primitive = Primitive { positions, indices, ..Primitive::default() };
    rig.meshes.push(RigMesh { name: String::new(), joint: hat, skin: None, primitives: vec![primitive] });
    let found = analyze(&rig).expect("the rig has a skin");
    let bound = found.bind_model[hat].translation - found.bind_model[part("head")].translation;
    assert!(
        (bound - Vec3::Y * 0.2).length() < 1e-3,
        "the bind position is {bound} relative to the head at {place}"
    );
    assert_eq!(found.merge_into[hat], Some(part("head")));
}

/// A large hat outside the skeleton gets its own body. It also stays on the head in another body's motion.
#[test]
fn separate_prop_follows_its_carrier() {
    let mut rig = toy::body(mixamo);
    let head = Vec3::from_array(toy::BODY[part("head")].2);
    let armature = add_bare(&mut rig, "Armature", None, Vec3::ZERO, Vec3::ZERO);
    rig.joints[part("hips")].parent = Some(armature);
    let hat = add_bare(&mut rig, "hat", Some(armature), head, Vec3::ZERO);
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y * 4.0, Vec3::Z].map(|corner| corner * 0.2).to_vec();
    let indices = [0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2].to_vec();
    let primitive = Primitive { positions, indices, ..Primitive::default() };
    rig.meshes.push(RigMesh { name: String::new(), joint: hat, skin: None, primitives: vec![primitive] });
    let sorted = in_order(&rig);
    let at = |name: &str| {
        sorted.joints.iter().position(|joint| joint.name == name).expect("the rig has this joint")
    };
    let found = analyze(&sorted).expect("the rig has a skin");
    assert!(found.kept.iter().any(|bone| bone.joint == at("hat") && bone.is_prop), "{:?}", found.notes);
    let riders = Riders::of(&sorted, &found);
    let mut pose: Vec<LocalTransform> = sorted.joints.iter().map(|joint| joint.rest).collect();
    pose[at("mixamorig:Hips")].translation += Vec3::new(1.0, -0.5, 0.0);
    pose[at("mixamorig:Spine")].rotation = Rotation::from_axis_angle(Vec3::X, 1.2);
    let mut model = Vec::new();
    riders.carry(&sorted, &mut pose, &mut model);
    let [head, hat] = ["mixamorig:Head", "hat"].map(at);
    let way = model[hat].translation - model[head].translation;
    let bound = found.bind_model[hat].translation - found.bind_model[head].translation;
    assert!((way.length() - bound.length()).abs() < 1e-4, "moved by {way}, but bound at {bound}");
    assert!(model[hat].linear.y_axis.y < 0.5, "the hat must lean with the head");
}

/// A hat that only a clip moves to the head also stays there in another body's motion.
#[test]
fn hat_moved_by_a_clip_keeps_the_clips_place_on_the_head() {
    let mut rig = toy::body(mixamo);
    let head = Vec3::from_array(toy::BODY[part("head")].2);
    let hat = rig.joints.len();
    // The hat is bound at the nape, slightly too low.
    let rest = LocalTransform { translation: head - Vec3::Y * 0.1, ..LocalTransform::default() };
    rig.joints.push(Joint { name: "hat".into(), parent: None, rest, source: hat });
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|corner| corner * 0.1).to_vec();
    let indices = [0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2].to_vec();
    let primitive = Primitive { positions, indices, ..Primitive::default() };
    rig.meshes.push(RigMesh { name: String::new(), joint: hat, skin: None, primitives: vec![primitive] });
    let found = analyze(&rig).expect("the rig has a skin");
    let on_head = Channel {
        joint: hat,
        property: Property::Translation,
        interpolation: Interpolation::Linear,
        times: vec![0.0],
        values: (head + Vec3::Y * 0.15).to_array().to_vec(),
    };
    let clip = Clip { name: "stand".into(), duration: 1.0, channels: vec![on_head] };
    let height = |riders: &Riders| {
        let mut pose: Vec<LocalTransform> = rig.joints.iter().map(|joint| joint.rest).collect();
        pose[part("hips")].translation += Vec3::X;
        let mut model = Vec::new();
        riders.carry(&rig, &mut pose, &mut model);
        model[hat].translation - model[part("head")].translation
    };
    let bound = Riders::of(&rig, &found);
    assert!((height(&bound) + Vec3::Y * 0.1).length() < 1e-4, "{}", height(&bound));
    let held = bound.as_in(&rig, &clip);
    assert!((height(&held) - Vec3::Y * 0.15).length() < 1e-4, "{}", height(&held));
}

/// Returns the Auto-Rig Pro name of a part of the toy body.
fn auto_rig_pro(role: Role) -> String {
    let side = |side: Side| if side == Side::Left { "l" } else { "r" };
    match role {
        Role::Hips => "root.x".to_owned(),
        Role::Spine => "spine_01.x".into(),
        Role::Chest => "spine_02.x".into(),
        Role::Neck => "neck.x".into(),
        Role::Head => "head.x".into(),
        Role::UpperArm(s) => format!("arm_stretch.{}", side(s)),
        Role::LowerArm(s) => format!("forearm_stretch.{}", side(s)),
        Role::Hand(s) => format!("hand.{}", side(s)),
        Role::UpperLeg(s) => format!("thigh_stretch.{}", side(s)),
        Role::LowerLeg(s) => format!("leg_stretch.{}", side(s)),
        Role::Foot(s) => format!("foot.{}", side(s)),
        other => other.name(),
    }
}

/// In Auto-Rig Pro the pelvis is called `root` and has no children: thighs and trunk are children of controls.
#[test]
fn childless_pelvis_called_root_is_the_hips() {
    let mut rig = toy::body(auto_rig_pro);
    let hips = Vec3::from_array(toy::BODY[part("hips")].2);
    let floor = add_bare(&mut rig, "c_traj", None, Vec3::ZERO, Vec3::ZERO);
    let master = add_bare(&mut rig, "c_root_master.x", Some(floor), hips, Vec3::ZERO);
    hang(&mut rig, part("hips"), master, hips);
    hang(&mut rig, part("spine"), master, hips);
    ["leftUpperLeg", "rightUpperLeg"]
        .into_iter()
        .for_each(|leg| hang(&mut rig, part(leg), floor, Vec3::ZERO));
    kick(&mut rig);
    let sorted = in_order(&rig);
    let found = analyze(&sorted).expect("the rig has a skin");
    let joint = found.joint_with(Role::Hips).expect("hips");
    assert_eq!(sorted.joints[joint].name, "root.x", "{:?}", found.notes);
    let spine = found.joint_with(Role::Spine).expect("a spine");
    assert_eq!(sorted.joints[spine].name, "spine_01.x");
}

/// A character whose rest pose differs from its bind pose has a gun with many vertices in its hand: the body determines
/// the bind pose.
#[test]
fn gun_with_many_vertices_does_not_change_the_bind_pose() {
    let mut rig = toy::body(mixamo);
    for (name, turn) in [("rightUpperArm", 1.2), ("leftUpperArm", -1.2), ("rightLowerArm", -0.9)] {
        rig.joints[part(name)].rest.rotation = Rotation::from_axis_angle(Vec3::new(0.6, 0.8, 0.0), turn);
    }
    let slot = u16::try_from(part("rightHand")).expect("few");
    let place = Vec3::from_array(toy::BODY[part("rightHand")].2);
    let mut gun = Primitive::default();
    for piece in 0..30_u32 {
        let along = Vec3::Z * (0.01 * piece as f32);
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        gun.positions.extend(corners.map(|corner| place + along + corner * 0.02));
        gun.joints.extend([[slot, 0, 0, 0]; 4]);
        gun.weights.extend([[1.0, 0.0, 0.0, 0.0]; 4]);
        gun.indices.extend([0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2].map(|corner| 4 * piece + corner));
    }
    rig.meshes.push(RigMesh { name: "gun".into(), joint: 0, skin: Some(0), primitives: vec![gun] });
    let found = analyze(&rig).expect("the rig has a skin");
    assert!(found.humanoid, "{:?}", found.notes);
    for (joint, (name, _, at)) in toy::BODY.iter().enumerate() {
        let off = (found.bind_model[joint].translation - Vec3::from_array(*at)).length();
        assert!(off < 1e-3, "{name}: the bind position is off by {off} m");
    }
}

/// A character has one mesh per part, and a raised arm with one mesh of three bones: the trunk's mesh determines the
/// bind pose.
#[test]
fn separate_mesh_of_a_raised_arm_does_not_change_the_bind_pose() {
    let mut rig = toy::body(mixamo);
    rig.joints[part("rightUpperArm")].rest.rotation = Rotation::from_axis_angle(Vec3::Z, -1.2);
    let whole = rig.meshes.remove(0);
    let all = &whole.primitives[0];
    let arm = ["rightUpperArm", "rightLowerArm", "rightHand"].map(part);
    for owner in (0..toy::BODY.len()).filter(|owner| *owner == arm[0] || !arm.contains(owner)) {
        let is_own = |corner: u32| {
            let joint = usize::from(all.joints[corner as usize][0]);
            joint == owner || owner == arm[0] && arm.contains(&joint)
        };
        let mut primitive = all.clone();
        primitive.indices =
            all.indices.chunks_exact(3).filter(|corners| is_own(corners[0])).flatten().copied().collect();
        let used: Vec<usize> = (0..all.positions.len()).filter(|&at| is_own(at as u32)).collect();
        let place = |corner: &u32| used.iter().position(|&at| at == *corner as usize).expect("used") as u32;
        primitive.indices = primitive.indices.iter().map(place).collect();
        primitive.positions = used.iter().map(|&at| all.positions[at]).collect();
        primitive.normals.clear();
        primitive.joints = used.iter().map(|&at| all.joints[at]).collect();
        primitive.weights = used.iter().map(|&at| all.weights[at]).collect();
        rig.meshes.push(RigMesh { primitives: vec![primitive], ..whole.clone() });
    }
    let found = analyze(&rig).expect("the rig has a skin");
    for (joint, (name, _, at)) in toy::BODY.iter().enumerate() {
        let off = (found.bind_model[joint].translation - Vec3::from_array(*at)).length();
        assert!(off < 1e-3, "{name}: the bind position is off by {off} m");
    }
}
