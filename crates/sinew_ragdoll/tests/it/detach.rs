//! Detached limbs: a limb keeps its motion, the other bodies stay animated, and the world's own calls cannot remove
//! parts of a character.

use crate::actor::{shared, walker};
use crate::in_world::{level, run};
use sinew_math::{Reader, Transform, Vec3, Writer, max};
use sinew_physics::particles::AttachmentTarget;
use sinew_physics::{BodyKind, JointId, Velocity, World};
use sinew_ragdoll::{Character, CharacterDef, CharacterEvent, Limb, Preset, State};
use sinew_scenes::dressed::{CAPE, SKIRT, dressed};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// States in which a limb is detached.
const STATES: [State; 6] =
    [State::Animated, State::Limp, State::Preparing, State::GettingUp, State::Flinching, State::Powered];

/// Returns a character that has reached `state`, with its world.
fn in_state(def: &Arc<CharacterDef>, state: State) -> (World, Character) {
    let mut world = level();
    let mut character = Character::spawn(&mut world, def, Transform::IDENTITY);
    run(&mut world, &mut character, 20);
    match state {
        State::Animated => {}
        State::Flinching => {
            let hand = def.body_named("rightHand").expect("the character has hands");
            character.hit(&mut world, hand, Vec3::new(-6.0, 0.0, 0.0));
        }
        State::Powered => character.set_preset(&mut world, Preset::Powered),
        _ => character.go_limp(&mut world),
    }
    for _ in 0..1200 {
        if character.state() == state {
            run(&mut world, &mut character, 3);
            if character.state() == state {
                return (world, character);
            }
        }
        run(&mut world, &mut character, 1);
        if state == State::Preparing && character.state() == State::Animated {
            character.go_limp(&mut world);
        }
    }
    panic!("the character never entered {state:?}");
}

/// Returns the total energy of the bodies, J.
fn energy(world: &World) -> f32 {
    world.energy().total()
}

/// Returns the largest joint gap of characters and limbs, metres.
fn widest_gap(world: &World) -> f32 {
    let owned = world.joint_ids().filter(|&joint| world.joint_owner(joint).is_some());
    owned.map(|joint| world.joint_gap(joint)).fold(0.0, max)
}

/// Returns the largest speed of a dynamic body, m/s.
fn fastest(world: &World) -> f32 {
    let dynamic = world.body_ids().filter(|&body| world.kind(body) == BodyKind::Dynamic);
    dynamic.map(|body| world.velocity(body).linear.length()).fold(0.0, max)
}

fn message(panics: impl FnOnce()) -> String {
    let panic = catch_unwind(AssertUnwindSafe(panics)).expect_err("the world must refuse the call");
    panic.downcast_ref::<String>().expect("a message with names").clone()
}

#[test]
fn removing_an_owned_body_names_the_character_and_the_call() {
    let def = shared(walker());
    let (mut world, character) = in_state(&def, State::Limp);
    let arm = character.bodies()[def.body_named("leftUpperArm").expect("the character has arms")];
    let joints: Vec<JointId> = world.joints_of(arm).collect();
    let panic_text = message(|| world.remove_joint(joints[0]));
    assert!(
        panic_text.contains("character's leftUpperArm") && panic_text.contains("`Character::detach`"),
        "{panic_text}"
    );
    let panic_text = message(|| world.remove_body(arm));
    assert!(
        panic_text.contains("character's leftUpperArm") && panic_text.contains("`Character::despawn`"),
        "{panic_text}"
    );
    // Repeat the test in a world loaded from a snapshot, and for hit bodies.
    let mut w = Writer::new();
    world.save(&mut w);
    let mut other = World::new(world.def().clone());
    other.load(&mut Reader::new(w.as_bytes())).expect("the snapshot is valid");
    let panic_text = message(|| other.remove_body(arm));
    assert!(panic_text.contains("character's leftUpperArm"), "{panic_text}");
    let (mut world, character) = in_state(&def, State::Animated);
    let panic_text = message(|| world.remove_body(character.bodies()[0]));
    assert!(panic_text.contains("character's hips"), "{panic_text}");
    character.despawn(&mut world);
    assert_eq!(world.body_ids().count(), 1);
    // Bodies without an owner can be removed.
    let floor = world.body_ids().next().expect("the floor is there");
    world.remove_body(floor);
}

