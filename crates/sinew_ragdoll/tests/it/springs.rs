//! Spring bones: against VRM's reference in double precision, at other frame rates, at rest, and through the states of
//! a character.

use sinew_anim::springs::{ColliderShape, LimitKind, Side};
use sinew_anim::{
    GarmentColumn, Rig, SpringBone, SpringCollider, SpringLimit, SpringLink, Springs, analyze,
    guess_garments, guess_springs, rest_pose,
};
use sinew_formats::gltf::SpringFormat;
use sinew_formats::{ReadOptions, no_files, read_gltf};
use sinew_math::{Affine, Random, Reader, Rotation, Transform, Vec3, Writer, trig};
use sinew_physics::{BodyDef, FieldDef, FieldKind, Shape, Wind, World, WorldDef};
use sinew_ragdoll::{BuildOptions, Character, CharacterDef, SpringStep, SpringSwing, State, build};
use sinew_scenes::dressed::{SKIRT, dressed, dressed_rig};
use sinew_scenes::maned::{HAIR, maned, maned_rig};
use sinew_scenes::mannequin::mannequin;
use std::sync::Arc;

mod avatar;
mod changes;
mod reference;

use avatar::{Calming, random_avatar, strands, vrm};
use reference::Reference;

/// Returns the character's transform at a time: its head walks, sways and turns. The head accelerates over a third of a
/// second, because a sudden start has no defined motion between frames.
fn place_at(time: f32) -> Transform {
    let time = time - 0.3 * (1.0 - trig::exp(-time / 0.3));
    let swing = |turns: f32| trig::sin(core::f32::consts::TAU * turns * time);
    let turn = Rotation::from_axis_angle(Vec3::Y, 0.6 * swing(0.7));
    let nod = Rotation::from_axis_angle(Vec3::X, 0.3 * swing(1.1));
    Transform::new(Vec3::new(0.1 * swing(1.3), 0.03 * swing(2.0), 1.2 * time), turn * nod)
}

/// Returns the positions of all tips at every frame, for a frame rate.
fn run(def: &CharacterDef, rate: f32, seconds: f32) -> Vec<Vec<Vec3>> {
    let (rig, pose) = (def.springs(), rest_pose(&def.rig));
    let (mut swing, mut ways) = (SpringSwing::new(), Vec::new());
    // Like the reference, the springs start at rest in the first pose.
    swing.step(&still(def, &pose, Affine::from(place_at(0.0)), 0.0));
    for frame in 1..=(seconds * rate).round() as u32 {
        let root = Affine::from(place_at(frame as f32 / rate));
        swing.step(&still(def, &pose, root, 1.0 / rate));
        ways.push(tips(def, &pose, root, &swing));
        assert_eq!(rig.joints().len(), swing.turns().len());
    }
    ways
}

fn still<'a>(
    def: &'a CharacterDef,
    pose: &'a [sinew_anim::LocalTransform],
    world_from_model: Affine,
    seconds: f32,
) -> SpringStep<'a> {
    SpringStep { rig: def.springs(), pose, world_from_model, bodies: &[], world: None, seconds }
}

/// Returns the world positions of the tips of all bones, computed from joint rotations.
fn tips(
    def: &CharacterDef,
    pose: &[sinew_anim::LocalTransform],
    root: Affine,
    swing: &SpringSwing,
) -> Vec<Vec3> {
    let mut pose = pose.to_vec();
    for (joint, &turn) in def.springs().joints().zip(swing.turns()) {
        pose[joint].rotation = turn;
    }
    let mut model = Vec::new();
    sinew_anim::local_to_model(&def.rig, &pose, &root, &mut model);
    let chains = &def.springs().source().chains;
    chains.iter().flat_map(|chain| &chain.bones).map(|bone| model[bone.joint].point(bone.tail)).collect()
}

/// Returns random settings, typical and untypical for avatars.
fn random_hair(random: &mut Random) -> SpringBone {
    let stiffness = random.range(0.3, 4.0);
    SpringBone {
        stiffness,
        gravity: Vec3::new(random.range(-0.1, 0.1), random.range(-0.5, 0.0), 0.0) * stiffness,
        drag: random.range(0.2, 1.0),
        radius: random.range(0.0, 0.03),
        ..HAIR
    }
}

