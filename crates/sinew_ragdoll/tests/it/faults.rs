//! Faults that no single metric shows, each injected into the mannequin.

use crate::actor::{floor, shared, walker};
use sinew_anim::{Hints, Joint, LocalTransform, Primitive, Rig, RigMesh, Skin, analyze, analyze_hinted};
use sinew_math::{Affine, Rotation, Vec3};
use sinew_physics::{BodyDef, JointKind, Shape};
use sinew_ragdoll::quality::{Doubt, faults_of_bake, faults_of_ragdoll, toppled};
use sinew_ragdoll::{
    AfterSettling, BakeInput, Baked, BuildOptions, CharacterDef, Locomotion, MotionSet, RagdollBodyDef,
    RagdollDef, State, Verdict, bake, build,
};
use sinew_scenes::mannequin::mannequin;
use std::sync::Arc;

fn built() -> RagdollDef {
    let rig = mannequin().rig;
    let analysis = analyze(&rig).expect("the rig has a skin");
    build(&rig, &analysis, &BuildOptions::default()).expect("the rig can be built").0
}

fn verdict(def: &RagdollDef) -> Option<(Verdict, String)> {
    let found = faults_of_ragdoll(&mannequin().rig, def);
    found.into_iter().next().map(|fault| (fault.at_most, fault.reason))
}

#[test]
fn mannequin_has_no_faults() {
    assert_eq!(verdict(&built()), None);
    assert_eq!(Doubt::of(&built()), None);
}

#[test]
fn limbs_on_the_wrong_side_are_reported() {
    let mut def = built();
    let at = |def: &RagdollDef, role: &str| {
        def.bodies.iter().position(|body| body.role == role).expect("the named item exists")
    };
    let (left, right) = (at(&def, "leftUpperArm"), at(&def, "rightUpperArm"));
    let bones = [left, right].map(|body| def.bodies[body].bone.clone());
    (def.bodies[left].role, def.bodies[right].role) = ("rightUpperArm".into(), "leftUpperArm".into());
    let (at_most, reason) = verdict(&def).expect("the verdict is limited");
    assert_eq!(at_most, Verdict::Usable, "{reason}");
    assert!(bones.iter().all(|bone| reason.contains(bone)), "{reason}");
    // Both arms are labelled left.
    let mut def = built();
    def.bodies[right].character_from_body = def.bodies[left].character_from_body;
    def.joints[right - 1].frame_child = def.joints[left - 1].frame_child;
    let (at_most, reason) = verdict(&def).expect("the verdict is limited");
    assert_eq!(at_most, Verdict::Bad, "{reason}");
    assert!(reason.contains("on the same side"), "{reason}");
}

#[test]
fn one_body_for_a_rig_of_many_joints_is_bad() {
    let mut def = built();
    def.bodies.truncate(1);
    def.joints.clear();
    let (at_most, reason) = verdict(&def).expect("the verdict is limited");
    assert_eq!(at_most, Verdict::Bad, "{reason}");
    assert!(reason.contains("statue") && reason.contains("--body"), "{reason}");
}

/// The cases are a human of 57 cm and 8 kg with an adult's head, a wolf of 2.5 t, and a wasp of 1.6 t.
#[test]
fn implausible_masses_and_sizes_are_reported() {
    let mut small = built();
    let share = 0.57 / small.height;
    small.height = 0.57;
    small.total_mass = 8.0;
    small.bodies.iter_mut().for_each(|body| body.character_from_body.translation *= share);
    small.joints.iter_mut().for_each(|joint| joint.frame_child.translation *= share);
    let doubt = Doubt::of(&small).expect("the mass is doubtful");
    assert!(doubt.reason.contains("8 kg at a height of 0.570 m"), "{}", doubt.reason);
    let mut heavy = built();
    heavy.total_mass *= 4.0;
    assert!(Doubt::of(&heavy).is_some());
    for (mass, height) in [(2500.0, 2.7), (1600.0, 3.8)] {
        assert!(Doubt::of(&RagdollDef { total_mass: mass, height, ..RagdollDef::default() }).is_some());
    }
    let bear = RagdollDef { total_mass: 600.0, height: 1.5, ..RagdollDef::default() };
    assert_eq!(Doubt::of(&bear), None);
}

/// A blocky character of 625 kg at 1.75 m is not recognised as human.
#[test]
fn creature_too_heavy_for_its_length_is_reported() {
    let creature = |mass: f32| {
        let mut def = built();
        def.bodies.iter_mut().enumerate().for_each(|(i, body)| body.role = format!("spine_{i}"));
        def.total_mass = mass;
        Doubt::of(&def)
    };
    let doubt = creature(625.0).expect("the mass is doubtful");
    assert!(doubt.reason.contains("625 kg at a length of 1.7"), "{}", doubt.reason);
    assert_eq!(creature(200.0), None);
}

