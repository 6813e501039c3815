//! Settings: each setting changes the named parts, and nothing else.

use needs_data::needs_data;
use sinew_anim::{Joint, LocalTransform, Primitive, RigMesh, Role, analyze};
use sinew_math::{Range, Vec3};
use sinew_physics::{BodyDef, JointKind, Shape};
use sinew_ragdoll::settings::{BodyWish, BoneSettings, JointWish, ShapeWish, Unit, analyze_with};
use sinew_ragdoll::{
    BakeInput, BuildOptions, CharacterDef, Mapping, RagdollDef, RigMismatch, Settings, SettingsError, Sex,
    ShapeChoice, bake, build, build_with,
};
use sinew_scenes::mannequin::mannequin;
use std::sync::Arc;

fn with(settings: &Settings) -> Result<RagdollDef, SettingsError> {
    let rig = mannequin().rig;
    let analysis = analyze(&rig).expect("the rig has a skin");
    build_with(&rig, &analysis, &BuildOptions::default(), settings).map(|(def, _)| def)
}

fn of_bone(name: &str, bone: BoneSettings) -> Settings {
    Settings { bones: vec![(name.into(), bone)], ..Settings::default() }
}

fn plain() -> RagdollDef {
    let rig = mannequin().rig;
    let analysis = analyze(&rig).expect("the rig has a skin");
    build(&rig, &analysis, &BuildOptions::default()).expect("the rig can be built").0
}

fn body(def: &RagdollDef, role: &str) -> usize {
    def.bodies.iter().position(|body| body.role == role).unwrap_or_else(|| panic!("no {role}"))
}

#[test]
fn default_settings_change_nothing() {
    assert_eq!(with(&Settings::default()), Ok(plain()));
    // Settings equal to the defaults change nothing either.
    let settings = Settings { shapes: Some(ShapeChoice::Auto), sex: Some(Sex::Male), ..Settings::default() };
    assert_eq!(with(&settings), Ok(plain()));
}

#[test]
fn shape_settings_change_kind_and_size() {
    let sphere = BoneSettings { shape: Some(ShapeWish::Sphere), scale: Some(1.5), ..BoneSettings::default() };
    let box_ = BoneSettings { shape: Some(ShapeWish::Box), ..BoneSettings::default() };
    let mut settings = of_bone("head", sphere);
    settings.bones.push(("lowerArm".into(), box_));
    let (def, before) = (with(&settings).expect("the number fits"), plain());
    let shape = |def: &RagdollDef, role: &str| def.bodies[body(def, role)].shape.clone();
    assert!(matches!(shape(&def, "head"), Shape::Sphere { .. }), "{:?}", shape(&def, "head"));
    for role in ["leftLowerArm", "rightLowerArm"] {
        assert!(matches!(shape(&def, role), Shape::Box { .. }), "{role}");
    }
    assert_eq!(shape(&def, "leftFoot"), shape(&before, "leftFoot"));
    let smaller = with(&of_bone("head", BoneSettings { scale: None, ..sphere })).expect("the number fits");
    let (large, small) = (shape(&def, "head"), shape(&smaller, "head"));
    assert!((large.volume() / small.volume() - 3.375).abs() < 0.01, "{large:?} {small:?}");
}

#[test]
fn mass_settings_change_masses() {
    let heavy = BoneSettings { mass: Some(3.0), ..BoneSettings::default() };
    let (def, before) = (with(&of_bone("leftHand", heavy)).expect("the settings are valid"), plain());
    let hand = body(&def, "leftHand");
    let gained = 3.0 - before.bodies[hand].mass.mass;
    assert!((def.bodies[hand].mass.mass - 3.0).abs() < 1e-5);
    assert!((def.total_mass - before.total_mass - gained).abs() < 1e-3);
    let settings = Settings { mass: Some(60.0), ..of_bone("leftHand", heavy) };
    let def = with(&settings).expect("the settings are valid");
    assert!((def.total_mass - 60.0).abs() < 1e-3 && (def.bodies[hand].mass.mass - 3.0).abs() < 1e-5);
    let woman =
        with(&Settings { sex: Some(Sex::Female), ..Settings::default() }).expect("the settings are valid");
    let thigh = |def: &RagdollDef| def.bodies[body(def, "leftUpperLeg")].mass.mass / def.total_mass;
    assert!((thigh(&woman) - 0.1478).abs() < 2e-3, "{}", thigh(&woman));
}