/// Returns hair like that of `maned`, with random colliders, centres and limits of every kind.
fn random_springs(base: &Rig, random: &mut Random) -> Springs {
    let settings = random_hair(random);
    let mut springs = base.springs.clone();
    let joint = springs.colliders[0].joint;
    let keeps = [Side::Outside, Side::Inside][random.index(2)];
    let far = if keeps == Side::Inside { 0.3 } else { 0.08 };
    let offset = Vec3::new(random.range(-0.05, 0.05), 0.1, random.range(-0.05, 0.05));
    let shape = match random.index(4) {
        0 => ColliderShape::Sphere { offset, radius: far, keeps },
        1 => ColliderShape::Capsule { offset, tail: offset - Vec3::Y * 0.2, radius: far, keeps },
        2 => ColliderShape::Plane {
            offset: Vec3::new(0.0, 0.0, -0.14),
            normal: Vec3::new(0.0, random.range(-0.3, 0.3), -1.0).normalize(),
        },
        _ => ColliderShape::Sphere { offset, radius: 0.0, keeps: Side::Outside },
    };
    springs.colliders.push(SpringCollider { joint, shape });
    let limits = [
        None,
        Some(LimitKind::Cone { angle: random.range(0.1, 1.5) }),
        Some(LimitKind::Hinge { angle: random.range(0.1, 1.5) }),
        Some(LimitKind::Spherical { phi: random.range(0.1, 1.5), theta: random.range(0.1, 1.0) }),
    ];
    let kind = limits[random.index(4)];
    let rotation = Rotation::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), random.range(-0.3, 0.3));
    let centered = random.index(3) == 0;
    for chain in &mut springs.chains {
        chain.colliders = vec![0, 1];
        chain.center = centered.then_some(1);
        for bone in &mut chain.bones {
            let limit = kind.map(|kind| SpringLimit { kind, rotation });
            *bone = SpringBone { joint: bone.joint, tail: bone.tail, limit, ..settings };
        }
    }
    springs
}

#[test]
fn springs_match_the_reference_at_60_frames_per_second() {
    let mut def = maned(&HAIR);
    let mut random = Random::new(24);
    let mut worst = 0.0_f64;
    for case in 0..60 {
        let springs = random_springs(&def.rig, &mut random);
        def.set_springs(&springs);
        assert!(def.springs().left_out().is_empty());
        let ways = run(&def, 60.0, 2.0);
        let mut reference = Reference::new(&def.rig, &springs, place_at(0.0));
        for (frame, tips) in ways.iter().enumerate() {
            reference.frame(place_at((frame + 1) as f32 / 60.0), 1.0 / 60.0);
            for (tip, due) in tips.iter().zip(reference.tips()) {
                let apart = (tip.as_dvec3() - due).length();
                worst = worst.max(apart);
                assert!(apart < 1e-4, "case {case}, frame {frame}: off by {apart} m, {springs:?}");
            }
        }
    }
    println!("largest distance from the reference: {worst:.2e} m");
}

#[test]
fn spring_motion_is_independent_of_the_frame_rate() {
    let mut def = maned(&HAIR);
    let mut random = Random::new(7);
    let mut worst = [0.0_f32; 4];
    for case in 0..40 {
        let mut springs = random_springs(&def.rig, &mut random);
        springs.chains.iter_mut().for_each(|chain| chain.colliders.truncate(1));
        def.set_springs(&springs);
        let due = run(&def, 60.0, 3.0);
        for (rate, worst) in [30.0, 90.0, 144.0, 240.0].into_iter().zip(&mut worst) {
            let ways = run(&def, rate, 3.0);
            for sixth in 1..=18 {
                let at = |ways: &[Vec<Vec3>], rate: f32| {
                    ways[(sixth as f32 * rate / 6.0).round() as usize - 1].clone()
                };
                for (tip, due) in at(&ways, rate).iter().zip(at(&due, 60.0)) {
                    // The shortest bone is 63 mm long.
                    let apart = (*tip - due).length() / 0.063;
                    *worst = worst.max(apart);
                    assert!(apart < 0.05, "case {case} at {rate} Hz: off by {apart} bone lengths");
                }
            }
        }
    }
    println!("30, 90, 144, 240 Hz: at most {worst:.4?} bone lengths from 60 Hz");
}

