//! The verdict on the skin: each metric on a mannequin with only one defect, and on other rigs.

use crate::data::document;
use needs_data::needs_data;
use sinew_anim::{Joint, LocalTransform, Primitive, Rig, RigAnalysis, RigMesh, Role, analyze};
use sinew_math::{Affine, Rotation, Transform, Vec3};
use sinew_physics::Shape;
use sinew_ragdoll::build::takes;
use sinew_ragdoll::doctor::Code;
use sinew_ragdoll::quality::Fallen;
use sinew_ragdoll::skin::Stage;
use sinew_ragdoll::{
    BuildOptions, Flaw, FlawKind, Mapping, RagdollDef, Repair, SkinMeter, SkinQuality, Verdict, build,
    doctor, drop_test, measure_skin,
};
use sinew_scenes::mannequin::mannequin;

struct Subject {
    rig: Rig,
    analysis: RigAnalysis,
    def: RagdollDef,
}

impl Subject {
    fn mannequin() -> Self {
        Self::of(mannequin().rig)
    }

    fn of(rig: Rig) -> Self {
        let analysis = analyze(&rig).expect("the rig has a skin");
        let (def, _) = build(&rig, &analysis, &BuildOptions::default()).expect("the rig can be built");
        Self { rig, analysis, def }
    }

    /// Returns the skin quality over these falls.
    fn over(&self, falls: &[Fallen]) -> SkinQuality {
        measure_skin(&self.rig, &self.def, &self.analysis.bind_model, &[], falls)
    }

    fn flaws(&self, falls: &[Fallen]) -> Vec<Flaw> {
        self.over(falls).flaws(&self.def)
    }

    fn body(&self, role: &str) -> usize {
        self.def.bodies.iter().position(|body| body.role == role).unwrap_or_else(|| panic!("no {role}"))
    }

    /// Returns a fall that ends in the bind pose, `height` metres above the floor.
    fn lifted(&self, height: f32) -> Vec<Fallen> {
        let up = Transform::from_translation(Vec3::Y * height);
        let mut fall = Fallen::default();
        fall.poses.push(self.def.bodies.iter().map(|body| up * body.character_from_body).collect());
        vec![fall]
    }
}

fn kinds(flaws: &[Flaw]) -> Vec<FlawKind> {
    flaws.iter().map(|flaw| flaw.kind).collect()
}

#[test]
fn mannequin_skin_has_no_flaw() {
    let subject = Subject::mannequin();
    let tested = drop_test(&subject.def);
    assert_eq!(tested.falls.len(), 8);
    let skin = subject.over(&tested.falls);
    assert_eq!(skin.flaws(&subject.def), []);
    assert!(skin.covered_share > 0.99 && skin.contiguous, "{skin:?}");
    assert!((skin.bind_height_m - subject.def.height).abs() < 0.01, "{skin:?}");
    assert!((skin.drawn_height_m - skin.bind_height_m).abs() < 1e-3, "{skin:?}");
    // The skin is on the floor, not above it.
    assert!(skin.rest_height_m.is_some_and(|height| (-0.06..0.01).contains(&height)), "{skin:?}");
    assert!(skin.edge_stretch_max > 0.0 && skin.edge_stretch_max >= skin.edge_stretch_p999, "{skin:?}");
    assert_eq!(skin, subject.over(&tested.falls), "the sample must be deterministic");
}

/// In the bind pose nothing is stretched, and the soles are on the floor.
#[test]
fn bind_pose_has_no_stretch() {
    let subject = Subject::mannequin();
    let skin = subject.over(&subject.lifted(0.0));
    assert!(
        skin.edge_stretch_max < 1e-3 && skin.rest_height_m.is_some_and(|height| height.abs() < 1e-3),
        "{skin:?}"
    );
}

