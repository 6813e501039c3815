//! Tests of the built-in motions on other bodies.

use sinew::anim::contact::sole_points;
use sinew::anim::legs::{Legs, add_ankles};
use sinew::anim::retarget::Retargeted;
use sinew::anim::{
    Channel, Clip, Interpolation, Joint, LocalTransform, Primitive, Property, Rig, RigAnalysis, RigMesh,
    Role, Side, Skin, analyze, local_to_model,
};
use sinew::formats::{ReadOptions, load_gltf};
use sinew::mannequin::{WALK_SPEED, mannequin};
use sinew::math::{Affine, Rotation, Transform, Vec3};
use sinew::motions::{builtin_motions, set_motions_with_builtin};
use sinew::physics::Shape;
use sinew::ragdoll::skin::Stage;
use sinew::ragdoll::{
    BuildOptions, CharacterDef, Locomotion, MotionSet, Opening, RagdollBodyDef, SkinMeter, build,
};
use std::path::PathBuf;

fn character(rig: Rig) -> (CharacterDef, RigAnalysis) {
    let analysis = analyze(&rig).expect("a skin");
    let (ragdoll, _) = build(&rig, &analysis, &BuildOptions::default()).expect("bones");
    (CharacterDef::new(rig, ragdoll, &analysis.bind_model), analysis)
}

/// Returns the mannequin, and the humanoids of the shared data if they are present.
fn humanoids() -> Vec<(String, CharacterDef, RigAnalysis)> {
    let data = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let mut files: Vec<PathBuf> = ["rigs", "rigs_wild"]
        .iter()
        .filter_map(|folder| std::fs::read_dir(data.join(folder)).ok())
        .flatten()
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "glb" || e == "vrm"))
        .collect();
    files.sort();
    if files.is_empty() {
        eprintln!("skipped: no shared data");
    }
    let read = |path: PathBuf| {
        let rig = load_gltf(&path, ReadOptions::default()).ok()?.rig;
        let humanoid = analyze(&rig).is_ok_and(|analysis| analysis.humanoid);
        let name = path.file_stem()?.to_string_lossy().into_owned();
        humanoid.then(|| character(rig)).map(|(def, analysis)| (name, def, analysis))
    };
    let (def, analysis) = character(mannequin().rig);
    let own = std::iter::once(("mannequin".to_owned(), def, analysis));
    own.chain(files.into_iter().filter_map(read)).collect()
}

/// Lowest point of all bodies accepted by `counts` in a pose, metres above the floor.
fn lowest(def: &CharacterDef, pose: &[LocalTransform], counts: impl Fn(&RagdollBodyDef) -> bool) -> f32 {
    let (mut model, mut places) = (Vec::new(), Vec::new());
    local_to_model(&def.rig, pose, &Affine::IDENTITY, &mut model);
    def.mapping().bodies_from_model(&model, Transform::IDENTITY, &mut places);
    let bodies = def.ragdoll.bodies.iter().zip(&places).filter(|(body, _)| counts(body));
    bodies.map(|(body, place)| body.shape.aabb(place).min.y).fold(f32::INFINITY, f32::min)
}

/// Largest distance of a standing foot from the floor, metres: of its sole or body above the floor, or of its body in
/// the floor.
fn worst_stance(def: &CharacterDef, analysis: &RigAnalysis, fit: &Retargeted) -> f32 {
    let legs = Legs::of(&def.rig, analysis).expect("legs");
    let points = sole_points(&def.rig, &analysis.character_from_file(), &legs.feet, &fit.take);
    let mut worst: f32 = 0.0;
    for (frame, feet) in points.iter().enumerate() {
        let time = fit.take.time(frame);
        for contact in fit.contacts.iter().filter(|contact| contact.start <= time && time <= contact.end) {
            let k = usize::from(contact.foot == Side::Right);
            let top = legs.feet[k].leg.end;
            let hangs = |body: &RagdollBodyDef| {
                std::iter::successors(Some(body.joint), |&i| def.rig.joints[i].parent).any(|i| i == top)
            };
            let body = lowest(def, fit.take.pose(frame), hangs);
            let sole = feet[k].iter().map(|point| point.y - analysis.floor).fold(f32::INFINITY, f32::min);
            let body_under = if body.is_finite() { -body } else { -sole };
            worst = worst.max(body_under).max(body.min(sole));
        }
    }
    worst
}