/// A mannequin with very stiff joints stays upright when it goes limp.
#[test]
fn tall_body_that_stays_upright_is_reported() {
    let faults = |rust: f32| {
        let rig = mannequin().rig;
        let analysis = analyze(&rig).expect("the rig has a skin");
        let mut ragdoll = built();
        ragdoll.joints.iter_mut().for_each(|joint| joint.friction_torque += rust);
        let mut character = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
        character.after_settling = AfterSettling::StayDown;
        let ground = [BodyDef::fixed(Shape::HalfSpace)];
        let input = BakeInput {
            bodies: &ground,
            limp_at: Some(0.0),
            seconds: 6.0,
            ..BakeInput::new(Arc::new(character))
        };
        faults_of_bake(&input, &bake(&input))
    };
    assert_eq!(faults(0.0), []);
    let found = faults(1e4);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].reason.contains("stays upright") && found[0].at_most == Verdict::Usable, "{found:?}");
}

/// The weakest sufficient push is applied; a character that falls by itself is not pushed.
#[test]
fn upright_body_is_pushed_over() {
    let pushed = |rust: f32| {
        let rig = mannequin().rig;
        let analysis = analyze(&rig).expect("the rig has a skin");
        let mut ragdoll = built();
        ragdoll.joints.iter_mut().for_each(|joint| joint.friction_torque += rust);
        let mut character = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
        character.after_settling = AfterSettling::StayDown;
        let ground = [BodyDef::fixed(Shape::HalfSpace)];
        let input = BakeInput {
            bodies: &ground,
            limp_at: Some(0.0),
            seconds: 6.0,
            ..BakeInput::new(Arc::new(character))
        };
        toppled(&input, &bake(&input)).map(|pushed| (pushed.topple, faults_of_bake(&pushed, &bake(&pushed))))
    };
    assert_eq!(pushed(0.0), None);
    let (topple, faults) = pushed(1e4).expect("a push fells it");
    assert!(topple.z > 0.5 && topple.length() < 5.0, "not a weak forward push: {topple}");
    assert_eq!(faults, [], "the push must leave no fault");
}

/// A clip that scales the hips, before a get-up clip that does not.
#[test]
fn character_that_shrinks_before_get_up_is_reported() {
    let rig = mannequin().rig;
    let analysis = analyze(&rig).expect("the rig has a skin");
    let character = CharacterDef::new(rig, built(), &analysis.bind_model);
    let hips = character.ragdoll.bodies[0].joint;
    let ground = [BodyDef::fixed(Shape::HalfSpace)];
    let input = BakeInput {
        bodies: &ground,
        limp_at: Some(0.5),
        seconds: 4.0,
        ..BakeInput::new(Arc::new(character))
    };
    let mut baked = bake(&input);
    let last = baked.frames.len() - 1;
    baked.frames[last].state = State::GettingUp;
    assert_eq!(baked.frames[0].state, State::Animated);
    let sized = |baked: &Baked| {
        faults_of_bake(&input, baked).into_iter().find(|fault| fault.reason.contains("times as large"))
    };
    assert_eq!(sized(&baked), None);
    baked.frames[0].pose[hips].scale *= 2.65;
    let fault = sized(&baked).expect("the verdict is limited");
    assert_eq!(fault.at_most, Verdict::Bad);
    assert!(fault.reason.contains("0.38 times"), "{}", fault.reason);
}

/// Stance width is measured at the feet: stiff outstretched arms do not make the body count as broad.
#[test]
fn upright_body_with_outstretched_arms_is_reported() {
    let rig = mannequin().rig;
    let analysis = analyze(&rig).expect("the rig has a skin");
    let mut ragdoll = built();
    ragdoll.joints.iter_mut().for_each(|joint| joint.friction_torque += 1e4);
    let joint = |role: &str| {
        ragdoll.bodies.iter().find(|body| body.role == role).map(|body| body.joint).expect("it has a body")
    };
    let arms = [("left", Vec3::X), ("right", -Vec3::X)].map(|(side, out)| {
        let [upper, lower] = ["UpperArm", "LowerArm"].map(|part| joint(&format!("{side}{part}")));
        (upper, lower, Rotation::from_arc(rig.joints[lower].rest.translation.normalize(), out))
    });
    let mut character = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
    character.after_settling = AfterSettling::StayDown;
    let ground = [BodyDef::fixed(Shape::HalfSpace)];
    let input = BakeInput {
        bodies: &ground,
        limp_at: Some(0.0),
        seconds: 6.0,
        ..BakeInput::new(Arc::new(character))
    };
    let mut baked = bake(&input);
    for frame in &mut baked.frames {
        for (upper, lower, turn) in arms {
            frame.pose[upper].rotation = turn;
            frame.pose[lower].translation *= 4.0;
        }
    }
    let found = faults_of_bake(&input, &baked);
    assert!(found.iter().any(|fault| fault.reason.contains("stays upright")), "{found:?}");
}