#[test]
fn motion_between_ticks_is_smooth() {
    // At 240 frames a second, three of four frames lie between ticks. Displacements of consecutive frames differ by
    // less than a fifth of the largest. Measured: 11 % for the first bone, 18 % for the free end of five.
    let def = maned(&HAIR);
    let ways = run(&def, 240.0, 2.0);
    for tip in 0..ways[0].len() {
        let motion = |frame: usize| ways[frame][tip] - ways[frame - 1][tip];
        let fastest = (1..ways.len()).map(|frame| motion(frame).length()).fold(0.0, sinew_math::max);
        let jerks = (2..ways.len()).map(|frame| (motion(frame) - motion(frame - 1)).length());
        let jerk = jerks.fold(0.0, sinew_math::max);
        println!("tip {tip}: {:.1} mm a frame, {:.2} mm from one to the next", 1e3 * fastest, 1e3 * jerk);
        assert!(
            fastest > 4e-3 && jerk < 0.2 * fastest,
            "tip {tip}: change of speed {jerk}, fastest {fastest}"
        );
    }
}

/// Returns a character with hair that stands on a floor, and its world.
fn standing(settings: &SpringBone) -> (World, Character) {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let mut def = maned(settings);
    let motions = sinew_ragdoll::MotionSet { looped: None, ..def.motions().clone() };
    def.set_motions(motions).unwrap();
    let character = Character::spawn(&mut world, &Arc::new(def), Transform::IDENTITY);
    (world, character)
}

fn hair_of(character: &Character) -> Vec<Rotation> {
    character.def().springs().joints().map(|joint| character.pose()[joint].rotation).collect()
}

#[test]
fn resting_hair_stays_still_for_a_minute() {
    for (stiffness, sag, drag) in [(0.8, 0.25, 0.4), (4.0, 0.0, 0.1), (0.2, 1.0, 0.1), (1.0, 0.5, 1.0)] {
        let settings = SpringBone { stiffness, gravity: Vec3::NEG_Y * (sag * stiffness), drag, ..HAIR };
        let (mut world, mut character) = standing(&settings);
        for _ in 0..300 {
            world.step();
            character.update(&mut world);
        }
        let settled = hair_of(&character);
        let mut most = 0.0_f32;
        for _ in 0..3600 {
            world.step();
            character.update(&mut world);
            for (now, then) in hair_of(&character).into_iter().zip(&settled) {
                most = most.max(now.angle_to(*then));
            }
        }
        assert!(most < 2e-3, "stiffness {stiffness}, drag {drag}: rotated by {most} rad");
    }
}

/// Returns the largest displacement of each tip from frame to frame at rest, and from its first position within a
/// minute, metres. The measurement starts after a second of motion and five to settle.
fn motion_after_settling(def: &CharacterDef, rate: f32, settling: f32) -> Vec<[f32; 2]> {
    let pose = rest_pose(&def.rig);
    let mut swing = SpringSwing::new();
    let (moving, settling) = (rate as u32, (settling * rate) as u32);
    let mut settled = Vec::new();
    let mut before: Vec<Vec3> = Vec::new();
    let mut most = Vec::new();
    for frame in 0..=moving + settling + (60.0 * rate) as u32 {
        let place = place_at(frame.min(moving) as f32 / rate);
        let root = def.mapping().world_from_model(place);
        swing.step(&still(def, &pose, root, 1.0 / rate));
        let now = tips(def, &pose, root, &swing);
        if frame == moving + settling {
            settled.clone_from(&now);
            most = vec![[0.0; 2]; now.len()];
        } else if frame > moving + settling {
            for (index, &tip) in now.iter().enumerate() {
                assert!(tip.is_finite());
                let [step, way] = &mut most[index];
                *step = sinew_math::max(*step, (tip - before[index]).length());
                *way = sinew_math::max(*way, (tip - settled[index]).length());
            }
        }
        before = now;
    }
    most
}