#[test]
fn joints_of_both_sides_are_mirrored() {
    let twist = Some(Range::degrees(-50.0, 20.0));
    let swing_z = Some(Range::degrees(-30.0, 70.0));
    let bone = BoneSettings { twist, swing_z, friction_torque: Some(7.0), ..BoneSettings::default() };
    let (def, before) = (with(&of_bone("upperArm", bone)).expect("joins"), plain());
    let limit = |def: &RagdollDef, role: &str| match def.joints[body(def, role) - 1].kind {
        JointKind::Ball { limit: Some(limit) } => limit,
        kind => panic!("{kind:?}"),
    };
    let (left, right) = (limit(&def, "leftUpperArm"), limit(&def, "rightUpperArm"));
    assert_eq!((Some(left.twist), Some(left.swing_z)), (twist, swing_z));
    assert_eq!(right.twist, Range::new(-left.twist.hi, -left.twist.lo));
    assert_eq!(right.swing_z, Range::new(-left.swing_z.hi, -left.swing_z.lo));
    assert_eq!(left.swing_y, limit(&before, "leftUpperArm").swing_y);
    assert_eq!(def.joints[body(&def, "rightUpperArm") - 1].friction_torque, 7.0);
    let stiff = BoneSettings { joint: Some(JointWish::Fixed), ..BoneSettings::default() };
    let def = with(&of_bone("neck", stiff)).expect("joins");
    assert_eq!(def.joints[body(&def, "neck") - 1].kind, JointKind::Fixed);
}

/// Settings without effect used to be accepted.
#[test]
fn settings_without_effect_are_refused() {
    let wrong = |name: &str, bone: BoneSettings, total: Option<f32>| match with(&Settings {
        mass: total,
        ..of_bone(name, bone)
    }) {
        Err(SettingsError::Setting { what, place }) => format!("{what} ({place})"),
        other => panic!("{other:?}"),
    };
    let usual = BoneSettings::default();
    let range = Some(Range::degrees(-10.0, 10.0));
    let swings = wrong("lowerLeg", BoneSettings { swing_y: range, ..usual }, None);
    assert!(
        swings.contains("is a hinge") && swings.contains("(bones.lowerLeg.limits_deg.swing_y)"),
        "{swings}"
    );
    let root = wrong("hips", BoneSettings { friction_torque: Some(1.0), ..usual }, None);
    assert!(root.contains("is the first body"), "{root}");
    let stiff = BoneSettings { joint: Some(JointWish::Fixed), twist: range, ..usual };
    let stiff = wrong("head", stiff, None);
    assert!(stiff.contains("no limits"), "{stiff}");
    let heavy = wrong("head", BoneSettings { mass: Some(30.0), ..usual }, Some(20.0));
    assert!(heavy.contains("add up to 30 kg") && heavy.contains("(bones.head.mass)"), "{heavy}");
    let hinge = BoneSettings { swing_y: range, joint: Some(JointWish::Ball), ..usual };
    with(&of_bone("lowerLeg", hinge)).expect("a ball swings");
}

