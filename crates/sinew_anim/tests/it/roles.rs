use crate::{rigs, toy};
use expect_test::{Expect, expect};
use needs_data::needs_data;
use sinew_anim::{Basis, LocalTransform, NoSkin, Rig, RigAnalysis, Role, Side, analyze};
use sinew_math::{Affine, Random, Rotation, Vec3};

/// Returns the bodies as lines of role, parent role, confidence and joint name, after a header line about the whole
/// body.
fn table(rig: &Rig, found: &RigAnalysis) -> String {
    let forward = found.character_from_model.rotation.inverse() * Vec3::Z;
    let kind = if found.humanoid { "humanoid" } else { "creature" };
    let mut out =
        format!("{kind}, {:.2} m, unit {}, forward {}\n", found.height, found.unit_scale, axis(forward));
    for bone in &found.kept {
        let parent = bone.parent.map_or("-".into(), |parent| found.kept[parent].role.name());
        let name = &rig.joints[bone.joint].name;
        let line = format!("{} < {parent} {:.2} {name}", bone.role.name(), bone.confidence);
        out += &format!("{}\n", line.trim_end());
    }
    out
}

/// Returns the signed axis nearest to a direction.
fn axis(v: Vec3) -> String {
    let axes = [("x", v.x), ("y", v.y), ("z", v.z)];
    let (name, value) = axes.into_iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).expect("three axes");
    format!("{}{name}", if value < 0.0 { "-" } else { "+" })
}

fn analyzed(file: &str) -> (Rig, RigAnalysis) {
    let (rig, _) = rigs::load(&format!("rigs/{file}"));
    let found = analyze(&rig).expect("a skin");
    sound(&rig, &found);
    (rig, found)
}

/// Checks invariants that hold for every analysis.
pub fn sound(rig: &Rig, found: &RigAnalysis) {
    let mut carried = vec![0; rig.joints.len()];
    for (i, bone) in found.kept.iter().enumerate() {
        assert_eq!(bone.parent.is_none(), i == 0, "one root, first");
        assert!(bone.parent.is_none_or(|parent| parent < i), "parents before children");
        assert!(bone.bind_model.is_finite() && (0.0..=1.0).contains(&bone.confidence));
        carried[bone.joint] += 1;
        for &joint in &bone.merged {
            carried[joint] += 1;
            assert_eq!(found.merge_into[joint], Some(bone.joint));
        }
    }
    assert!(carried.iter().all(|&times| times <= 1), "every joint must have at most one body");
    for (joint, _) in skinned_joints(rig) {
        assert_eq!(carried[joint], 1, "no body for the skin of joint {joint} ({})", rig.joints[joint].name);
    }
    assert!(found.unit_scale > 0.0 && found.height > 0.0);
}

/// Returns the joints with weights, and the sum of the weights of each.
fn skinned_joints(rig: &Rig) -> Vec<(usize, f32)> {
    let mut weight = vec![0.0; rig.joints.len()];
    for mesh in &rig.meshes {
        let Some(skin) = mesh.skin.map(|skin| &rig.skins[skin]) else { continue };
        for primitive in &mesh.primitives {
            for (slots, weights) in primitive.joints.iter().zip(&primitive.weights) {
                for (slot, w) in slots.iter().zip(weights) {
                    weight[skin.joints[usize::from(*slot)]] += w;
                }
            }
        }
    }
    weight.into_iter().enumerate().filter(|&(_, w)| w > 0.0).collect()
}