/// Avatars resemble those in files: strands of three to six bones, stiff and soft, with and without gravity, with every
/// collider and limit in contact at rest, in world or joint space. Two of six have almost no stiffness or drag, and get
/// minutes to settle.
#[test]
fn avatar_tips_stay_still_for_a_minute() {
    let mut rig = mannequin().rig;
    let hair = strands(&mut rig);
    let analysis = analyze(&rig).expect("the mannequin has a skin");
    let (ragdoll, _) = build(&rig, &analysis, &BuildOptions::default()).expect("the rig can be built");
    let mut def = CharacterDef::new(rig.clone(), ragdoll, &analysis.bind_model);
    let (mut random, mut worst) = (Random::new(60), [0.0_f32; 2]);
    for case in 0..6 {
        let (calming, settling) = if case % 3 == 2 { (Calming::Late, 180.0) } else { (Calming::Soon, 5.0) };
        let format = if case == 3 { SpringFormat::Vrm0 } else { SpringFormat::Vrm1 };
        rig.springs = random_avatar(&rig, &hair, calming, &mut random);
        let file = read_gltf(&vrm(&rig, format), ReadOptions::default(), &mut no_files).expect("a VRM");
        def.set_springs(&file.rig.springs);
        let springs = def.springs().source();
        assert_eq!(springs.bone_count(), if format == SpringFormat::Vrm0 { 66 } else { 54 });
        for rate in [30.0, 60.0, 240.0] {
            let most = motion_after_settling(&def, rate, settling);
            let bones =
                springs.chains.iter().flat_map(|chain| chain.bones.iter().map(move |bone| (chain, bone)));
            for ((chain, bone), [step, way]) in bones.zip(most) {
                worst = [sinew_math::max(worst[0], step), sinew_math::max(worst[1], way)];
                let colliders: Vec<_> =
                    chain.colliders.iter().map(|&index| springs.colliders[index].shape).collect();
                assert!(
                    step < 1e-4 && way < 1e-3,
                    "case {case} at {rate} a second, {}: {step} m a frame, {way} m in a minute; \
                     {bone:?}, center {:?}, {colliders:?}",
                    chain.name,
                    chain.center
                );
            }
        }
    }
    println!("at most {:.1e} m from frame to frame, {:.1e} m in a minute", worst[0], worst[1]);
}

/// At 240 frames a second, tips drawn between two ticks are no deeper in the turning, nodding head than at ticks.
#[test]
fn tips_drawn_between_ticks_stay_out_of_colliders() {
    let mut def = maned(&HAIR);
    let mut springs = def.springs().source().clone();
    let ColliderShape::Sphere { offset, .. } = springs.colliders[0].shape else { panic!("a ball") };
    // The radius is large enough to touch all three strands, except for their first bones.
    let radius = 0.13;
    springs.colliders[0].shape = ColliderShape::Sphere { offset, radius, keeps: Side::Outside };
    def.set_springs(&springs);
    let ways = run(&def, 240.0, 3.0);
    let (mut depth, mut touched) = ([0.0_f32; 2], 0);
    for (frame, tips) in (1_u16..).zip(&ways) {
        let mut model = Vec::new();
        let root = Affine::from(place_at(f32::from(frame) / 240.0));
        sinew_anim::local_to_model(&def.rig, &rest_pose(&def.rig), &root, &mut model);
        let middle = model[springs.colliders[0].joint].point(offset);
        for tip in tips {
            let deep = radius + HAIR.radius - (*tip - middle).length();
            touched += usize::from(deep > -1e-4);
            let part = usize::from(frame % 4 != 0);
            depth[part] = sinew_math::max(depth[part], deep);
        }
    }
    println!("{touched} touched; {:.2e} m deep at ticks, {:.2e} m between", depth[0], depth[1]);
    assert!(touched > 1000 && depth[1] < depth[0] + 1e-3, "{touched} contacts, depths {depth:?} m");
}