#[test]
fn feet_stand_on_the_floor_and_the_trunk_is_above_it() {
    let all = humanoids();
    for (name, def, analysis) in &all {
        let motions = builtin_motions(def, analysis).unwrap_or_else(|error| panic!("{name}: {error}"));
        for (fit, what) in motions.fits.iter().zip(["walk", "idle", "supine", "prone"]) {
            assert!(!fit.contacts.is_empty(), "{name}: no foot is planted in {what}");
            // The error is scaled for a giant; a body with very short legs may miss.
            let size = def.ragdoll.height / 1.8;
            let off = worst_stance(def, analysis, fit);
            let is_stub = fit.scale < 0.3 * size;
            assert!(
                off < 0.01 * size.max(1.0) || is_stub,
                "{name}: feet are {off} m away from the floor in {what}"
            );
            let is_trunk = |body: &RagdollBodyDef| {
                let part = |end: &str| body.role.ends_with(end);
                part("hips") || part("spine") || part("hest") || part("neck") || part("head")
            };
            let low = (0..fit.take.frames()).map(|frame| lowest(def, fit.take.pose(frame), is_trunk));
            let deep = low.fold(0.0, |deep: f32, low| deep.max(-low));
            assert!(deep < 0.01 * size.max(1.0), "{name}: the trunk is {deep} m below the floor in {what}");
        }
    }
}

#[test]
fn cycle_closes_and_its_speed_matches_the_legs() {
    let (def, analysis) = character(mannequin().rig);
    let motions = builtin_motions(&def, &analysis).expect("a human");
    assert!((motions.walk_speed - WALK_SPEED).abs() < 1e-3, "{} m/s", motions.walk_speed);
    for (clip, fit) in [(&motions.walk, &motions.fits[0]), (&motions.idle, &motions.fits[1])] {
        let take = &fit.take;
        assert_eq!(take.pose(0), take.pose(take.frames() - 1), "{}", clip.name);
    }
    // The ankle moves backward under the body at the stated speed.
    let take = &motions.fits[0].take;
    let ankle = analysis.joint_with(Role::Foot(Side::Left)).expect("a foot");
    let at = |frame: usize| {
        let mut model = Vec::new();
        local_to_model(&def.rig, take.pose(frame), &Affine::IDENTITY, &mut model);
        model[ankle].translation.z
    };
    let (from, to) = (4, 9);
    let speed = (at(from) - at(to)) / (take.time(to) - take.time(from));
    assert!((speed - WALK_SPEED).abs() < 0.02, "{speed} m/s");
}

#[test]
fn only_what_is_missing_is_filled_in() {
    let (def, analysis) = character(mannequin().rig);
    let builtin = || builtin_motions(&def, &analysis).expect("a human");
    let bare = builtin().fill_in(MotionSet::default());
    assert_eq!((bare.get_ups.len(), bare.opening), (2, Opening::Rest));
    assert_eq!(bare.clips[bare.looped.expect("a walk")].name, "walk");
    let dance = Clip { name: "dance".into(), ..Clip::default() };
    let own = MotionSet { clips: vec![dance], looped: Some(0), ..MotionSet::default() };
    let own = builtin().fill_in(own);
    assert_eq!((own.looped, own.get_ups.as_slice(), own.opening), (Some(0), &[1, 2][..], Opening::Looped));
    assert_eq!(own.locomotion, Locomotion::InPlace);
}