/// Checks a human body: all parts exist, on their sides and at their heights.
fn check_humanoid(file: &str, bodies: usize) {
    let (_, found) = analyzed(file);
    assert!(found.humanoid, "{file}");
    let of_the_body = found.kept.iter().filter(|bone| !bone.is_prop).count();
    assert_eq!(of_the_body, bodies, "{file}");
    assert!((0.5..3.0).contains(&found.height), "{file}: {} m", found.height);
    let place = |role: Role| {
        let joint = found.joint_with(role).unwrap_or_else(|| panic!("{file}: no {}", role.name()));
        found.character_from_file().point(found.bind_model[joint].translation)
    };
    let (hips, head) = (place(Role::Hips), place(Role::Head));
    assert!(head.y > hips.y + 0.2 * found.height, "{file}: head at {head}, hips at {hips}");
    for (side, sign) in [(Side::Left, 1.0), (Side::Right, -1.0)] {
        let chain = [Role::UpperArm(side), Role::LowerArm(side), Role::Hand(side)].map(place);
        assert!(chain.iter().all(|p| p.x * sign > 0.0), "{file}: left is on +X");
        assert!(
            chain[0].x * sign < chain[1].x * sign && chain[1].x * sign < chain[2].x * sign,
            "{file}: {chain:?}"
        );
        let chain = [Role::UpperLeg(side), Role::LowerLeg(side), Role::Foot(side)].map(place);
        assert!(chain.iter().all(|p| p.x * sign > 0.0), "{file}: left is on +X");
        assert!(chain[0].y > chain[1].y && chain[1].y > chain[2].y, "{file}: {chain:?}");
        assert!(chain[2].y - found.floor < 0.12 * found.height, "{file}: the feet must be on the floor");
    }
}

#[needs_data]
#[test]
fn human_shapes_are_recognised_with_both_sides_right() {
    for (file, bodies) in [
        ("CesiumMan.glb", 17),
        ("RiggedFigure.glb", 17),
        ("mannequiny.glb", 19),
        ("mesh2motion_human_rigify.glb", 20),
        ("kaykit_Knight.glb", 16),
        ("kaykit_mannequin/manny_med_mod.gltf", 16),
        ("quaternius_cyberpunk_Character.glb", 16),
        ("CoolLoops_mixamorig_vrm0.vrm", 18),
        ("quaternius_Robot.glb", 14),
    ] {
        check_humanoid(file, bodies);
    }
}

#[needs_data]
#[test]
fn forward_axis_follows_the_toes() {
    for (file, forward) in [
        ("CesiumMan.glb", "+z"),
        ("RiggedFigure.glb", "+z"),
        ("quaternius_cyberpunk_Character.glb", "+z"),
        ("CoolLoops_mixamorig_vrm0.vrm", "-z"),
        ("Fox.glb", "+z"),
    ] {
        let (_, found) = analyzed(file);
        assert_eq!(axis(found.character_from_model.rotation.inverse() * Vec3::Z), forward, "{file}");
    }
}

fn check(file: &str, expected: &Expect) {
    let (rig, found) = analyzed(file);
    expected.assert_eq(&table(&rig, &found));
}