#[test]
fn strand_sags_by_the_closed_form() {
    // At rest the tip points along stiffness · r + gravity.
    let settings = SpringBone { stiffness: 1.0, gravity: Vec3::new(0.5, 0.0, 0.0), radius: 0.0, ..HAIR };
    let mut def = maned(&settings);
    let mut springs = def.springs().source().clone();
    springs.chains.truncate(1);
    springs.chains[0].bones.truncate(1);
    springs.chains[0].colliders.clear();
    def.set_springs(&springs);
    let pose = rest_pose(&def.rig);
    let mut swing = SpringSwing::new();
    for _ in 0..600 {
        swing.step(&still(&def, &pose, Affine::IDENTITY, 1.0 / 60.0));
    }
    let bone = &springs.chains[0].bones[0];
    let lies = swing.turns()[0] * bone.tail.normalize();
    let due = (bone.tail.normalize() + settings.gravity).normalize();
    assert!((lies - due).length() < 1e-5, "{lies} {due}");
}

#[test]
fn wind_moves_hair_and_teleports_do_not() {
    let (mut world, mut character) = standing(&SpringBone { drag: 0.5, ..HAIR });
    let steps = |world: &mut World, character: &mut Character, count: u32| {
        for _ in 0..count {
            world.step();
            character.update(world);
        }
    };
    steps(&mut world, &mut character, 200);
    let calm = hair_of(&character);
    // After a teleport the hair is unchanged, to rounding.
    character.teleport(&mut world, Transform::from_translation(Vec3::new(50.0, 0.0, -20.0)));
    steps(&mut world, &mut character, 1);
    for (now, then) in hair_of(&character).iter().zip(&calm) {
        assert!(now.angle_to(*then) < 0.02, "the teleport swings the hair by {} rad", now.angle_to(*then));
    }
    steps(&mut world, &mut character, 120);
    let field = FieldKind::Wind(Wind { velocity: Vec3::new(3.0, 0.0, 0.0), ..Wind::default() });
    world.add_field(&FieldDef::new(field));
    steps(&mut world, &mut character, 200);
    let blown = hair_of(&character)[0].angle_to(calm[0]);
    assert!(blown > 0.3, "a wind of 3 m/s rotates the hair by only {blown} rad");
    // The wind pushes the tip by drag · wind = 1.5 m/s, against a stiffness of 0.8 m/s.
}

/// The hair's largest rotation within one step is bounded while the character stands, is hit, falls, lies, and is up
/// again.
#[test]
fn hair_follows_a_fall_without_a_pop() {
    let (mut world, mut character) = standing(&HAIR);
    let head = character.def().body_named("head").unwrap();
    let lengths: Vec<f32> = character
        .def()
        .springs()
        .source()
        .chains
        .iter()
        .flat_map(|c| &c.bones)
        .map(|b| b.tail.length())
        .collect();
    let mut before: Option<Vec<Vec3>> = None;
    let (mut states, mut worst) = (Vec::new(), 0.0_f32);
    for step in 0..1500 {
        if step == 60 {
            character.hit(&mut world, head, Vec3::new(20.0, 0.0, -60.0));
        }
        world.step();
        character.update(&mut world);
        if states.last() != Some(&character.state()) {
            states.push(character.state());
        }
        let place = character.world_from_model();
        let mut model = Vec::new();
        sinew_anim::local_to_model(&character.def().rig, character.pose(), &place, &mut model);
        let chains = &character.def().springs().source().chains;
        let tips: Vec<Vec3> = chains
            .iter()
            .flat_map(|chain| &chain.bones)
            .map(|bone| model[bone.joint].point(bone.tail))
            .collect();
        for (&tip, &length) in tips.iter().zip(&lengths) {
            assert!(tip.is_finite() && length > 0.0);
            // The tips are on the floor, not below it, except where the head pushes them.
            assert!(tip.y > -0.02, "step {step}: a tip is at {tip}");
        }
        if let Some(before) = &before {
            for (now, then) in tips.iter().zip(before) {
                worst = worst.max((*now - *then).length() * 60.0);
            }
        }
        before = Some(tips);
    }
    assert!(states.contains(&State::Limp) && states.last() == Some(&State::Animated), "{states:?}");
    // The head hits the floor at about 5 m/s; hair whips but does not jump.
    assert!(worst < 15.0, "a tip at {worst} m/s");
}