#[test]
fn detached_limb_keeps_its_motion_in_every_state() {
    let def = shared(walker());
    for state in STATES {
        for (bone, gets_up) in [
            ("leftUpperArm", true),
            ("rightHand", true),
            ("leftUpperLeg", false),
            ("rightFoot", false),
            ("head", false),
            ("spine", false),
        ] {
            let (mut world, mut character) = in_state(&def, state);
            let what = format!("{bone} off in state {state:?}");
            let first = def.body_named(bone).expect("the character has this part");
            let had: Vec<_> = character.bodies().to_vec();
            let is_led = world.kind(had[first]) != BodyKind::Dynamic;
            let before: Vec<Velocity> = had.iter().map(|&body| world.velocity(body)).collect();
            let (joules, speed) = (energy(&world), fastest(&world));
            let limb = character.detach(&mut world, bone).expect("the character has this part");
            assert!(character.events().contains(&CharacterEvent::Detached { body: first }), "{what}");
            if !is_led {
                assert!(
                    energy(&world) <= joules * 1.0001,
                    "{what}: energy {joules} J rose to {} J",
                    energy(&world)
                );
                for (&part, &body) in limb.parts().iter().zip(limb.bodies()) {
                    assert_eq!(world.velocity(body), before[part], "{what}: the velocity must not change");
                }
            }
            for (&part, &body) in limb.parts().iter().zip(limb.bodies()) {
                assert_eq!((body, character.has_body(part)), (had[part], false), "{what}");
                assert_eq!(character.body_index(body), None, "{what}");
                let away = (world.velocity(body).linear - before[part].linear).length();
                assert!(away < 1.0, "{what}: the velocity of body {part} is off by {away} m/s");
            }
            let mut up = false;
            let mut most = 0.0;
            for step in 0..900 {
                world.step();
                character.update(&mut world);
                most = max(most, fastest(&world));
                assert!(widest_gap(&world) < 0.01, "{what}: gap {} m, step {step}", widest_gap(&world));
                up |= character.events().contains(&CharacterEvent::Up);
                let poses = character.pose().iter();
                assert!(poses.clone().all(|local| local.rotation.is_finite()), "{what}");
            }
            assert!(most < max(speed, 10.0), "{what}: {most} m/s");
            if gets_up {
                assert_eq!(
                    character.state(),
                    if state == State::Powered { State::Powered } else { State::Animated },
                    "{what}"
                );
                assert_eq!(
                    up,
                    !matches!(state, State::Animated | State::Powered | State::Flinching),
                    "{what}"
                );
            } else {
                assert_eq!((character.state(), up), (State::Limp, false), "{what}");
            }
            limb.despawn(&mut world);
            run(&mut world, &mut character, 60);
            character.despawn(&mut world);
            assert_eq!((world.body_ids().count(), world.joint_ids().count()), (1, 0), "{what}");
        }
    }
}

#[test]
fn nested_limbs_and_the_rest_share_the_whole_skin() {
    let def = shared(walker());
    let (mut world, mut character) = in_state(&def, State::Limp);
    let mut arm = character.detach(&mut world, "leftUpperArm").expect("the character has arms");
    let hand = arm.detach(&mut world, "leftHand").expect("the arm has a hand");
    assert!(arm.detach(&mut world, "leftHand").is_none(), "a detached limb cannot be detached again");
    assert!(arm.detach(&mut world, "leftUpperArm").is_none(), "a limb's root cannot be detached");
    assert!(character.detach(&mut world, "leftHand").is_none(), "it left with the arm");
    assert_eq!(
        [arm.bodies().len(), hand.bodies().len(), arm.joints().len(), hand.joints().len()],
        [2, 1, 1, 0]
    );
    let lost = character.lost_joints();
    let mut drawn: Vec<usize> = arm.skin_joints().chain(hand.skin_joints()).collect();
    drawn.sort_unstable();
    assert_eq!(drawn, lost, "exactly one of them must draw each joint of the arm");
    assert!(lost.len() >= 3 && lost.len() < def.rig.joints.len() / 2);
    // The skin joint of a limb is near its body.
    run(&mut world, &mut character, 120);
    let mut places = Vec::new();
    arm.world_from_joints(&world, 1.0, &mut places);
    let upper = def.body_named("leftUpperArm").expect("the character has arms");
    let bind = |body: usize| def.ragdoll.bodies[body].character_from_body;
    let joint =
        arm.skin_joints().position(|joint| joint == def.ragdoll.bodies[upper].joint).expect("its own");
    let away = (places[joint].translation - world.transform(arm.bodies()[0]).translation).length();
    assert!(away < 0.3, "the shoulder is {away} m from the centre of the arm ({:?})", bind(upper));
    // Skins of character and limb have a finite matrix for each joint.
    for skin in 0..def.rig.skins.len() {
        let mut palettes = [Vec::new(), Vec::new(), Vec::new()];
        character.skin_palette(skin, 1.0, &mut palettes[0]);
        arm.skin_palette(&world, skin, 1.0, &mut palettes[1]);
        hand.skin_palette(&world, skin, 1.0, &mut palettes[2]);
        for palette in &palettes {
            assert_eq!(palette.len(), def.rig.skins[skin].joints.len());
            assert!(palette.iter().flatten().all(|x| x.is_finite()));
        }
        // Each joint is drawn by exactly one of the three.
        for at in 0..palettes[0].len() {
            let draws = palettes.iter().filter(|palette| palette[at][..3] != [0.0; 3]).count();
            assert_eq!(draws, 1, "joint {at}");
        }
    }
}