#[test]
fn bones_can_be_dropped_and_kept() {
    let rig = mannequin().rig;
    let analysis = analyze(&rig).expect("the rig has a skin");
    let before = plain();
    let drop = BoneSettings { body: Some(BodyWish::Drop), ..BoneSettings::default() };
    let def = with(&of_bone("leftLowerArm", drop)).expect("goes");
    assert_eq!(def.bodies.len() + 1, before.bodies.len());
    // The forearm moves with the upper arm, to which the hand is connected.
    let (arm, hand) = (body(&def, "leftUpperArm"), body(&def, "leftHand"));
    assert_eq!(def.joints[hand - 1].parent, arm);
    assert!(def.bodies[arm].merged.contains(&before.bodies[body(&before, "leftLowerArm")].joint));
    assert!((def.total_mass - before.total_mass).abs() < 1e-3);
    // The definition can be mapped to the rig.
    let _ = Mapping::new(&rig, &def, &analysis.bind_model);
    // A bone that is dropped by one setting and kept by a later one is unchanged.
    let keep = BoneSettings { body: Some(BodyWish::Keep), ..BoneSettings::default() };
    let mut settings = of_bone("leftHand", drop);
    assert_eq!(with(&settings).expect("goes").bodies.len() + 1, before.bodies.len());
    settings.bones.push(("leftHand".into(), keep));
    assert_eq!(with(&settings).expect("comes back"), before);
}

#[needs_data]
#[test]
fn merged_bone_can_be_kept() {
    let rig = crate::data::rig("mesh2motion_human_rigify.glb");
    let analysis = analyze(&rig).expect("the rig has a skin");
    let options = BuildOptions::default();
    let (before, _) = build(&rig, &analysis, &options).expect("the rig can be built");
    let merged = before.bodies.iter().flat_map(|body| body.merged.iter().map(move |&joint| (body, joint)));
    // Find a merged bone with skin of its own.
    let skinned = |joint: usize| rig.skins.iter().any(|skin| skin.joints.contains(&joint));
    let (carrier, joint) =
        merged.into_iter().find(|&(_, joint)| skinned(joint)).expect("twist or finger bones");
    let keep = BoneSettings { body: Some(BodyWish::Keep), ..BoneSettings::default() };
    let settings = of_bone(&rig.joints[joint].name, keep);
    let (def, _) = build_with(&rig, &analysis, &options, &settings).expect("stays");
    assert_eq!(def.bodies.len(), before.bodies.len() + 1);
    let new = def.bodies.iter().position(|body| body.joint == joint).expect("a body of its own");
    assert_eq!(def.bodies[def.joints[new - 1].parent].bone, carrier.bone);
    assert!(!def.bodies.iter().any(|body| body.merged.contains(&joint)));
}

/// A helmet without skin that gets a body of its own is fixed to the head.
#[test]
fn kept_rigid_mesh_is_fixed_to_its_carrier() {
    let mut rig = mannequin().rig;
    let head = rig.joints.iter().position(|joint| joint.name == "head").expect("the joint exists");
    let helmet = rig.joints.len();
    let rest = LocalTransform { translation: Vec3::Y * 0.1, ..LocalTransform::default() };
    rig.joints.push(Joint { name: "helmet".into(), parent: Some(head), rest, source: helmet });
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|corner| corner * 0.1).to_vec();
    let indices = [0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2].to_vec();
    let primitive = Primitive { positions, indices, ..Primitive::default() };
    rig.meshes.push(RigMesh { name: String::new(), joint: helmet, skin: None, primitives: vec![primitive] });
    let analysis = analyze(&rig).expect("the rig has a skin");
    let keep = BoneSettings { body: Some(BodyWish::Keep), ..BoneSettings::default() };
    let built = build_with(&rig, &analysis, &BuildOptions::default(), &of_bone("helmet", keep));
    let (def, _) = built.expect("the helmet gets a body");
    let new = def.bodies.iter().position(|body| body.joint == helmet).expect("a body of its own");
    assert_eq!(def.bodies[def.joints[new - 1].parent].role, "head");
    assert!(matches!(def.joints[new - 1].kind, JointKind::Fixed), "{:?}", def.joints[new - 1].kind);
}

