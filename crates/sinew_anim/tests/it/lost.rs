//! Humans with one unusual part: low arms, a head beside the skeleton, arms without skin, legs that start
//! beside a hand, legs of one bone, hip bones, a head without skin.

use crate::toy;
use sinew_anim::legs::{Legs, add_ankles};
use sinew_anim::retarget::{Body, RetargetOptions, retarget};
use sinew_anim::{
    Channel, Clip, Interpolation, Primitive, Property, Rig, RigMesh, Role, Side, analyze, local_to_model,
};
use sinew_math::{Rotation, Vec3};

fn part(role: &str) -> usize {
    toy::BODY.iter().position(|(name, ..)| *name == role).expect("a part of the toy")
}

/// The toy body without meaningful names.
fn numbered() -> Rig {
    let mut rig = toy::body(|_| String::new());
    rig.joints.iter_mut().enumerate().for_each(|(i, joint)| joint.name = format!("Bone.{i:03}"));
    rig
}

/// Moves a joint to a place, with its skin scaled by `size`; its children stay where they are.
fn put(rig: &mut Rig, joint: usize, at: Vec3, size: f32) {
    let was = -rig.skins[0].inverse_bind[joint].translation;
    let own = &mut rig.meshes[0].primitives[0].positions[4 * joint..4 * joint + 4];
    own.iter_mut().for_each(|corner| *corner = at + (*corner - was) * size);
    rig.skins[0].inverse_bind[joint].translation = -at;
    rest_as_bound(rig);
}

fn rest_as_bound(rig: &mut Rig) {
    let bound: Vec<Vec3> = rig.skins[0].inverse_bind.iter().map(|bind| -bind.translation).collect();
    for (i, joint) in rig.joints.iter_mut().enumerate() {
        joint.rest.translation = bound[i] - joint.parent.map_or(Vec3::ZERO, |parent| bound[parent]);
    }
}

fn hang(rig: &mut Rig, joint: &str, parent: Option<&str>) {
    rig.joints[part(joint)].parent = parent.map(part);
    rest_as_bound(rig);
}

fn has_roles(rig: &Rig, roles: &[&str]) {
    let found = analyze(rig).expect("a skin");
    assert!(found.humanoid, "{:?}", found.notes);
    for name in roles {
        let role = Role::from_name(name).expect("a VRM name");
        let holder = found.joint_with(role).map(|joint| rig.joints[joint].name.as_str());
        assert_eq!(holder, Some(rig.joints[part(name)].name.as_str()), "{name}");
    }
}

/// Moves the joints of both legs one further down: a hip bone at `inner` from the midline, a thigh, a shank without a
/// foot.
fn with_hip_bones(rig: &mut Rig, inner: f32) {
    for (side, x) in [("left", 1.0), ("right", -1.0)] {
        let [hip, thigh, shank] = ["UpperLeg", "LowerLeg", "Foot"].map(|name| part(&format!("{side}{name}")));
        put(rig, hip, Vec3::new(inner * x, 0.95, 0.0), 1.0);
        put(rig, thigh, Vec3::new(0.1 * x, 0.93, 0.0), 1.0);
        put(rig, shank, Vec3::new(0.1 * x, 0.5, 0.0), 1.0);
        let low = rig.meshes[0].primitives[0].positions[4 * shank..4 * shank + 4].iter_mut();
        low.for_each(|corner| corner.y -= 0.4);
    }
}

fn has_legs_below_hip_bones(rig: &Rig) {
    let found = analyze(rig).expect("a skin");
    assert!(found.humanoid, "{:?}", found.notes);
    for side in [Side::Left, Side::Right] {
        let name = if side == Side::Left { "left" } else { "right" };
        let holds = |role: Role, joint: &str| {
            assert_eq!(found.joint_with(role), Some(part(&format!("{name}{joint}"))), "{role:?}");
        };
        holds(Role::UpperLeg(side), "LowerLeg");
        holds(Role::LowerLeg(side), "Foot");
    }
}

/// A machine without a head has its named neck and head without skin, and its limbs are asymmetric.
#[test]
fn named_head_without_skin_is_a_head() {
    let mut rig = toy::body(Role::name);
    let chest = u16::try_from(part("chest")).expect("few");
    let bare = ["neck", "head"].map(part);
    let slots = rig.meshes[0].primitives[0].joints.iter_mut();
    slots.filter(|slots| bare.contains(&usize::from(slots[0]))).for_each(|slots| slots[0] = chest);
    has_roles(&rig, &LONG);
    has_roles(&rig, &["hips", "head"]);
}