/// A joint that a get-up does not animate keeps its pose of the looped clip, not the rig's rest pose.
#[test]
fn joints_without_get_up_channels_keep_the_loop_pose() {
    let mannequin = mannequin();
    let mut rig = mannequin.rig.clone();
    let hand = rig.joints.iter().position(|joint| joint.name == "rightHand").expect("a hand");
    let sword = rig.joints.len();
    // In the rest pose the sword is two metres away; in the clip it is in the hand.
    let rest = LocalTransform { translation: Vec3::Y * 2.0, ..LocalTransform::default() };
    rig.joints.push(Joint { name: "sword".into(), parent: Some(hand), rest, source: sword });
    let mut walk = mannequin.clips[mannequin.motions.walk].clone();
    walk.channels.push(Channel {
        joint: sword,
        property: Property::Translation,
        interpolation: Interpolation::Linear,
        times: vec![0.0],
        values: vec![0.0, 0.1, 0.0],
    });
    let analysis = analyze(&rig).expect("a skin");
    let (ragdoll, _) = build(&rig, &analysis, &BuildOptions::default()).expect("bones");
    let mut def = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
    let own = MotionSet { clips: vec![walk], looped: Some(0), ..MotionSet::default() };
    set_motions_with_builtin(&mut def, &analysis, own).expect("a human");
    let motions = def.motions();
    assert!(!motions.get_ups.is_empty());
    for &get_up in &motions.get_ups {
        let of_sword = motions.clips[get_up].channels.iter().find(|channel| channel.joint == sword);
        assert_eq!(of_sword.map(|channel| channel.values.as_slice()), Some([0.0, 0.1, 0.0].as_slice()));
    }
}

/// Returns the rig under a node that mirrors it in x, with its mesh bound there, so that left and right are named in
/// reverse.
fn mirrored(rig: &Rig) -> Rig {
    let mut rig = rig.clone();
    let half_turn = Rotation::from_axis_angle(Vec3::X, core::f32::consts::PI);
    let rest = LocalTransform { rotation: half_turn, scale: Vec3::splat(-1.0), ..LocalTransform::default() };
    for joint in &mut rig.joints {
        joint.parent = Some(joint.parent.map_or(0, |parent| parent + 1));
    }
    rig.joints.insert(0, Joint { name: "Armature".into(), parent: None, rest, source: rig.joints.len() });
    let mirror = rest.to_affine();
    for skin in &mut rig.skins {
        skin.joints.iter_mut().for_each(|joint| *joint += 1);
        skin.inverse_bind.iter_mut().for_each(|inverse| *inverse = *inverse * mirror.inverse());
    }
    for mesh in &mut rig.meshes {
        mesh.joint += 1;
        mesh.primitives
            .iter_mut()
            .flat_map(|part| &mut part.positions)
            .for_each(|at| *at = mirror.point(*at));
    }
    rig.stated_roles.clear();
    rig
}

/// With a negative scale above the skeleton, get-ups work as on any body.
#[test]
fn a_mirrored_skeleton_gets_up() {
    let rig = mannequin().rig;
    let depth = |rig: Rig| {
        let (def, analysis) = character(rig);
        let motions = builtin_motions(&def, &analysis).expect("a human");
        let deepest = motions.fits.iter().map(|fit| def.deepest_skin(&fit.take));
        deepest.fold(0.0_f32, f32::max)
    };
    let [plain, mirrored] = [depth(rig.clone()), depth(mirrored(&rig))];
    assert!((plain - mirrored).abs() < 0.01, "depth in the floor: mirrored {mirrored} m, plain {plain} m");
}

/// Returns a box with the centre `middle` (model space, metres), skinned to a slot.
fn block(middle: Vec3, half: Vec3, slot: usize) -> Primitive {
    let corner = |i: u32| {
        let side = |bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        middle + half * Vec3::new(side(0), side(1), side(2))
    };
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Primitive {
        positions: (0..8).map(corner).collect(),
        joints: vec![[u16::try_from(slot).expect("few"), 0, 0, 0]; 8],
        weights: vec![[1.0, 0.0, 0.0, 0.0]; 8],
        indices: faces.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).collect(),
        ..Primitive::default()
    }
}

/// Adds a box skinned to a joint to the rig, its centre `off` from the joint (model space, metres).
fn with_box(mut rig: Rig, role: Role, off: Vec3, half: Vec3) -> Rig {
    let analysis = analyze(&rig).expect("a skin");
    let joint = analysis.joint_with(role).expect("the role");
    let slot = rig.skins[0].joints.iter().position(|&at| at == joint).expect("the joint moves skin");
    let middle = analysis.bind_model[joint].translation + off;
    let part = block(middle, half, slot);
    let joint = rig.meshes[0].joint;
    rig.meshes.push(RigMesh { name: "box".into(), joint, skin: Some(0), primitives: vec![part] });
    rig
}