/// Vertices of a hand weighted to a joint outside of the body stay behind.
#[test]
fn torn_skin_is_reported() {
    let mut subject = Subject::mannequin();
    let hand = subject.def.bodies[subject.body("leftHand")].joint;
    let stray = subject.rig.joints.len();
    let rest = LocalTransform::default();
    subject.rig.joints.push(Joint { name: "stray".into(), parent: None, rest, source: stray });
    subject.analysis.bind_model.push(Affine::IDENTITY);
    for skin in &mut subject.rig.skins {
        if let Some(slot) = skin.joints.iter().position(|&joint| joint == hand) {
            // The joint is bound at the hand, so the vertices are at their correct positions until a joint moves.
            skin.inverse_bind[slot] = subject.analysis.bind_model[hand] * skin.inverse_bind[slot];
            skin.joints[slot] = stray;
        }
    }
    let skin = subject.over(&drop_test(&subject.def).falls);
    assert!(skin.worst.adrift > 0 && skin.worst.torn.is_some(), "{skin:?}");
    assert!(skin.edge_stretch_max > 0.3, "{skin:?}");
    let flaws = skin.flaws(&subject.def);
    assert!(kinds(&flaws).contains(&FlawKind::Torn), "{flaws:?}");
    let torn = flaws.iter().find(|flaw| flaw.kind == FlawKind::Torn).expect("torn");
    assert!(torn.evidence.contains("leftLowerArm"), "{}", torn.evidence);
    // The doctor reports the flaw with a remedy, and does not claim a repair.
    let found = doctor(&Repair { skin: flaws, ..Repair::new(subject.def) });
    let finding =
        found.iter().find(|finding| finding.code == Code::SkinTorn).expect("the doctor reports a finding");
    assert!(!finding.fix.is_empty() && !finding.fixed, "{finding:?}");
}

#[test]
fn floating_and_sunk_meshes_are_reported() {
    let subject = Subject::mannequin();
    for (height, expected) in
        [(0.5, vec![FlawKind::OffFloor]), (-0.3, vec![FlawKind::OffFloor]), (0.02, vec![])]
    {
        let falls = subject.lifted(height);
        let skin = subject.over(&falls);
        assert!(skin.rest_height_m.is_some_and(|found| (found - height).abs() < 1e-3), "{height}: {skin:?}");
        let flaws = skin.flaws(&subject.def);
        assert_eq!(kinds(&flaws), expected, "{height}");
        // A mesh half a metre above the floor is unusable.
        let is_bad = flaws.iter().any(|flaw| flaw.at_most == Verdict::Bad);
        assert_eq!(is_bad, height > 0.4, "{height}");
        // The remedy names the setting and its direction.
        for flaw in flaws {
            let way = if height > 0.0 { "below 1 of" } else { "above 1 of" };
            assert!(flaw.remedy.contains("`scale`") && flaw.remedy.contains(way), "{flaw}");
        }
    }
    let mut falls = subject.lifted(0.0);
    falls[0].airborne_s = 0.5;
    assert_eq!(kinds(&subject.flaws(&falls)), [FlawKind::Airborne]);
}

#[test]
fn asymmetric_body_is_reported() {
    let mut subject = Subject::mannequin();
    let arm = subject.body("leftUpperArm");
    let sound = subject.over(&[]).symmetry_error_m;
    assert!(sound < 1e-3, "{sound}");
    subject.def.bodies[arm].mass.mass *= 3.0;
    let skin = subject.over(&[]);
    // The metric is a third of the relative difference of the masses (2/3), as a length.
    let radius = subject.def.bodies[arm].shape.bounding_radius();
    assert!((skin.symmetry_error_m - radius * 2.0 / 9.0).abs() < 1e-3, "{skin:?}");
    subject.def.bodies[arm].shape = Shape::Sphere { radius: 0.4 };
    let flaws = subject.flaws(&[]);
    assert!(kinds(&flaws).contains(&FlawKind::Lopsided), "{flaws:?}");
    // Test a part without a counterpart.
    let mut subject = Subject::mannequin();
    let hand = subject.body("rightHand");
    subject.def.bodies[hand].role = "limb_0_0".into();
    assert!(kinds(&subject.flaws(&[])).contains(&FlawKind::Lopsided));
}