#[test]
fn snapshot_during_a_swing_continues_identically() {
    // Steps that are not whole ticks, so that a partial tick is saved.
    let mut world = World::new(WorldDef { step_nanoseconds: 1_000_000_000 / 144, ..WorldDef::default() });
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let def = Arc::new(maned(&HAIR));
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    for _ in 0..101 {
        world.step();
        character.update(&mut world);
    }
    let mut w = Writer::new();
    character.save(&mut w);
    let mut copy = Character::new(def, Transform::IDENTITY, 0.0);
    copy.load(&mut Reader::new(w.as_bytes())).unwrap();
    assert_eq!(copy.pose(), character.pose());
    let bytes = |character: &Character| {
        let mut w = Writer::new();
        character.save(&mut w);
        w.into_bytes()
    };
    let mut other = world.clone();
    for _ in 0..200 {
        world.step();
        character.update(&mut world);
        other.step();
        copy.update(&mut other);
        assert_eq!(bytes(&copy), bytes(&character));
        assert_eq!(copy.pose(), character.pose());
    }
    let cut = &bytes(&character)[..bytes(&character).len() - 9];
    assert!(copy.load(&mut Reader::new(cut)).is_err());
}

#[test]
fn spring_step_does_not_allocate_after_warm_up() {
    let (mut world, mut character) = standing(&HAIR);
    let mut hairless = Character::spawn(
        &mut world,
        &Arc::new({
            let mut def = CharacterDef::clone(character.def());
            def.set_springs(&Springs::default());
            def
        }),
        Transform::from_translation(Vec3::X * 3.0),
    );
    for _ in 0..60 {
        world.step();
        character.update(&mut world);
        hairless.update(&mut world);
    }
    let count = |who: &mut Character, world: &mut World| {
        allocation_counter::measure(|| who.update(world)).count_total
    };
    assert_eq!(count(&mut character, &mut world), count(&mut hairless, &mut world));
}

#[test]
fn scaled_character_has_the_same_spring_motion() {
    let def = maned(&HAIR);
    let large = def.scaled(10.0);
    let pose = rest_pose(&def.rig);
    let (mut small, mut big) = (SpringSwing::new(), SpringSwing::new());
    for frame in 0..120 {
        let at = place_at(frame as f32 / 60.0);
        let tall = Transform { translation: at.translation * 10.0, ..at };
        small.step(&still(&def, &pose, def.mapping().world_from_model(at), 1.0 / 60.0));
        big.step(&still(&large, &pose, large.mapping().world_from_model(tall), 1.0 / 60.0));
        for (a, b) in small.turns().iter().zip(big.turns()) {
            assert!(a.angle_to(*b) < 1e-3, "frame {frame}: {}", a.angle_to(*b));
        }
    }
}

#[test]
fn joints_with_bodies_are_no_springs() {
    let mut rig = maned_rig(&HAIR);
    let arm = rig.joints.iter().position(|joint| joint.name == "leftLowerArm").unwrap();
    rig.springs.chains[0].bones[0].joint = arm;
    let def = {
        let mut def = maned(&HAIR);
        def.set_springs(&rig.springs);
        def
    };
    assert_eq!(def.springs().left_out(), [arm]);
    assert_eq!(def.springs().joints().len(), rig.springs.bone_count() - 1);
}