#[needs_data]
#[test]
fn misleading_names_are_overruled_by_the_shape() {
    check(
        "CesiumMan.glb",
        &expect![[r#"
        humanoid, 1.51 m, unit 1, forward +z
        hips < - 0.80 Skeleton_torso_joint_1
        spine < hips 0.95 Skeleton_torso_joint_2
        chest < spine 0.95 torso_joint_3
        neck < chest 0.80 Skeleton_neck_joint_1
        head < neck 0.80 Skeleton_neck_joint_2
        leftUpperArm < chest 0.80 Skeleton_arm_joint_L__4_
        leftLowerArm < leftUpperArm 0.80 Skeleton_arm_joint_L__3_
        leftHand < leftLowerArm 0.80 Skeleton_arm_joint_L__2_
        rightUpperArm < chest 0.80 Skeleton_arm_joint_R
        rightLowerArm < rightUpperArm 0.80 Skeleton_arm_joint_R__2_
        rightHand < rightLowerArm 0.80 Skeleton_arm_joint_R__3_
        leftUpperLeg < hips 0.80 leg_joint_L_1
        leftLowerLeg < leftUpperLeg 0.80 leg_joint_L_2
        leftFoot < leftLowerLeg 0.80 leg_joint_L_3
        rightUpperLeg < hips 0.80 leg_joint_R_1
        rightLowerLeg < rightUpperLeg 0.80 leg_joint_R_2
        rightFoot < rightLowerLeg 0.80 leg_joint_R_3
    "#]],
    );
}

#[needs_data]
#[test]
fn separate_feet_and_a_joint_above_the_hips_are_handled() {
    check(
        "quaternius_cyberpunk_Character.glb",
        &expect![[r#"
            humanoid, 1.40 m, unit 1, forward +z
            hips < - 0.95 Hips
            spine < hips 0.95 Abdomen
            chest < spine 0.95 Torso
            upperChest < chest 0.95 Chest
            neck < upperChest 0.95 Neck
            head < neck 0.95 Head
            leftUpperArm < upperChest 0.95 UpperArm.L
            leftLowerArm < leftUpperArm 0.95 LowerArm.L
            leftHand < leftLowerArm 0.95 Hand.L
            rightUpperArm < upperChest 0.95 UpperArm.R
            rightLowerArm < rightUpperArm 0.95 LowerArm.R
            rightHand < rightLowerArm 0.95 Hand.R
            leftUpperLeg < hips 0.95 UpperLeg.L
            leftLowerLeg < leftUpperLeg 0.95 LowerLeg.L
            rightUpperLeg < hips 0.95 UpperLeg.R
            rightLowerLeg < rightUpperLeg 0.95 LowerLeg.R
        "#]],
    );
}

#[needs_data]
#[test]
fn fox_with_human_names_is_not_human() {
    check(
        "Fox.glb",
        &expect![[r#"
            creature, 0.79 m, unit 0.01, forward +z
            spine_0 < - 0.60 b_Hip_01
            spine_1 < spine_0 0.60 b_Spine01_02
            spine_2 < spine_1 0.60 b_Spine02_03
            spine_3 < spine_2 0.60 b_Neck_04
            spine_4 < spine_3 0.60 b_Head_05
            tail_0 < spine_0 0.60 b_Tail01_012
            tail_1 < tail_0 0.60 b_Tail02_013
            tail_2 < tail_1 0.60 b_Tail03_014
            limb_0_0 < spine_0 0.60 b_LeftLeg01_015
            limb_0_1 < limb_0_0 0.60 b_LeftLeg02_016
            limb_0_2 < limb_0_1 0.60 b_LeftFoot01_017
            limb_0_3 < limb_0_2 0.60 b_LeftFoot02_018
            limb_1_0 < spine_0 0.60 b_RightLeg01_019
            limb_1_1 < limb_1_0 0.60 b_RightLeg02_020
            limb_1_2 < limb_1_1 0.60 b_RightFoot01_021
            limb_1_3 < limb_1_2 0.60 b_RightFoot02_022
            limb_2_0 < spine_2 0.60 b_LeftUpperArm_09
            limb_2_1 < limb_2_0 0.60 b_LeftForeArm_010
            limb_2_2 < limb_2_1 0.60 b_LeftHand_011
            limb_3_0 < spine_2 0.60 b_RightUpperArm_06
            limb_3_1 < limb_3_0 0.60 b_RightForeArm_07
            limb_3_2 < limb_3_1 0.60 b_RightHand_08
        "#]],
    );
}

/// Protruding parts of the knight get their own bodies, attached to their carriers; the helmet is merged into the
/// head.
#[needs_data]
#[test]
fn props_of_the_knight_are_attached_to_their_carriers() {
    let (rig, found) = analyzed("kaykit_Knight.glb");
    let name = |joint: usize| rig.joints[joint].name.as_str();
    let props = found.kept.iter().filter(|bone| bone.is_prop);
    let held: Vec<_> = props
        .map(|prop| (name(prop.joint), name(found.kept[prop.parent.expect("a carrier")].joint)))
        .collect();
    assert_eq!(held, [("handslot.l", "wrist.l"), ("handslot.r", "wrist.r"), ("Knight_Cape", "chest")]);
    let helmet = rig.joints.iter().position(|joint| joint.name == "Knight_Helmet").expect("a helmet");
    assert_eq!(found.merge_into[helmet].map(name), Some("head"));
}

#[needs_data]
#[test]
fn separate_feet_of_a_spider_join_its_legs() {
    check(
        "quaternius_Spider.glb",
        &expect![[r#"
            creature, 1.95 m, unit 1, forward +z
            spine_0 < - 0.60 Abdomen
            spine_1 < spine_0 0.60 Thorax
            spine_2 < spine_1 0.60 Head
            limb_0_0 < spine_1 0.60 BackLeg.L
            limb_0_1 < limb_0_0 0.60 BackLeg2.L
            limb_0_2 < limb_0_1 0.60 BackLeg3.L
            limb_1_0 < spine_1 0.60 BackLeg.R
            limb_1_1 < limb_1_0 0.60 BackLeg2.R
            limb_1_2 < limb_1_1 0.60 BackLeg3.R
            limb_2_0 < spine_2 0.60 MidBackLeg.L
            limb_2_1 < limb_2_0 0.60 MidBackLeg2.L
            limb_2_2 < limb_2_1 0.60 MidBackLeg3.L
            limb_3_0 < spine_2 0.60 MidBackLeg.R
            limb_3_1 < limb_3_0 0.60 MidBackLeg2.R
            limb_3_2 < limb_3_1 0.60 MidBackLeg3.R
            limb_4_0 < spine_2 0.60 MidFrontLeg.L
            limb_4_1 < limb_4_0 0.60 MidFrontLeg2.L
            limb_4_2 < limb_4_1 0.60 MidFrontLeg3.L
            limb_5_0 < spine_2 0.60 MidFrontLeg.R
            limb_5_1 < limb_5_0 0.60 MidFrontLeg2.R
            limb_5_2 < limb_5_1 0.60 MidFrontLeg3.R
            limb_6_0 < spine_2 0.60 FrontLeg.L
            limb_6_1 < limb_6_0 0.60 FrontLeg2.L
            limb_6_2 < limb_6_1 0.60 FrontLeg3.L
            limb_7_0 < spine_2 0.60 FrontLeg.R
            limb_7_1 < limb_7_0 0.60 FrontLeg2.R
            limb_7_2 < limb_7_1 0.60 FrontLeg3.R
        "#]],
    );
}

#[needs_data]
#[test]
fn chain_without_limbs_is_all_trunk() {
    check(
        "quaternius_MandarinFish.glb",
        &expect![[r#"
        creature, 1.95 m, unit 1, forward +z
        spine_0 < - 0.60 Main1
        spine_1 < spine_0 0.60 Main2
        spine_2 < spine_1 0.60 Main3
        spine_3 < spine_2 0.60 Main4
        spine_4 < spine_3 0.60 Main5
        spine_5 < spine_4 0.60 Main6
    "#]],
    );
    check(
        "RiggedSimple.glb",
        &expect![[r#"
            creature, 9.15 m, unit 1, forward +z
            spine_0 < - 0.60
            spine_1 < spine_0 0.60
        "#]],
    );
    check(
        "SimpleSkin.gltf",
        &expect![[r#"
            creature, 2.00 m, unit 1, forward +z
            spine_0 < - 0.60
            spine_1 < spine_0 0.60
        "#]],
    );
}

#[needs_data]
#[test]
fn many_skeletons_in_one_file_are_analysed() {
    let (_, found) = analyzed("RecursiveSkeletons.glb");
    assert!(!found.humanoid);
}

/// Returns the rig in another frame: every root is rotated and scaled.
fn placed(rig: &Rig, turn: Rotation, scale: f32) -> Rig {
    let mut rig = rig.clone();
    for joint in rig.joints.iter_mut().filter(|joint| joint.parent.is_none()) {
        joint.rest = LocalTransform {
            translation: turn * joint.rest.translation * scale,
            rotation: (turn * joint.rest.rotation).normalize(),
            scale: joint.rest.scale * scale,
        };
    }
    rig
}

fn shuffled(rig: &Rig, seed: u64) -> Rig {
    let mut rig = rig.clone();
    let mut random = Random::new(seed);
    for i in (1..rig.joints.len()).rev() {
        let j = random.index(i + 1);
        let name = std::mem::take(&mut rig.joints[i].name);
        let name = std::mem::replace(&mut rig.joints[j].name, name);
        rig.joints[i].name = name;
    }
    rig
}

#[needs_data]
#[test]
fn names_size_and_axes_of_the_file_do_not_change_the_roles() {
    let z_up = Rotation::from_axis_angle(Vec3::X, std::f32::consts::FRAC_PI_2);
    for file in ["CesiumMan.glb", "RiggedFigure.glb", "mannequiny.glb", "mesh2motion_human_rigify.glb"] {
        let (rig, plain) = analyzed(file);
        for seed in 0..5 {
            let other = shuffled(&placed(&rig, z_up, 100.0), seed);
            let found = analyze(&other).expect("a skin");
            sound(&other, &found);
            let kept = |found: &RigAnalysis| {
                found.kept.iter().map(|b| (b.joint, b.role, b.parent)).collect::<Vec<_>>()
            };
            assert_eq!(kept(&found), kept(&plain), "{file}, seed {seed}: {:?}", found.notes);
            assert!((found.height / plain.height - 1.0).abs() < 1e-3, "{file}: {} m", found.height);
            assert_eq!(found.unit_scale, 0.01);
            assert!((found.up_axis - Vec3::Z).length() < 1e-6, "{file}");
            for (a, b) in found.kept.iter().zip(&plain.kept) {
                let p = found.character_from_file().point(a.bind_model.translation);
                let q = plain.character_from_file().point(b.bind_model.translation);
                assert!((p - q).length() < 1e-3, "{file}: {} is at {p} and at {q}", a.role.name());
            }
        }
    }
}

#[needs_data]
#[test]
fn rotated_character_keeps_its_left_hand() {
    let (rig, _) = analyzed("mannequiny.glb");
    let about = placed(&rig, Rotation::from_axis_angle(Vec3::Y, std::f32::consts::PI), 1.0);
    let found = analyze(&about).expect("a skin");
    assert_eq!(axis(found.character_from_model.rotation.inverse() * Vec3::Z), "-z");
    let left = found.joint_with(Role::Hand(Side::Left)).expect("a left hand");
    assert_eq!(about.joints[left].name, "hand.l");
}

#[test]
fn a_body_without_names_is_recognised() {
    let rig = toy::body(|_| String::new());
    let found = analyze(&rig).expect("a skin");
    sound(&rig, &found);
    let mut expected = String::from("humanoid, 1.76 m, unit 1, forward +z\n");
    for (name, parent, _) in toy::BODY {
        expected += &format!("{name} < {} 0.80\n", if parent.is_empty() { "-" } else { parent });
    }
    // Bodies are in the order of roles, which is also the order of the toy's joints.
    assert_eq!(table(&rig, &found), expected);
    assert!(found.roles.iter().flatten().all(|guess| guess.basis == Basis::Shape));
    let named = analyze(&toy::body(Role::name)).expect("a skin");
    assert!(named.roles.iter().flatten().all(|guess| guess.basis == Basis::ShapeAndName));
}

#[test]
fn names_decide_where_the_shape_is_asymmetric() {
    let mut rig = toy::body(Role::name);
    for (joint, (name, ..)) in toy::BODY.iter().enumerate() {
        // The right arm is bound straight up and twice as long, so that mirror symmetry does not find it.
        if name.starts_with("rightLowerArm") || name.starts_with("rightHand") {
            rig.skins[0].inverse_bind[joint].translation += Vec3::new(-0.3, -0.6, 0.0);
        }
    }
    let found = analyze(&rig).expect("a skin");
    sound(&rig, &found);
    assert!(found.humanoid, "{:?}", found.notes);
    for (joint, (name, ..)) in toy::BODY.iter().enumerate() {
        assert_eq!(found.roles[joint].map(|guess| guess.role.name()).as_deref(), Some(*name));
        assert!(found.roles[joint].is_some_and(|guess| guess.confidence < 0.7 && guess.basis == Basis::Name));
    }
}

#[test]
fn consistent_names_override_the_feet_with_a_note() {
    let rig = toy::body(|role| role.mirror().name());
    let found = analyze(&rig).expect("a skin");
    for (joint, guess) in found.roles.iter().enumerate() {
        assert_eq!(guess.map(|guess| guess.role.name()).as_deref(), Some(rig.joints[joint].name.as_str()));
    }
    assert!(found.notes.iter().any(|note| note.contains("is in doubt")), "{:?}", found.notes);
}

#[test]
fn roles_stated_by_the_file_are_used() {
    let mut rig = toy::body(|_| "x".into());
    rig.stated_roles =
        toy::BODY.iter().enumerate().map(|(joint, (name, ..))| ((*name).into(), joint)).collect();
    let found = analyze(&rig).expect("a skin");
    assert!(found.kept.iter().all(|bone| bone.confidence == 1.0));
    assert!(found.roles.iter().flatten().all(|guess| guess.basis == Basis::Stated));
    assert_eq!(found.kept.len(), toy::BODY.len());
}

#[needs_data]
#[test]
fn rig_without_skin_is_rejected_by_the_analysis() {
    assert_eq!(analyze(&Rig::default()), Err(NoSkin));
    let (rig, _) = rigs::load("negative/kenney_character_unskinned.glb");
    assert_eq!(analyze(&rig), Err(NoSkin));
    assert_eq!(NoSkin.to_string(), "no skin: nothing to build a ragdoll from");
}

#[needs_data]
#[test]
fn bind_pose_comes_from_the_skin() {
    let (rig, plain) = analyzed("mannequiny.glb");
    // The arms of the rest pose are bent; the skin still gives the bind pose.
    let mut bent = rig.clone();
    for joint in bent.joints.iter_mut().filter(|joint| joint.name.starts_with("upperarm")) {
        joint.rest.rotation = (joint.rest.rotation * Rotation::from_axis_angle(Vec3::X, 1.0)).normalize();
    }
    let found = analyze(&bent).expect("a skin");
    let moved = |(a, b): (&Affine, &Affine)| (a.translation - b.translation).length();
    let worst = found.bind_model.iter().zip(&plain.bind_model).map(moved).fold(0.0, sinew_math::max);
    assert!(worst < 1e-4, "{worst}");
    assert_eq!(found.kept, plain.kept);
}

#[test]
fn role_names_round_trip() {
    let generic = [Role::SpineSegment(3), Role::TailSegment(0), Role::LimbSegment { limb: 2, segment: 11 }];
    for role in sinew_anim::roles::HUMANOID_ROLES.into_iter().chain(generic) {
        assert_eq!(Role::from_name(&role.name()), Some(role));
        assert_eq!(role.mirror().mirror(), role);
        assert_eq!(role.is_left(), role.mirror().is_right());
    }
    for wrong in ["", "leftfoot", "spine_", "spine_x", "limb_1", "limb_1_2_3", "tail_-1", "spine_99999"] {
        assert_eq!(Role::from_name(wrong), None, "{wrong}");
    }
}

/// Returns the joint names of the limbs of a creature (each from the trunk outward) and of its trunk.
fn limbs_of(file: &str) -> (Vec<Vec<String>>, Vec<String>) {
    let options = sinew_formats::ReadOptions::default();
    let rig = sinew_formats::load_gltf(format!("{}{file}", rigs::DATA), options).expect("a rig").rig;
    let found = analyze(&rig).expect("a skin");
    assert!(!found.humanoid, "{file}");
    let mut limbs: Vec<Vec<String>> = Vec::new();
    let mut trunk = Vec::new();
    for bone in &found.kept {
        let name = rig.joints[bone.joint].name.clone();
        match bone.role {
            Role::LimbSegment { limb, .. } => {
                let limb = usize::from(limb);
                limbs.resize(limbs.len().max(limb + 1), Vec::new());
                limbs[limb].push(name);
            }
            _ => trunk.push(name),
        }
    }
    (limbs, trunk)
}

/// Frogs, rats and dinosaurs have feet outside the leg hierarchy, hips and back beside the shoulders, or roots
/// without skin.
#[needs_data]
#[test]
fn limbs_and_trunk_of_animals_are_found() {
    let side = |part: &str, side: &str| format!("{part}.{side}");
    for (file, legs, trunk) in [
        (
            "rigs_wild/easy_enemies_Frog.glb",
            [
                &["BackLeg", "BackUpLeg", "BackLowLeg", "BackFoot"],
                &["FrontUpLeg", "FrontLowLeg", "FrontFoot"][..],
            ],
            &["Shoulders", "Neck", "Head", "Hips"][..],
        ),
        (
            "rigs_wild/easy_enemies_Rat.glb",
            [
                &["BackLeg", "BackUpLeg", "BackLowLeg", "BackFoot"],
                &["FrontLeg", "FrontUpLeg", "FrontLowLeg", "FrontFoot"],
            ],
            &["Body", "Shoulders", "Neck", "Head", "Back", "Tail1", "Tail6"],
        ),
        (
            "rigs_wild/dinosaurs_Velociraptor.glb",
            [
                &["BackLeg", "BackUpLeg", "BackLowLeg", "BackFoot"],
                &["FrontLeg", "FrontUpLeg", "FrontLowLeg", "FrontFoot"],
            ],
            &["Hips", "Torso", "Shoulders", "Neck", "Head", "Back", "Tail1", "Tail5"],
        ),
        (
            "rigs_wild/dinosaurs_Stegosaurus.glb",
            [&["BackLeg", "BackUpLeg", "BackLowLeg", "BackFoot"], &["FrontLeg", "FrontUpLeg", "FrontLowLeg"]],
            &["Body", "Torso", "Shoulders", "Neck", "Head", "Back", "Tail1", "Tail5"],
        ),
        (
            "rigs_wild/dinosaurs_Parasaurolophus.glb",
            [
                &["BackLeg", "BackUpLeg", "BackLowLeg", "BackFoot"],
                &["FrontLeg", "FrontUpLeg", "FrontLowLeg", "FrontFoot"],
            ],
            &["Hips", "Torso", "Shoulders", "Neck", "Head", "Back", "Tail1", "Tail5"],
        ),
    ] {
        let (limbs, middle) = limbs_of(file);
        for part in trunk {
            assert!(
                middle.iter().any(|name| name == part),
                "{file}: {part} is in the trunk: {middle:?}, limbs {limbs:?}"
            );
        }
        for (leg, of) in legs.into_iter().flat_map(|leg| [(leg, "L"), (leg, "R")]) {
            let wanted: Vec<String> = leg.iter().map(|part| side(part, of)).collect();
            let other = if of == "L" { ".R" } else { ".L" };
            let is_leg = |limb: &&Vec<String>| wanted.iter().all(|part| limb.contains(part));
            let found = limbs
                .iter()
                .find(is_leg)
                .unwrap_or_else(|| panic!("{file}: no limb like {wanted:?} in {limbs:?}"));
            assert!(found.iter().all(|name| !name.ends_with(other)), "{file}: {found:?}");
            assert!(found.len() <= 5, "{file}: the limb has more joints than a leg: {found:?}");
        }
    }
}

/// In monsters with head and body on one line, no joint above or below the root is a limb.
#[needs_data]
#[test]
fn joints_on_the_midline_are_no_limbs() {
    for file in ["rigs_wild/platformer_game_Enemy.glb", "rigs_wild/platformer_game_Crab.glb"] {
        let (limbs, trunk) = limbs_of(file);
        assert!(limbs.is_empty() && trunk.len() == 4, "{file}: limbs {limbs:?}, trunk {trunk:?}");
    }
}