#[test]
fn uncovered_skin_is_reported() {
    let mut subject = Subject::mannequin();
    let thigh = subject.body("leftUpperLeg");
    let chest = subject.body("hips");
    for body in [thigh, chest] {
        subject.def.bodies[body].character_from_body.translation += Vec3::Z * 2.0;
    }
    let skin = subject.over(&[]);
    assert!(skin.covered_share < 0.95, "{skin:?}");
    assert!([Some(thigh), Some(chest)].contains(&skin.worst.uncovered), "{skin:?}");
    assert!(kinds(&skin.flaws(&subject.def)).contains(&FlawKind::Uncovered));
}

#[test]
fn foot_attached_to_the_pelvis_is_reported() {
    let mut subject = Subject::mannequin();
    let foot = subject.body("leftFoot");
    subject.def.joints[foot - 1].parent = 0;
    let flaws = subject.flaws(&[]);
    assert_eq!(kinds(&flaws), [FlawKind::Apart]);
    assert!(flaws[0].evidence.starts_with("leftFoot"), "{}", flaws[0].evidence);
}

/// The nodes scale the skin differently from its bind matrices.
#[test]
fn character_drawn_in_another_size_is_reported() {
    let mut subject = Subject::mannequin();
    for joint in subject.rig.joints.iter_mut().filter(|joint| joint.parent.is_none()) {
        joint.rest.scale *= 1.1;
    }
    let skin = subject.over(&[]);
    assert!((skin.drawn_height_m / skin.bind_height_m - 1.1).abs() < 0.03, "{skin:?}");
    assert!(kinds(&skin.flaws(&subject.def)).contains(&FlawKind::Resized));
}

/// Ears that are bound upright and drawn lying on the head change the height of the skin, not its size.
#[test]
fn ears_bound_in_another_pose_do_not_change_its_size() {
    let mut rig = mannequin().rig;
    let analysis = analyze(&rig).expect("the rig has a skin");
    let head = analysis.joint_with(Role::Head).expect("a head");
    let slot = rig.skins[0].joints.iter().position(|&joint| joint == head).expect("the joint moves skin");
    let (ears, source) = (rig.skins[0].joints.len(), rig.joints.len());
    grown(&mut rig, Role::Head, Vec3::Y * 0.25, Vec3::new(0.05, 0.12, 0.02));
    let lying =
        LocalTransform { rotation: Rotation::from_axis_angle(Vec3::X, 1.5), ..LocalTransform::default() };
    rig.joints.push(Joint { name: "ears".into(), parent: Some(head), rest: lying, source });
    let inverse_bind = rig.skins[0].inverse_bind[slot];
    rig.skins[0].joints.push(source);
    rig.skins[0].inverse_bind.push(inverse_bind);
    let ear = u16::try_from(ears).expect("the count fits");
    let grown = rig.meshes.last_mut().expect("it has just grown");
    grown.primitives[0].joints.iter_mut().for_each(|joints| joints[0] = ear);
    let subject = Subject::of(rig);
    let flaws = subject.flaws(&[]);
    assert!(!kinds(&flaws).contains(&FlawKind::Resized), "{flaws:?}");
}

/// A fall may stretch the skin half as much again as the animation does.
#[test]
fn stretch_of_the_clips_is_allowed() {
    let subject = Subject::mannequin();
    let torn = SkinQuality { edge_stretch_p999: 0.14, edge_stretch_max: 0.5, ..subject.over(&[]) };
    assert_eq!(kinds(&torn.flaws(&subject.def)), [FlawKind::Torn]);
    let clips = SkinQuality { clips_stretch_p999: Some(0.1), clips_stretch_max: Some(0.2), ..torn.clone() };
    assert_eq!(kinds(&clips.flaws(&subject.def)), []);
    let less = SkinQuality { clips_stretch_p999: Some(0.09), ..clips };
    assert_eq!(kinds(&less.flaws(&subject.def)), [FlawKind::Torn]);
    assert_eq!(SkinQuality::verdict(&less.flaws(&subject.def), Verdict::Good), Verdict::Usable);
    assert_eq!(SkinQuality::verdict(&less.flaws(&subject.def), Verdict::Bad), Verdict::Bad);
    assert_eq!(SkinQuality::verdict(&[], Verdict::Good), Verdict::Good);
}