/// Throws one ponytail bone to the side: the bone is carried along by 3 cm a tick, then stopped. Returns the largest
/// displacement of the tip to that side of its rest position within ten ticks, metres.
fn thrown(colliders: Vec<SpringCollider>, world: Option<&World>) -> f32 {
    let mut def =
        maned(&SpringBone { stiffness: 1.5, gravity: Vec3::ZERO, radius: 0.002, drag: 0.1, ..HAIR });
    let mut springs = def.springs().source().clone();
    springs.chains.truncate(1);
    springs.chains[0].bones.truncate(1);
    springs.chains[0].colliders = (0..colliders.len()).collect();
    springs.colliders = colliders;
    def.set_springs(&springs);
    let pose = rest_pose(&def.rig);
    let mut swing = SpringSwing::new();
    let mut most = 0.0_f32;
    for frame in 0..20u8 {
        let x = 0.03 * (f32::from(frame.min(10)) - 10.0);
        let root = Affine::from(Transform::from_translation(Vec3::X * x));
        let world = world.map(|world| (world, [].as_slice()));
        swing.step(&SpringStep { world, ..still(&def, &pose, root, 1.0 / 60.0) });
        if frame >= 10 {
            most = most.max(tips(&def, &pose, root, &swing)[0].x);
        }
    }
    most
}

/// Returns the joint of the ponytail's parent, and the ends of its first bone at rest in that joint's space.
fn ponytail() -> (usize, Vec3, Vec3) {
    let rig = maned_rig(&HAIR);
    let bone = rig.springs.chains[0].bones[0];
    let root = rig.joints[bone.joint].rest.translation;
    (rig.joints[bone.joint].parent.unwrap(), root, root + bone.tail)
}

#[test]
fn fast_tip_is_stopped_by_a_thin_collider() {
    let free = thrown(Vec::new(), None);
    let (joint, root, tip) = ponytail();
    // Add a needle of 2 mm beside the bone and parallel to it.
    let out = (tip - root) * 0.5;
    let needle = |offset: Vec3, tail: Vec3| {
        let shape = ColliderShape::Capsule { offset, tail, radius: 0.001, keeps: Side::Outside };
        thrown(vec![SpringCollider { joint, shape }], None)
    };
    let aside = Vec3::X * 0.012;
    let stopped = needle(tip + aside - out, tip + aside + out);
    println!("free {free}, stopped at {stopped}");
    assert!(free > 0.02, "the free tip moves only {free} m");
    assert!(stopped < 0.013, "the tip passed through the collider: {stopped} m");
    // A needle that the bone does not reach has no effect.
    assert_eq!(needle(tip + aside - Vec3::Y, tip + aside - Vec3::Y * 0.9), free);
}

#[test]
fn fast_tip_is_stopped_by_a_thin_wall() {
    let mut world = World::new(WorldDef::default());
    let wall = |x: f32| BodyDef {
        position: Vec3::X * x,
        ..BodyDef::fixed(Shape::Box { half_extents: Vec3::new(0.001, 5.0, 5.0) })
    };
    let free = thrown(Vec::new(), Some(&world));
    assert_eq!(free, thrown(Vec::new(), None));
    world.add_body(&wall(0.012));
    let stopped = thrown(Vec::new(), Some(&world));
    println!("the free tip moves {free} m, the stopped one {stopped} m");
    assert!(free > 0.02 && stopped < 0.012, "the tip passed through the collider: {stopped} m of {free} m");
}

/// Moves braids apart by wind, with and without links, and returns the smallest and largest distance of their ends at
/// 30 frames a second, relative to the bind pose.
fn parted(links: bool, holds_apart: bool, push: f32, rate: f32) -> Vec<f32> {
    let mut def = maned(&HAIR);
    let mut springs = def.springs().source().clone();
    let (mut ends, mut linked) = (Vec::new(), Vec::new());
    for (chain, side) in springs.chains[1..].iter_mut().zip([push, -push]) {
        chain.bones.iter_mut().for_each(|bone| bone.gravity += Vec3::X * side);
        ends.push(chain.bones.len());
        linked.push(chain.bones.iter().map(|bone| bone.joint).collect::<Vec<_>>());
    }
    if links {
        let pairs = linked[0].iter().zip(&linked[1]);
        springs.links.extend(pairs.map(|(&a, &b)| SpringLink { joints: [a, b], share: 1.0, holds_apart }));
    }
    let first = springs.chains[0].bones.len();
    def.set_springs(&springs);
    let pose = rest_pose(&def.rig);
    let rest = {
        let mut swing = SpringSwing::new();
        swing.step(&still(&def, &pose, Affine::from(place_at(0.0)), 0.0));
        tips(&def, &pose, Affine::from(place_at(0.0)), &swing)
    };
    let apart = |tips: &[Vec3]| (tips[first + ends[0] - 1] - tips[first + ends[0] + ends[1] - 1]).length();
    let every = (rate / 30.0).round() as usize;
    let ways = run(&def, rate, 3.0);
    ways.iter().skip(every - 1).step_by(every).map(|tips| apart(tips) / apart(&rest)).collect()
}