/// A limp human that holds its hips half as high as standing for 3 s is reported; one that lies, or that sinks, is not.
#[test]
fn limp_human_propped_on_its_limbs_is_reported() {
    let def = shared(walker());
    let bodies = [floor()];
    let input = BakeInput { bodies: &bodies, seconds: 0.2, ..BakeInput::new(def.clone()) };
    let hips = def.ragdoll.bodies[0].joint;
    let faults = |height_at: &dyn Fn(f32) -> f32| {
        let mut baked = bake(&input);
        let first = baked.frames[0].clone();
        baked.frames.truncate(1);
        for step in 1..90 {
            let mut frame = first.clone();
            (frame.state, frame.time) = (State::Limp, step as f32 / 30.0);
            frame.pose[hips].translation.y *= height_at(frame.time);
            baked.frames.push(frame);
        }
        faults_of_bake(&input, &baked)
    };
    let propped = faults(&|_| 0.5);
    assert!(propped.len() == 1 && propped[0].at_most == Verdict::Usable, "{propped:?}");
    assert!(propped[0].reason.contains("props its hips up"), "{propped:?}");
    assert_eq!(faults(&|_| 0.2), []);
    assert_eq!(faults(&|time| 1.0 - time / 3.0), []);
}

/// The mannequin is in a platform up to its hips, in a wall, or walks into a wall by its clip.
#[test]
fn character_inside_the_world_is_bad() {
    let (rig, own) = (mannequin().rig, mannequin().clips);
    let analysis = analyze(&rig).expect("the rig has a skin");
    let mut character = CharacterDef::new(rig, built(), &analysis.bind_model);
    let speed = 1.4;
    let motions = MotionSet {
        clips: own,
        looped: Some(0),
        locomotion: Locomotion::Forward { speed },
        ..MotionSet::default()
    };
    character.set_motions(motions).expect("the clip can be played");
    let character = Arc::new(character);
    let reasons = |at: Vec3, half_extents: Vec3| {
        let floor = BodyDef::fixed(Shape::HalfSpace);
        let bodies = [floor, BodyDef { position: at, ..BodyDef::fixed(Shape::Box { half_extents }) }];
        let input = BakeInput { bodies: &bodies, seconds: 2.0, ..BakeInput::new(character.clone()) };
        let found = faults_of_bake(&input, &bake(&input));
        assert!(found.iter().all(|fault| fault.at_most == Verdict::Bad), "{found:?}");
        found.into_iter().map(|fault| fault.reason).collect::<Vec<_>>().join("; ")
    };
    assert_eq!(reasons(Vec3::X * 50.0, Vec3::ONE), "");
    let at_once = reasons(Vec3::ZERO, Vec3::new(3.0, 0.8, 3.0));
    assert!(at_once.starts_with("it starts inside the world"), "{at_once}");
    let later = reasons(Vec3::Z * 3.0, Vec3::new(3.0, 3.0, 1.0));
    assert!(later.starts_with("its clip moves it into the world"), "{later}");
}

/// Returns a box of `half_extents` at `center`, bound to the joint of `slot`.
fn block(skinned: &mut Primitive, center: Vec3, half_extents: Vec3, slot: u16) {
    let first = u32::try_from(skinned.positions.len()).expect("the count fits");
    let corner = |i: u32| {
        let sign = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        center + half_extents * Vec3::new(sign(0), sign(1), sign(2))
    };
    skinned.positions.extend((0..8).map(corner));
    skinned.joints.extend([[slot, 0, 0, 0]; 8]);
    skinned.weights.extend([[1.0, 0.0, 0.0, 0.0]; 8]);
    let faces = [[0, 2, 1, 3], [4, 5, 6, 7], [0, 1, 4, 5], [2, 6, 3, 7], [0, 4, 2, 6], [1, 3, 5, 7]];
    for [a, b, c, d] in faces {
        skinned.indices.extend([a, b, c, b, d, c].map(|corner| first + corner));
    }
}

/// Returns an animal of blocks: a node that carries a trunk of two parts on four legs of one bone. `rust` is added to
/// the friction of its joints, N·m.
fn animal(rust: f32) -> CharacterDef {
    animal_named("", rust)
}