/// A get-up that floats and a clip that leaps are flaws, although both touch the floor in other frames; the clip of a
/// runner is none.
#[test]
fn floating_get_ups_and_leaping_clips_are_reported() {
    let Subject { rig, analysis, def } = Subject::mannequin();
    let rest: Vec<LocalTransform> = rig.joints.iter().map(|joint| joint.rest).collect();
    let after = |stage: Stage, share: f32| {
        let mut meter = SkinMeter::new(&rig, &def, &analysis.bind_model, &[]);
        let to_world = Mapping::new(&rig, &def, &analysis.bind_model).character_from_model();
        for height in [0.0, share * def.height] {
            meter.stand(stage, &rest, &to_world, -height);
        }
        meter.figures().flaws(&def)
    };
    for (stage, share) in [(Stage::Rising, 0.02), (Stage::Up, 0.15), (Stage::Standing, 0.15)] {
        assert_eq!(kinds(&after(stage, share)), [], "{stage:?}");
    }
    for (stage, share) in [(Stage::Rising, 0.07), (Stage::Up, 0.4), (Stage::Standing, 0.4)] {
        let flaws = after(stage, share);
        assert_eq!(kinds(&flaws), [FlawKind::OffFloor], "{stage:?}");
        assert_eq!(flaws[0].at_most, Verdict::Usable, "{stage:?}");
    }
}

#[test]
fn non_finite_figures_are_flaws_without_panics() {
    let mut subject = Subject::mannequin();
    let nan = f32::NAN;
    let poisoned = SkinQuality {
        covered_share: nan,
        edge_stretch_p999: nan,
        symmetry_error_m: nan,
        drawn_height_m: nan,
        rest_height_m: Some(nan),
        airborne_s: Some(nan),
        contiguous: true,
        size: 1.7,
        ..SkinQuality::default()
    };
    assert_eq!(poisoned.flaws(&subject.def).len(), 6);
    for mesh in &mut subject.rig.meshes {
        for primitive in &mut mesh.primitives {
            primitive.positions.iter_mut().for_each(|position| *position = Vec3::splat(f32::NAN));
        }
    }
    let skin = subject.over(&subject.lifted(0.0));
    assert_eq!(skin.covered_share, 0.0, "{skin:?}");
    assert!(!skin.flaws(&subject.def).is_empty());
    subject.rig.meshes.clear();
    let skin = subject.over(&subject.lifted(0.0));
    assert_eq!((skin.covered_share, skin.edge_stretch_max), (1.0, 0.0), "{skin:?}");
}

/// Returns the skin quality over the drops of another rig.
fn skin_of(name: &str) -> (SkinQuality, RagdollDef) {
    let document = document(name);
    let subject = Subject::of(document.rig);
    let moves = takes(&subject.rig, &document.clips);
    let falls = drop_test(&subject.def).falls;
    let skin = measure_skin(&subject.rig, &subject.def, &subject.analysis.bind_model, &moves, &falls);
    (skin, subject.def)
}

/// Feet whose joints are named like controls, or are children of the root, fall with their legs. In the past they tore
/// by half a height.
#[needs_data]
#[test]
fn animal_feet_stay_on_their_legs() {
    for name in ["animals_Wolf", "animals_Cow", "dinosaurs_Stegosaurus"] {
        let (skin, def) = skin_of(&format!("../rigs_wild/{name}.glb"));
        assert!(skin.edge_stretch_p999 < 0.1 && skin.contiguous, "{name}: {skin:?}");
        assert!(skin.rest_height_m.is_some_and(|height| height > -0.06 * skin.size), "{name}: {skin:?}");
        assert!(kinds(&skin.flaws(&def)).iter().all(|kind| *kind != FlawKind::Torn), "{name}: {skin:?}");
    }
}