#[test]
fn detached_character_is_identical_in_a_loaded_world() {
    let def = shared(walker());
    for state in STATES {
        let (mut world, mut character) = in_state(&def, state);
        let mut limbs: Vec<Limb> = character.detach(&mut world, "leftUpperArm").into_iter().collect();
        run(&mut world, &mut character, 10);
        limbs.extend(character.detach(&mut world, "rightFoot"));
        run(&mut world, &mut character, 2);
        let mut w = Writer::new();
        world.save(&mut w);
        character.save(&mut w);
        limbs.iter().for_each(|limb| limb.save(&mut w));
        let mut r = Reader::new(w.as_bytes());
        let mut other_world = World::new(world.def().clone());
        other_world.load(&mut r).expect("the snapshot is valid");
        let mut other = Character::new(def.clone(), Transform::IDENTITY, 0.0);
        other.load(&mut r).expect("the file is a character");
        let loaded: Vec<Limb> =
            limbs.iter().map(|_| Limb::load(&def, &mut r).expect("it is a limb")).collect();
        r.finish().expect("there is no more");
        for step in 0..400 {
            for (world, character) in [(&mut world, &mut character), (&mut other_world, &mut other)] {
                world.step();
                character.update(world);
            }
            assert_eq!(world.hash(), other_world.hash(), "other world: {state:?}, step {step}");
            assert_eq!(character.pose(), other.pose(), "other pose: {state:?}, step {step}");
        }
        for (mut world, limbs) in [(world, limbs), (other_world, loaded)] {
            limbs.into_iter().for_each(|limb| limb.despawn(&mut world));
        }
    }
}

#[test]
fn garments_stay_attached_to_the_remaining_body() {
    let def = Arc::new(dressed(&[&CAPE, &SKIRT], |_| ()));
    for (bone, limp) in [("leftUpperLeg", false), ("leftUpperArm", false), ("head", true), ("spine", true)] {
        let mut world = level();
        let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
        if limp {
            character.go_limp(&mut world);
        }
        run(&mut world, &mut character, 30);
        let particles = |world: &World, character: &Character| {
            let groups = character.garments().iter().map(|&id| world.particles(id).positions().to_vec());
            groups.collect::<Vec<_>>()
        };
        let before = particles(&world, &character);
        let limb = character.detach(&mut world, bone).expect("the character has this part");
        assert_eq!(particles(&world, &character), before, "{bone}: cloth positions changed");
        let attached = world.group_ids().flat_map(|id| world.particles(id).attachments().to_vec());
        let holds = |target: &AttachmentTarget| match target {
            AttachmentTarget::Body { body, .. } => limb.bodies().contains(body),
            _ => false,
        };
        assert!(
            !attached.into_iter().any(|at| holds(&at.target)),
            "{bone}: no particle is attached to the limb"
        );
        run(&mut world, &mut character, 5);
        limb.despawn(&mut world);
        let mut w = Writer::new();
        world.save(&mut w);
        character.save(&mut w);
        let mut r = Reader::new(w.as_bytes());
        let mut other_world = World::new(world.def().clone());
        other_world.load(&mut r).expect("the snapshot is valid");
        let mut other = Character::new(def.clone(), Transform::IDENTITY, 0.0);
        other.load(&mut r).expect("the file is a character");
        for step in 0..200 {
            for (world, character) in [(&mut world, &mut character), (&mut other_world, &mut other)] {
                world.step();
                character.update(world);
            }
            assert_eq!(world.hash(), other_world.hash(), "{bone}, step {step}");
        }
        assert!(particles(&world, &character).iter().flatten().all(|at| at.is_finite()), "{bone}");
        assert_eq!(character.garments().len(), 2, "{bone}: it wears both");
        character.despawn(&mut world);
        assert_eq!((world.body_ids().count(), world.group_ids().count()), (1, 0), "{bone}");
    }
}