/// Returns the rig with all joints as roots, as written by exporters of deform bones.
fn flat(mut rig: Rig) -> Rig {
    let mut model = Vec::new();
    let pose: Vec<LocalTransform> = rig.joints.iter().map(|joint| joint.rest).collect();
    local_to_model(&rig, &pose, &Affine::IDENTITY, &mut model);
    for (joint, place) in rig.joints.iter_mut().zip(model) {
        let Transform { translation, rotation } = place.to_rigid();
        joint.rest = LocalTransform { translation, rotation, ..LocalTransform::default() };
        joint.parent = None;
    }
    rig
}

/// With a staff as long as its bearer, across the palm, the hand turns about its wrist, and no get-up is lost.
#[test]
fn human_with_a_staff_gets_up() {
    let hand = Role::Hand(Side::Right);
    let staff = with_box(mannequin().rig, hand, Vec3::Y * 0.1, Vec3::new(0.02, 0.85, 0.02));
    for (rig, what) in [(staff.clone(), "a tree of joints"), (flat(staff), "joints without parents")] {
        let (mut def, analysis) = character(rig);
        let motions = builtin_motions(&def, &analysis).expect("a human");
        let depths = [2, 3].map(|fit: usize| def.deepest_skin(&motions.fits[fit].take));
        assert!(depths.iter().all(|&depth| depth < 0.1), "{what}: depths in the floor {depths:?} m");
        set_motions_with_builtin(&mut def, &analysis, MotionSet::default()).expect("get-ups");
        assert_eq!(def.motions().get_ups.len(), 2, "{what}");
    }
}

/// Returns the mannequin with legs of one bone: the skin below the knees belongs to the thighs.
fn without_knees() -> Rig {
    let mut rig = mannequin().rig;
    let analysis = analyze(&rig).expect("a skin");
    let joint = |role: Role| analysis.joint_with(role);
    for side in [Side::Left, Side::Right] {
        let thigh = joint(Role::UpperLeg(side)).expect("a thigh");
        let below: Vec<usize> = [Role::LowerLeg(side), Role::Foot(side), Role::Toes(side)]
            .into_iter()
            .filter_map(joint)
            .collect();
        for &joint in &below {
            rig.joints[joint].name = format!("helper{joint}");
        }
        for mesh in &mut rig.meshes {
            let Some(skin) = mesh.skin.map(|skin| &rig.skins[skin]) else { continue };
            let slot = |joint: usize| skin.joints.iter().position(|&own| own == joint);
            let to = u16::try_from(slot(thigh).expect("skinned")).expect("few");
            for slots in mesh.primitives.iter_mut().flat_map(|primitive| &mut primitive.joints) {
                for own in slots {
                    if below.contains(&skin.joints[usize::from(*own)]) {
                        *own = to;
                    }
                }
            }
        }
    }
    rig
}

/// Returns a figure of six blocks: a trunk that carries a head, arms and legs of one bone.
fn of_blocks() -> Rig {
    let parts = [
        ("Root", Vec3::new(0.0, 0.6, 0.0), Vec3::new(0.0, 0.9, 0.0), Vec3::new(0.2, 0.3, 0.09)),
        ("Head", Vec3::new(0.0, 1.2, 0.0), Vec3::new(0.0, 1.4, 0.0), Vec3::splat(0.2)),
        ("Arm Left", Vec3::new(0.28, 1.12, 0.0), Vec3::new(0.28, 0.9, 0.0), Vec3::new(0.08, 0.3, 0.08)),
        ("Arm Right", Vec3::new(-0.28, 1.12, 0.0), Vec3::new(-0.28, 0.9, 0.0), Vec3::new(0.08, 0.3, 0.08)),
        ("Leg Left", Vec3::new(0.1, 0.6, 0.0), Vec3::new(0.1, 0.3, 0.0), Vec3::new(0.08, 0.3, 0.08)),
        ("Leg Right", Vec3::new(-0.1, 0.6, 0.0), Vec3::new(-0.1, 0.3, 0.0), Vec3::new(0.08, 0.3, 0.08)),
    ];
    let mut rig = Rig::default();
    let mut skin = Skin { name: String::new(), joints: Vec::new(), inverse_bind: Vec::new() };
    let mut primitives = Vec::new();
    for (i, (name, place, middle, half)) in parts.into_iter().enumerate() {
        let parent = (i > 0).then_some(0);
        let translation = place - parent.map_or(Vec3::ZERO, |_| parts[0].1);
        let rest = LocalTransform { translation, ..LocalTransform::default() };
        rig.joints.push(Joint { name: name.into(), parent, rest, source: i });
        skin.joints.push(i);
        skin.inverse_bind.push(Affine { translation: -place, ..Affine::IDENTITY });
        primitives.push(block(middle, half, i));
    }
    rig.skins = vec![skin];
    rig.meshes = vec![RigMesh { name: "blocks".into(), joint: 0, skin: Some(0), primitives }];
    rig
}