/// A foot directly on a leg of one bone belongs to that bone; knee and ankle are added.
#[test]
fn foot_on_a_leg_of_one_bone_gets_a_knee() {
    let mut rig = numbered();
    for (side, x) in [("left", 0.1), ("right", -0.1)] {
        let [thigh, shank, foot] =
            ["UpperLeg", "LowerLeg", "Foot"].map(|name| part(&format!("{side}{name}")));
        put(&mut rig, foot, Vec3::new(x, 0.05, 0.0), 0.5);
        let slots = rig.meshes[0].primitives[0].joints.iter_mut();
        slots.filter(|slots| usize::from(slots[0]) == shank).for_each(|slots| {
            slots[0] = u16::try_from(thigh).expect("few");
        });
        rig.joints[foot].parent = Some(thigh);
    }
    rest_as_bound(&mut rig);
    let mut found = analyze(&rig).expect("a skin");
    assert!(found.humanoid, "{:?}", found.notes);
    assert_eq!(add_ankles(&mut rig, &mut found), 2);
    let [thigh, foot] = ["leftUpperLeg", "leftFoot"].map(part);
    let place = |role: Role| found.bind_model[found.joint_with(role).expect("added")].translation;
    assert_eq!(found.joint_with(Role::UpperLeg(Side::Left)), Some(thigh));
    assert_eq!(found.merge_into[foot], Some(thigh));
    assert!((place(Role::Foot(Side::Left)) - found.bind_model[foot].translation).length() < 1e-4);
    assert!(Legs::of(&rig, &found).expect("legs").are_stiff(&rig));
}

/// Short hip bones beside the midline carry legs of two bones.
#[test]
fn short_sideways_bones_are_not_thighs() {
    let mut rig = numbered();
    with_hip_bones(&mut rig, 0.03);
    has_legs_below_hip_bones(&rig);
}

/// Both hip bones are roots and start at one place.
#[test]
fn legs_that_start_at_one_position_are_a_mirrored_pair() {
    let mut rig = numbered();
    with_hip_bones(&mut rig, 0.0);
    hang(&mut rig, "leftUpperLeg", None);
    hang(&mut rig, "rightUpperLeg", None);
    has_legs_below_hip_bones(&rig);
}

/// One forearm has no skin; its mirror image has.
#[test]
fn bone_without_skin_is_kept_if_its_mirror_image_has_skin() {
    let mut rig = numbered();
    let [upper, lower] = ["leftUpperArm", "leftLowerArm"].map(part);
    let slots = rig.meshes[0].primitives[0].joints.iter_mut();
    slots.filter(|slots| usize::from(slots[0]) == lower).for_each(|slots| {
        slots[0] = u16::try_from(upper).expect("few");
    });
    has_roles(&rig, &LONG);
}

const LONG: [&str; 8] = [
    "leftUpperArm",
    "rightUpperArm",
    "leftLowerArm",
    "rightLowerArm",
    "leftUpperLeg",
    "rightUpperLeg",
    "leftLowerLeg",
    "rightLowerLeg",
];

/// The arms are children of the pelvis.
#[test]
fn trunk_continues_above_arms_parented_to_the_pelvis() {
    let mut rig = numbered();
    hang(&mut rig, "leftUpperArm", Some("hips"));
    hang(&mut rig, "rightUpperArm", Some("hips"));
    has_roles(&rig, &LONG);
    has_roles(&rig, &["hips", "head"]);
}

/// The neck and the head have no skin; a mesh beside the skeleton, with its origin on the ground, surrounds them.
#[test]
fn head_beside_the_skeleton_is_the_skin_of_the_neck() {
    let mut rig = toy::body(Role::name);
    let (neck, head, chest) = (part("neck"), part("head"), part("chest"));
    rig.joints[head].name = "neck_end".into();
    let slots = &mut rig.meshes[0].primitives[0].joints;
    slots.iter_mut().filter(|slots| [neck, head].contains(&usize::from(slots[0]))).for_each(|slots| {
        slots[0] = u16::try_from(chest).expect("few");
    });
    for corner in 4 * neck..4 * head + 4 {
        rig.meshes[0].primitives[0].positions[corner] = Vec3::from_array(toy::BODY[chest].2);
    }
    let low = Vec3::new(-0.12, 1.48, -0.12);
    let cube = |i: u32| low + Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 0.24;
    let primitive = Primitive {
        positions: (0..8).map(cube).collect(),
        indices: [0, 1, 2, 1, 3, 2, 4, 6, 5, 5, 6, 7, 0, 4, 1, 1, 4, 5, 2, 3, 6, 3, 7, 6].to_vec(),
        ..Primitive::default()
    };
    let mut beside = rig.joints[0].clone();
    (beside.name, beside.rest.translation) = ("Cube".into(), Vec3::ZERO);
    rig.joints.push(beside);
    let joint = rig.joints.len() - 1;
    rig.meshes.push(RigMesh { name: "Cube".into(), joint, skin: None, primitives: vec![primitive] });
    let found = analyze(&rig).expect("a skin");
    assert!(found.humanoid, "{:?}", found.notes);
    assert_eq!(found.joint_with(Role::Head), Some(neck));
    assert_eq!(found.merge_into[joint], Some(neck), "the mesh moves with the neck");
}