/// In the past the swords and shields of the knight sank 1.9 m into the floor.
#[needs_data]
#[test]
fn knight_rests_on_top_of_his_sword() {
    let (skin, def) = skin_of("kaykit_Knight.glb");
    assert_eq!(skin.flaws(&def), [], "{skin:?}");
    let held = def.joints.iter().filter(|joint| joint.kind == sinew_physics::JointKind::Fixed).count();
    assert_eq!(held, 3, "expected bodies for both hands and the cape");
}

/// The sword is skinned to the hand, whose shape encloses it. In the past it sank 1 m into the floor.
#[needs_data]
#[test]
fn sword_skinned_to_a_hand_rests_on_the_floor() {
    let (skin, def) = skin_of("quaternius_cyberpunk_Character.glb");
    assert_eq!(skin.flaws(&def), [], "{skin:?}");
    let radius = |role: &str| {
        let body = def.bodies.iter().find(|body| body.role == role).expect("a hand");
        body.shape.bounding_radius()
    };
    assert!(radius("rightHand") > 2.0 * radius("leftHand"), "{} m", radius("rightHand"));
}

/// Adds a box as an unskinned mesh on a new bone below a role's, with its centre `off` the joint (model space, metres).
fn carried(rig: &mut Rig, name: &str, role: Role, off: Vec3, half: Vec3) {
    let analysis = analyze(rig).expect("the rig has a skin");
    let carrier = analysis.joint_with(role).expect("the role");
    let source = rig.joints.len();
    let rest = LocalTransform::default();
    rig.joints.push(Joint { name: name.into(), parent: Some(carrier), rest, source });
    let carrier_from_model = analysis.bind_model[carrier].inverse();
    let middle = analysis.bind_model[carrier].translation + off;
    let corner = |i: u32| {
        let side = |bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        carrier_from_model.point(middle + half * Vec3::new(side(0), side(1), side(2)))
    };
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let indices = faces.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).collect();
    let part = Primitive { positions: (0..8).map(corner).collect(), indices, ..Primitive::default() };
    rig.meshes.push(RigMesh { name: name.into(), joint: source, skin: None, primitives: vec![part] });
}

/// By size, props get a body or join their carrier's shape: a cap joins the head; a pack on the back and a sword in a
/// hand get fixed bodies. No part is inside the floor.
#[test]
fn cap_joins_the_head_and_pack_and_sword_get_bodies() {
    let plain = Subject::mannequin();
    let bones = |subject: &Subject| -> Vec<String> {
        subject.def.bodies.iter().map(|body| body.bone.clone()).collect()
    };
    let mut rig = mannequin().rig;
    carried(&mut rig, "cap", Role::Head, Vec3::Y * 0.12, Vec3::new(0.09, 0.05, 0.09));
    assert_eq!(bones(&Subject::of(rig.clone())), bones(&plain), "the cap must hardly reach beyond the head");
    carried(&mut rig, "pack", Role::Chest, Vec3::new(0.0, 0.05, -0.35), Vec3::new(0.18, 0.25, 0.12));
    let hand = Role::Hand(sinew_anim::Side::Right);
    carried(&mut rig, "sword", hand, Vec3::Z * 0.45, Vec3::new(0.02, 0.03, 0.4));
    let subject = Subject::of(rig);
    let own: Vec<String> = bones(&subject).into_iter().filter(|bone| !bones(&plain).contains(bone)).collect();
    assert_eq!(own, ["pack", "sword"]);
    for (bone, on) in [("pack", "chest"), ("sword", "rightHand")] {
        let body = subject.def.bodies.iter().position(|body| body.bone == bone).expect("seen above");
        let joint = subject.def.joints.iter().find(|joint| joint.child == body).expect("it has a joint");
        assert_eq!(joint.kind, sinew_physics::JointKind::Fixed, "{bone}");
        assert_eq!(subject.def.bodies[joint.parent].role, on);
    }
    let skin = subject.over(&drop_test(&subject.def).falls);
    assert!(skin.rest_height_m.is_some_and(|height| height > -0.05), "{skin:?}");
}