/// A re-exported file has its joints at other indices; a definition finds them by name.
#[test]
fn definitions_find_their_bones_by_name() {
    let mut rig = mannequin().rig;
    let def = plain();
    assert_eq!(def.clone().for_rig(&rig), Ok(def.clone()));
    for joint in &mut rig.joints {
        joint.parent = Some(joint.parent.map_or(0, |parent| parent + 1));
    }
    let armature =
        Joint { name: "Armature".into(), parent: None, rest: LocalTransform::default(), source: 0 };
    rig.joints.insert(0, armature);
    let found = def.clone().for_rig(&rig).expect("all bones are there");
    for (old, new) in def.bodies.iter().zip(&found.bodies) {
        assert_eq!((new.joint, &rig.joints[new.joint].name), (old.joint + 1, &old.bone));
    }
    let hand = body(&def, "leftHand");
    rig.joints[found.bodies[hand].joint].name = "paw".into();
    let bone = def.bodies[hand].bone.clone();
    assert_eq!(def.clone().for_rig(&rig), Err(RigMismatch::NoBone { bone, body: hand }));
    let mut twice = def.clone();
    (twice.bodies[hand].bone, twice.bodies[hand].joint) = (def.bodies[0].bone.clone(), def.bodies[0].joint);
    assert!(matches!(twice.for_rig(&mannequin().rig), Err(RigMismatch::Twice { .. })));
}

#[test]
fn pair_settings_disable_and_enable_collisions() {
    let both = |a: &str, b: &str| vec![[a.to_owned(), b.to_owned()]];
    let settings = Settings { disable: both("leftHand", "upperLeg"), ..Settings::default() };
    let (def, before) = (with(&settings).expect("parts"), plain());
    let hand = body(&def, "leftHand");
    for thigh in ["leftUpperLeg", "rightUpperLeg"] {
        let thigh = body(&def, thigh);
        assert!(def.disabled_pairs.contains(&(usize::min(hand, thigh), usize::max(hand, thigh))));
    }
    let Some(&(a, b)) = before.disabled_pairs.first() else { return };
    let (one, other) = (&before.bodies[a].role, &before.bodies[b].role);
    let def = with(&Settings { enable: both(one, other), ..Settings::default() }).expect("meet");
    assert_eq!(def.disabled_pairs.len() + 1, before.disabled_pairs.len());
}

#[test]
fn unit_height_and_up_are_applied() {
    let before = plain();
    let tall = with(&Settings { unit: Some(Unit::Height(3.0)), ..Settings::default() }).expect("grows");
    assert!((tall.height - 3.0).abs() < 1e-4, "{}", tall.height);
    let scaled = Settings { unit: Some(Unit::Scale(2.0 * before.unit_scale)), ..Settings::default() };
    let scaled = with(&scaled).expect("grows");
    assert!((scaled.height - 2.0 * before.height).abs() < 1e-4);
    let lying = with(&Settings { up_axis: Some(Vec3::Z), ..Settings::default() }).expect("lies");
    // The ragdoll lies on its back, so its height is its former depth.
    assert!(lying.height < 0.5 * before.height, "{}", lying.height);
    let lowest = lying.bodies.iter().map(|body| body.shape.aabb(&body.character_from_body).min.y);
    assert!(lowest.fold(f32::INFINITY, sinew_math::min).abs() < 0.06, "the character is not on the floor");
}

#[test]
fn roles_and_ignored_bones_are_applied() {
    let of = |name: &str| mannequin().rig.joints.iter().position(|joint| joint.name == name).expect(name);
    let chest = BoneSettings { role: Some(Role::UpperChest), ..BoneSettings::default() };
    let (def, before) = (with(&of_bone("chest", chest)).expect("the body exists"), plain());
    assert_eq!(def.bodies[body(&def, "upperChest")].joint, of("chest"));
    assert_eq!((def.bodies.len(), def.total_mass), (before.bodies.len(), before.total_mass));
    assert!(def.bodies.iter().all(|body| body.role != "chest"));
    let hand = before.bodies[body(&before, "leftHand")].bone.clone();
    let def = with(&Settings { ignore: vec![hand.clone()], ..Settings::default() }).expect("the body exists");
    assert!(def.bodies.iter().all(|body| body.bone != hand && body.role != "leftHand"));
    let forearm = |def: &RagdollDef| def.bodies[body(def, "leftLowerArm")].shape.volume();
    assert!(forearm(&def) < 1.1 * forearm(&before), "the hand's skin must not affect the forearm's shape");
    // Applying settings to an analysis that already contains them changes nothing.
    let rig = mannequin().rig;
    let settings = Settings { unit: Some(Unit::Height(1.2)), ..of_bone("chest", chest) };
    let once =
        analyze_with(&rig, &analyze(&rig).expect("the rig has a skin"), &settings).expect("the body exists");
    assert_eq!(analyze_with(&rig, &once, &settings), Ok(once.clone()));
    let options = BuildOptions::default();
    let built = |analysis| build_with(&rig, analysis, &options, &settings).expect("the body exists").0;
    assert_eq!(built(&once), built(&analyze(&rig).expect("the rig has a skin")));
    assert!((once.height - 1.2).abs() < 1e-5, "{}", once.height);
}