/// A robe hides the arms: of all their bones only one hand has skin.
#[test]
fn arms_without_skin_keep_their_roles() {
    let mut rig = toy::body(Role::name);
    let chest = u16::try_from(part("chest")).expect("few");
    let bare = ["leftUpperArm", "leftLowerArm", "leftHand", "rightUpperArm", "rightLowerArm"].map(part);
    let slots = rig.meshes[0].primitives[0].joints.iter_mut();
    slots.filter(|slots| bare.contains(&usize::from(slots[0]))).for_each(|slots| slots[0] = chest);
    has_roles(&rig, &LONG);
}

/// Legs of two bones are trees of their own; the hands hang beside them, nearer than the pelvis.
#[test]
fn legs_beside_hands_are_not_attached_to_the_hands() {
    let mut rig = numbered();
    for (side, x) in [("left", 1.0), ("right", -1.0)] {
        put(&mut rig, part(&format!("{side}LowerArm")), Vec3::new(0.2 * x, 1.2, 0.0), 1.0);
        put(&mut rig, part(&format!("{side}Hand")), Vec3::new(0.19 * x, 0.9, 0.0), 1.0);
        let [thigh, shank] = ["UpperLeg", "LowerLeg"].map(|name| part(&format!("{side}{name}")));
        put(&mut rig, thigh, Vec3::new(0.1 * x, 0.9, 0.0), 1.6);
        put(&mut rig, shank, Vec3::new(0.1 * x, 0.4, 0.0), 1.6);
        rig.joints[thigh].parent = None;
        let (foot, slots) = (part(&format!("{side}Foot")), &mut rig.meshes[0].primitives[0].joints);
        for slots in slots.iter_mut().filter(|slots| usize::from(slots[0]) == foot) {
            slots[0] = u16::try_from(shank).expect("few");
        }
    }
    put(&mut rig, part("hips"), Vec3::Y * 1.05, 0.3);
    has_roles(&rig, &LONG);
}

/// The toy body with legs of one bone each.
fn stiff() -> Rig {
    let mut rig = toy::body(Role::name);
    for side in ["left", "right"] {
        let thigh = part(&format!("{side}UpperLeg"));
        for name in ["LowerLeg", "Foot"].map(|name| part(&format!("{side}{name}"))) {
            let slots = &mut rig.meshes[0].primitives[0].joints;
            let own = slots.iter_mut().filter(|slots| usize::from(slots[0]) == name);
            own.for_each(|slots| slots[0] = u16::try_from(thigh).expect("few"));
            rig.joints[name].name = format!("Bone.{name}");
        }
    }
    rig
}

#[test]
fn legs_of_one_bone_follow_the_line_from_hip_to_ankle() {
    let actor = toy::body(Role::name);
    let seen = analyze(&actor).expect("a skin");
    let mut rig = stiff();
    let mut found = analyze(&rig).expect("a skin");
    assert!(found.humanoid && found.joint_with(Role::LowerLeg(Side::Left)).is_none(), "{:?}", found.notes);
    assert_eq!(add_ankles(&mut rig, &mut found), 2);
    assert_eq!(add_ankles(&mut rig, &mut found), 0, "the ankles must not be added twice");
    assert!(Legs::of(&rig, &found).expect("legs").are_stiff(&rig));
    assert!(!Legs::of(&actor, &seen).expect("legs").are_stiff(&actor));
    // The actor bends its left knee by 120°, with its thigh 60° forward: hip, ankle and knee are a triangle of equal
    // sides.
    let turn = |joint: &str, angle: f32| Channel {
        joint: part(joint),
        property: Property::Rotation,
        interpolation: Interpolation::Linear,
        times: vec![0.0, 1.0],
        values: [Rotation::from_axis_angle(Vec3::X, angle); 2]
            .iter()
            .flat_map(|turn| [turn.x, turn.y, turn.z, turn.w])
            .collect(),
    };
    let sixty = 60.0_f32.to_radians();
    let clip = Clip {
        name: "kneel".into(),
        duration: 1.0,
        channels: vec![turn("leftUpperLeg", -sixty), turn("leftLowerLeg", 2.0 * sixty)],
    };
    let (from, to) = (Body { rig: &actor, analysis: &seen }, Body { rig: &rig, analysis: &found });
    let moved = retarget(from, &clip, to, &RetargetOptions::default()).expect("legs");
    let mut model = Vec::new();
    local_to_model(&rig, moved.take.pose(0), &found.character_from_file(), &mut model);
    let ankle = found.joint_with(Role::Foot(Side::Left)).expect("added");
    let [hip, knee, ankle] = [part("leftUpperLeg"), rig.joints[ankle].parent.expect("a knee"), ankle]
        .map(|joint| model[joint].translation);
    let [thigh, leg] = [knee - hip, ankle - hip].map(Vec3::normalize);
    assert!(thigh.dot(leg) > 0.999, "the leg is straight");
    assert!(leg.dot(-Vec3::Y) > 0.99, "from hip to ankle the actor's leg points down: {leg}");
}