/// Adds a box to the skin of a role, with its centre `off` the joint (model space, metres).
fn grown(rig: &mut Rig, role: Role, off: Vec3, half: Vec3) {
    let analysis = analyze(rig).expect("the rig has a skin");
    let joint = analysis.joint_with(role).expect("the role");
    let slot = rig.skins[0].joints.iter().position(|&at| at == joint).expect("the joint moves skin");
    let middle = analysis.bind_model[joint].translation + off;
    let corner = |i: u32| {
        let side = |bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        middle + half * Vec3::new(side(0), side(1), side(2))
    };
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let part = Primitive {
        positions: (0..8).map(corner).collect(),
        joints: vec![[u16::try_from(slot).expect("the count fits"), 0, 0, 0]; 8],
        weights: vec![[1.0, 0.0, 0.0, 0.0]; 8],
        indices: faces.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).collect(),
        ..Primitive::default()
    };
    let joint = rig.meshes[0].joint;
    rig.meshes.push(RigMesh { name: "grown".into(), joint, skin: Some(0), primitives: vec![part] });
}

/// A hat with a wide brim and a pack, skinned to head and chest: the shapes enclose them.
#[test]
fn skinned_hats_and_packs_rest_on_the_floor() {
    let mut rig = mannequin().rig;
    grown(&mut rig, Role::Head, Vec3::Y * 0.22, Vec3::new(0.3, 0.01, 0.3));
    grown(&mut rig, Role::Head, Vec3::Y * 0.42, Vec3::new(0.03, 0.2, 0.03));
    grown(&mut rig, Role::Chest, Vec3::new(0.0, 0.05, -0.25), Vec3::new(0.12, 0.15, 0.2));
    let subject = Subject::of(rig);
    let skin = subject.over(&drop_test(&subject.def).falls);
    assert!(skin.rest_height_m.is_some_and(|height| height > -0.05), "{skin:?}");
    assert!(skin.covered_share > 0.99, "{skin:?}");
    let head = &subject.def.bodies[subject.body("head")].shape;
    assert!(matches!(head, Shape::Hull(_)), "{head:?}");
}

/// A club is skinned to a foot, which would get the shape of the other foot. The foot's shape encloses the club, and
/// the feet do not count as lopsided.
#[test]
fn object_skinned_to_the_end_of_a_limb_rests_on_the_floor() {
    let mut rig = mannequin().rig;
    let end = Role::Foot(sinew_anim::Side::Right);
    grown(&mut rig, end, Vec3::Z * 0.5, Vec3::new(0.02, 0.02, 0.45));
    let subject = Subject::of(rig);
    let skin = subject.over(&drop_test(&subject.def).falls);
    assert!(skin.rest_height_m.is_some_and(|height| height > -0.05), "{skin:?}");
    assert!(!kinds(&skin.flaws(&subject.def)).contains(&FlawKind::Lopsided), "{skin:?}");
}

/// A trunk whose skin includes forward-hanging arms gets no box with empty corners to rest on.
#[test]
fn trunk_with_skinned_arms_gets_a_hull() {
    let mut rig = mannequin().rig;
    for side in [-1.0, 1.0] {
        grown(&mut rig, Role::Chest, Vec3::new(side * 0.2, 0.5, 0.4), Vec3::new(0.04, 0.04, 0.35));
    }
    let subject = Subject::of(rig);
    let chest = &subject.def.bodies[subject.body("chest")];
    assert!(matches!(chest.shape, Shape::Hull(_)), "{:?}", chest.shape);
    let skin = subject.over(&drop_test(&subject.def).falls);
    assert!(skin.rest_height_m.is_some_and(|height| (-0.1..0.03).contains(&height)), "{skin:?}");
}