#[test]
fn spring_links_limit_the_distance_of_strands() {
    let range = |apart: &[f32]| {
        (
            apart.iter().copied().fold(f32::MAX, sinew_math::min),
            apart.iter().copied().fold(0.0, sinew_math::max),
        )
    };
    let (_, free) = range(&parted(false, false, 0.5, 60.0));
    let (_, held) = range(&parted(true, false, 0.5, 60.0));
    println!("distance in wind over distance at rest: {free} without links, {held} with links");
    assert!(free > 1.4 && held < 1.0 + 0.2 * (free - 1.0), "{free} {held}");
    let (close, _) = range(&parted(false, false, -0.5, 60.0));
    let (still_close, _) = range(&parted(true, false, -0.5, 60.0));
    let (apart, _) = range(&parted(true, true, -0.5, 60.0));
    println!("distance in wind: {close}, with one-sided links {still_close}, with two-sided links {apart}");
    let least = 1.0 - 0.2 * (1.0 - close);
    assert!(
        close < 0.6 && still_close == close && apart > least,
        "distance in wind: {close}, one-sided links {still_close}, two-sided links {apart}"
    );
}

#[test]
fn skirt_strands_are_linked_by_name() {
    let rig = dressed_rig(&[&SKIRT]);
    let springs = guess_springs(&rig, Vec3::Y);
    let strands = |links: &[SpringLink]| {
        let strand = |joint: usize| rig.joints[joint].name.rsplit_once('_').unwrap().0.to_owned();
        links.iter().map(|link| link.joints.map(strand)).collect::<std::collections::BTreeSet<_>>()
    };
    // Ten strands in a ring, each linked to the next at equal depth: names give the order.
    assert_eq!(springs.links.len(), SKIRT.columns * SKIRT.bones);
    for [a, b] in strands(&springs.links) {
        let number = |name: &str| name.rsplit_once('_').unwrap().1.parse::<usize>().unwrap();
        let apart = number(&a).abs_diff(number(&b));
        assert!(apart == 1 || apart == SKIRT.columns - 1, "{a} {b}");
    }
    assert!(springs.links.iter().all(|link| link.joints.iter().all(|&joint| springs.swings(joint))));
    // An open skirt has one column of links fewer. Two strands have one, closed or not.
    let columns: Vec<_> = guess_garments(&rig)[0].columns.clone();
    let count = |columns: &[GarmentColumn], closed| SpringLink::default().across(columns, closed).len();
    let long = columns[0].joints.len();
    assert_eq!([count(&columns, true), count(&columns, false)], [10 * long, 9 * long]);
    assert_eq!([count(&columns[..2], true), count(&columns[..1], true)], [long, 0]);
    // Hair has no links.
    assert!(guess_springs(&maned_rig(&HAIR), Vec3::Y).links.is_empty());
    // A skirt worn as springs has links; worn as a garment it has no springs.
    let mut def = dressed(&[&SKIRT], |_| ());
    def.set_springs(&springs);
    assert_eq!(def.springs().link_count(), springs.links.len());
    def.set_garments(&guess_garments(&rig));
    assert_eq!(def.springs().link_count(), 0);
}

#[test]
fn linked_motion_is_independent_of_the_frame_rate() {
    let due = parted(true, true, 0.5, 60.0);
    for rate in [30.0, 90.0, 240.0] {
        for (frame, (now, due)) in parted(true, true, 0.5, rate).iter().zip(&due).enumerate() {
            // The braids are 0.34 m apart, and a bone is 0.063 m long.
            assert!(
                (now - due).abs() * 0.34 < 0.05 * 0.063,
                "frame {frame} at {rate} Hz: {now}, expected {due}"
            );
        }
    }
}