/// Returns the animal of a file of this name.
fn animal_named(name: &str, rust: f32) -> CharacterDef {
    animal_on(name, rust, [0.4, 0.06])
}

/// Returns the animal with legs of this length and half thickness.
fn animal_on(name: &str, rust: f32, [length, thickness]: [f32; 2]) -> CharacterDef {
    let legs = |z: f32| [0.13, -0.13].map(|x| Vec3::new(x, length, z));
    let mut places = vec![(None, Vec3::ZERO)];
    places.extend([(Some(0), Vec3::new(0.0, 0.5, -0.3)), (Some(1), Vec3::new(0.0, 0.5, 0.3))]);
    places.extend(legs(0.5).map(|place| (Some(2), place)));
    places.extend(legs(-0.5).map(|place| (Some(1), place)));
    let mut rig = Rig::default();
    let mut skinned = Primitive::default();
    for (i, &(parent, place)) in places.iter().enumerate() {
        let translation = place - parent.map_or(Vec3::ZERO, |parent: usize| places[parent].1);
        let rest = LocalTransform { translation, ..LocalTransform::default() };
        rig.joints.push(Joint { name: format!("bone{i}"), parent, rest, source: i });
        let slot = u16::try_from(i).expect("the count fits");
        match i {
            0 => {}
            1 | 2 => block(&mut skinned, place, Vec3::new(0.18, 0.12, 0.3), slot),
            _ => {
                let half = Vec3::new(thickness, 0.5 * length, thickness);
                block(&mut skinned, place - Vec3::Y * half.y, half, slot);
            }
        }
    }
    let inverse_bind =
        places.iter().map(|&(_, at)| Affine { translation: -at, ..Affine::IDENTITY }).collect();
    rig.skins = vec![Skin { name: String::new(), joints: (0..places.len()).collect(), inverse_bind }];
    rig.meshes = vec![RigMesh { name: String::new(), joint: 0, skin: Some(0), primitives: vec![skinned] }];
    let upright = Hints { name: name.into(), up: Some(Vec3::Y), ..Hints::default() };
    let analysis = analyze_hinted(&rig, &upright).expect("the rig has a skin");
    let (mut ragdoll, _) = build(&rig, &analysis, &BuildOptions::default()).expect("the rig can be built");
    ragdoll.joints.iter_mut().for_each(|joint| joint.friction_torque += rust);
    CharacterDef::new(rig, ragdoll, &analysis.bind_model)
}

/// Under a node with unequal scales, a body that turns is drawn at the same size.
#[test]
fn turning_under_unequal_scales_changes_no_size() {
    let character = animal(0.0);
    let (node, trunk) = (0, character.ragdoll.bodies[0].joint);
    let ground = [BodyDef::fixed(Shape::HalfSpace)];
    let input = BakeInput { bodies: &ground, limp_at: Some(0.5), ..BakeInput::new(Arc::new(character)) };
    let mut baked = bake(&input);
    baked.frames.iter_mut().for_each(|frame| frame.pose[node].scale = Vec3::new(1.0, 1.3, 1.0));
    baked.frames[0].pose[trunk].rotation = Rotation::from_axis_angle(Vec3::Z, core::f32::consts::FRAC_PI_2);
    let last = baked.frames.len() - 1;
    baked.frames[last].state = State::GettingUp;
    let found = faults_of_bake(&input, &baked);
    assert!(found.iter().all(|fault| !fault.reason.contains("times as large")), "{found:?}");
}

fn limp_for_6_s(character: CharacterDef, ground: &[BodyDef]) -> BakeInput<'_> {
    BakeInput { bodies: ground, limp_at: Some(0.0), seconds: 6.0, ..BakeInput::new(Arc::new(character)) }
}

/// An animal with stiff joints stays on its legs when it goes limp: it is pushed over sideways, and lies.
#[test]
fn animal_on_its_legs_is_pushed_over_sideways() {
    let mut character = animal(1e4);
    character.after_settling = AfterSettling::StayDown;
    let ground = [BodyDef::fixed(Shape::HalfSpace)];
    let input = limp_for_6_s(character, &ground);
    let found = faults_of_bake(&input, &bake(&input));
    assert!(found.iter().any(|fault| fault.reason.contains("stays on its legs")), "{found:?}");
    let pushed = toppled(&input, &bake(&input)).expect("a push fells it");
    assert!(pushed.topple.x.abs() > 0.5 && pushed.topple.z.abs() < 1e-3, "sideways: {}", pushed.topple);
    assert_eq!(faults_of_bake(&pushed, &bake(&pushed)), []);
}