/// Arms of one bone turn about their shoulders out of the floor, and the figure keeps both get-ups.
#[test]
fn figure_without_elbows_gets_up() {
    let mut rig = of_blocks();
    let mut analysis = analyze(&rig).expect("a skin");
    assert!(analysis.humanoid && analysis.joint_with(Role::UpperArm(Side::Left)).is_some());
    let (ragdoll, _) = build(&rig, &analysis, &BuildOptions::default()).expect("bones");
    add_ankles(&mut rig, &mut analysis);
    let mut def = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
    let motions = builtin_motions(&def, &analysis).expect("a human");
    for fit in &motions.fits[2..] {
        let deepest = def.deepest_skin(&fit.take);
        assert!(deepest < 0.05 * def.ragdoll.height, "it is {deepest} m in the floor");
    }
    set_motions_with_builtin(&mut def, &analysis, MotionSet::default()).expect("get-ups");
    assert_eq!(def.motions().get_ups.len(), 2);
}

/// Shapes that are larger than the skin do not raise a get-up from the floor.
#[test]
fn large_shapes_do_not_raise_a_get_up() {
    let (mut def, analysis) = character(mannequin().rig);
    let hips = def.ragdoll.bodies.iter_mut().find(|body| body.role == "hips").expect("hips");
    hips.shape = Shape::Sphere { radius: 0.4 };
    let def = CharacterDef::new(def.rig.clone(), def.ragdoll.clone(), &analysis.bind_model);
    let motions = builtin_motions(&def, &analysis).expect("a human");
    for fit in &motions.fits[2..] {
        let mut meter = SkinMeter::new(&def.rig, &def.ragdoll, &analysis.bind_model, &[]);
        let to_world = def.mapping().character_from_model();
        for frame in 0..fit.take.frames() {
            meter.stand(Stage::Rising, fit.take.pose(frame), &to_world, 0.0);
        }
        let above = meter.figures().rising_above_m.expect("the height was measured");
        assert!(above < 0.05 * def.ragdoll.height, "it is {above} m above the floor");
    }
}

/// Legs of one bone are straight in all built-in motions, and the figure stands at the end of its get-ups.
#[test]
fn figure_without_knees_gets_up() {
    let mut rig = without_knees();
    let mut analysis = analyze(&rig).expect("a skin");
    assert!(analysis.humanoid && analysis.joint_with(Role::LowerLeg(Side::Left)).is_none());
    let (ragdoll, _) = build(&rig, &analysis, &BuildOptions::default()).expect("bones");
    assert_eq!(add_ankles(&mut rig, &mut analysis), 2);
    let def = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
    let motions = builtin_motions(&def, &analysis).expect("a human");
    for fit in &motions.fits {
        let last = fit.take.pose(fit.take.frames() - 1);
        let low = lowest(&def, last, |_| true);
        assert!(low.abs() < 0.03, "its lowest part is at {low} m");
        let head = lowest(&def, last, |body| body.role == "head");
        assert!(head > 0.75 * def.ragdoll.height, "its head is at {head} m");
        let deepest = def.deepest_skin(&fit.take);
        assert!(deepest < 0.1 * def.ragdoll.height, "it is {deepest} m in the floor");
    }
}