/// With any roles from a user, the build gives a ragdoll that falls, or an error.
#[test]
fn any_roles_give_a_ragdoll_or_an_error() {
    let mut rigs = vec![mannequin().rig];
    if crate::data::is_there() {
        rigs.extend(["Fox.glb", "quaternius_Spider.glb", "RiggedSimple.glb"].map(crate::data::rig));
    }
    let mut random = sinew_math::Random::new(6);
    let (mut ragdolls, mut refusals) = (0, 0);
    for rig in &rigs {
        let analysis = analyze(rig).expect("the rig has a skin");
        for _ in 0..12 {
            let mut settings = Settings::default();
            for _ in 0..=random.index(3) {
                let role = match random.index(3) {
                    0 => Role::LimbSegment { limb: random.index(4) as u16, segment: random.index(3) as u16 },
                    1 => Role::SpineSegment(random.index(4) as u16),
                    _ => sinew_anim::roles::HUMANOID_ROLES[random.index(22)],
                };
                let name = rig.joints[random.index(rig.joints.len())].name.clone();
                settings.bones.push((name, BoneSettings { role: Some(role), ..BoneSettings::default() }));
            }
            if random.index(2) == 0 {
                settings.ignore.push(rig.joints[random.index(rig.joints.len())].name.clone());
            }
            let Ok((def, _)) = build_with(rig, &analysis, &BuildOptions::default(), &settings) else {
                refusals += 1;
                continue;
            };
            let analysis = analyze_with(rig, &analysis, &settings).expect("it was built");
            let character = CharacterDef::new(rig.clone(), def, &analysis.bind_model);
            let floor = [BodyDef::fixed(Shape::HalfSpace)];
            let input = BakeInput {
                bodies: &floor,
                limp_at: Some(0.0),
                seconds: 0.3,
                ..BakeInput::new(Arc::new(character))
            };
            assert_eq!(bake(&input).quality.nan, 0, "{settings:?}");
            ragdolls += 1;
        }
    }
    assert!(ragdolls > 0 && refusals > 0, "{ragdolls} {refusals}");
}

#[test]
fn invalid_setting_is_reported_with_its_place() {
    let place = |settings: &Settings| match with(settings) {
        Err(SettingsError::Setting { what, place }) => format!("{what} ({place})"),
        other => panic!("{other:?}"),
    };
    let scale = BoneSettings { scale: Some(2.0), ..BoneSettings::default() };
    let unknown = place(&of_bone("leftUperArm", scale));
    assert!(unknown.starts_with("no bone or role `leftUperArm`; the nearest of "), "{unknown}");
    assert!(
        unknown.contains(" are leftUpperArm, ") && unknown.ends_with(" (bones.leftUperArm)"),
        "{unknown}"
    );
    let drop = BoneSettings { body: Some(BodyWish::Drop), ..BoneSettings::default() };
    assert!(place(&of_bone("hips", drop)).ends_with("it cannot be dropped (bones.hips)"));
    let joined = vec![["hips".to_owned(), "leftUpperLeg".to_owned()]];
    let settings = Settings { enable: joined, ..Settings::default() };
    assert!(place(&settings).ends_with("they never collide (enable_pairs[0])"));
}