/// An animal that kneels on folded legs is no fault, but it is pushed over sideways, because that lays it flat.
#[test]
fn animal_on_folded_legs_is_pushed_flat() {
    let mut character = animal_on("", 0.0, [0.34, 0.04]);
    character.after_settling = AfterSettling::StayDown;
    let hips = character.ragdoll.joints.iter_mut().skip(1);
    hips.for_each(|hip| hip.kind = JointKind::Ball { limit: None });
    let ground = [BodyDef::fixed(Shape::HalfSpace)];
    let kneels = BakeInput { topple: Vec3::Z, ..limp_for_6_s(character, &ground) };
    let found = faults_of_bake(&kneels, &bake(&kneels));
    assert!(found.iter().all(|fault| !fault.reason.contains("stays")), "{found:?}");
    let pushed = toppled(&kneels, &bake(&kneels)).expect("a push lays it flat");
    assert!(pushed.topple.x.abs() > 0.5 && pushed.topple.z.abs() < 1e-3, "sideways: {}", pushed.topple);
}

/// A rump that is recognised as the root of a limb with two legs on it counts as trunk: held off the floor, it is a
/// fault.
#[test]
fn rump_that_counts_as_a_limb_is_seen() {
    let mut character = animal(1e4);
    character.after_settling = AfterSettling::StayDown;
    let heavy = |body: &RagdollBodyDef| body.role.starts_with("spine") || body.role.starts_with("tail");
    for (i, body) in character.ragdoll.bodies.iter_mut().filter(|body| heavy(body)).enumerate() {
        body.role = format!("limb_{}_0", 8 + i);
    }
    let ground = [BodyDef::fixed(Shape::HalfSpace)];
    let input = limp_for_6_s(character, &ground);
    let found = faults_of_bake(&input, &bake(&input));
    assert!(found.iter().any(|fault| fault.reason.contains("stays on its legs")), "{found:?}");
}

/// A character that its clip moves beyond the edge of its ground, or that starts high above it, is not good.
#[test]
fn character_in_the_air_is_not_good() {
    let (rig, own) = (mannequin().rig, mannequin().clips);
    let analysis = analyze(&rig).expect("the rig has a skin");
    let mut character = CharacterDef::new(rig, built(), &analysis.bind_model);
    let motions = MotionSet {
        clips: own,
        looped: Some(0),
        locomotion: Locomotion::Forward { speed: 1.4 },
        ..MotionSet::default()
    };
    character.set_motions(motions).expect("the clip can be played");
    let character = Arc::new(character);
    let reasons = |edge: f32, up: f32| {
        let half_extents = Vec3::new(3.0, 0.5, edge);
        let table = BodyDef { position: Vec3::NEG_Y * 0.5, ..BodyDef::fixed(Shape::Box { half_extents }) };
        let bodies = [table];
        let mut input = BakeInput { bodies: &bodies, seconds: 2.0, ..BakeInput::new(character.clone()) };
        input.world_from_character.translation.y = up;
        let mut baked = bake(&input);
        // A character that falls over the edge counts as if its clip had moved it on.
        let root =
            character.rig.joints.iter().position(|joint| joint.parent.is_none()).expect("the rig has a root");
        for frame in &mut baked.frames {
            if frame.state != State::Animated {
                frame.state = State::Animated;
                frame.pose = character.rest().to_vec();
                frame.pose[root].translation.z += 1.4 * frame.time / character.ragdoll.unit_scale;
            }
        }
        faults_of_bake(&input, &baked)
    };
    assert_eq!(reasons(9.0, 0.0), []);
    let beyond = reasons(1.0, 0.0);
    assert!(beyond[0].reason.starts_with("its clip moves it on in the air"), "{beyond:?}");
    assert_eq!(beyond[0].at_most, Verdict::Bad);
    let above = reasons(9.0, 5.0);
    assert!(above[0].reason.starts_with("it starts in the air, 5.00 m over"), "{above:?}");
    assert_eq!(above[0].at_most, Verdict::Usable);
}

/// The thick skin of a toy animal encloses several times the mass of the animal that its file names.
#[test]
fn animal_weighs_no_more_than_its_kind() {
    let plain = animal_named("", 0.0).ragdoll;
    let fox = animal_named("fox", 0.0).ragdoll;
    assert!((fox.height - plain.height).abs() < 1e-3, "{} and {} m", fox.height, plain.height);
    assert!(plain.total_mass > 60.0, "{} kg", plain.total_mass);
    assert!(fox.total_mass > 5.0 && fox.total_mass < 35.0, "{} kg", fox.total_mass);
}
