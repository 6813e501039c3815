//! The state machine.

use crate::actor::{floor, shared, somewhere, walker};
use sinew_math::{Reader, Transform, Vec3, Writer};
use sinew_physics::{BodyDef, BodyKind, Shape, ShapeDef, World, WorldDef};
use sinew_ragdoll::{AfterSettling, Character, CharacterDef, Event, MotionSet, State};
use std::sync::Arc;

fn world() -> World {
    let mut world = World::new(WorldDef::default());
    world.add_body(&floor());
    world
}

/// Steps until `done`, at most `seconds`; all events with their times.
fn run_until(
    world: &mut World,
    character: &mut Character,
    seconds: f32,
    done: impl Fn(&Character) -> bool,
) -> Vec<(f32, Event)> {
    let mut events = Vec::new();
    let end = world.time() as f32 + seconds;
    while (world.time() as f32) < end && !done(character) {
        world.step();
        character.update(world);
        events.extend(character.events().iter().map(|&event| (world.time() as f32, event)));
    }
    events
}

/// Place of a joint in the world, metres.
fn place_of(character: &Character, name: &str) -> Vec3 {
    let def = character.def();
    let joint = def.rig.joints.iter().position(|joint| joint.name == name).expect("the joint is there");
    let mut model = Vec::new();
    sinew_anim::local_to_model(&def.rig, character.pose(), &character.world_from_model(), &mut model);
    model[joint].translation
}

fn knocked_over(def: &Arc<CharacterDef>, impulse: Vec3) -> (World, Character) {
    let mut world = world();
    let mut character = Character::new(def.clone(), somewhere(), 0.0);
    run_until(&mut world, &mut character, 0.5, |_| false);
    let chest = def.body_named("chest").expect("it has a chest");
    let work = character.hit(&mut world, chest, impulse);
    assert!(work > 0.0);
    (world, character)
}

#[test]
fn walks_at_its_speed() {
    let def = shared(walker());
    let mut world = world();
    let mut character = Character::new(def, somewhere(), 0.0);
    run_until(&mut world, &mut character, 2.0, |_| false);
    let way = character.world_from_character().translation - somewhere().translation;
    let expected = somewhere().rotation * Vec3::Z * sinew_scenes::mannequin::WALK_SPEED * world.time() as f32;
    assert!((way - expected).length() < 1e-3, "{way} for {expected}");
    assert_eq!(world.body_ids().count(), 1, "an animated character has no bodies");
}

#[test]
fn falls_lies_still_gets_up_and_walks_on() {
    let def = shared(walker());
    let (mut world, mut character) = knocked_over(&def, Vec3::new(60.0, 0.0, 30.0));
    assert_eq!(character.state(), State::Limp);
    assert_eq!(world.body_ids().count(), 1 + def.ragdoll.bodies.len());
    let events = run_until(&mut world, &mut character, 12.0, |c| c.state() == State::Animated);
    let needed = events.iter().filter(|(_, event)| !matches!(event, Event::Preparing { .. }));
    let kinds: Vec<_> = needed.map(|(_, event)| core::mem::discriminant(event)).collect();
    let expected =
        [Event::Touched, Event::Settled { since: 0.0 }, Event::GettingUp { clip: None }, Event::Up];
    assert_eq!(kinds, expected.map(|event| core::mem::discriminant(&event)), "{events:?}");
    assert_eq!(world.body_ids().count(), 1, "its bodies are gone");
    assert!(place_of(&character, "head").y > 1.3);
    // It takes a moment to get going: no one starts to walk at full speed.
    run_until(&mut world, &mut character, 0.35, |_| false);
    let before = character.world_from_character().translation;
    run_until(&mut world, &mut character, 1.0, |_| false);
    let way = (character.world_from_character().translation - before).length();
    assert!((way - sinew_scenes::mannequin::WALK_SPEED).abs() < 0.05, "{way} m in a second");
}

#[test]
fn picks_the_clip_by_the_side_it_lies_on() {
    let def = shared(walker());
    let mut clear = [0, 0];
    for impulse in [-90.0, 90.0, 40.0, -40.0] {
        let push = somewhere().rotation * Vec3::Z * impulse;
        let (mut world, mut character) = knocked_over(&def, push);
        run_until(&mut world, &mut character, 10.0, |c| c.state() == State::GettingUp);
        assert_eq!(character.state(), State::GettingUp);
        let Some(&Event::GettingUp { clip: Some(clip) }) =
            character.events().iter().find(|event| matches!(event, Event::GettingUp { .. }))
        else {
            panic!("it gets up by a clip: {:?}", character.events());
        };
        let name = &def.motions().clips[clip].name;
        let up = pelvis_forward(&character).y;
        // Between the two the limbs decide.
        if up.abs() > 0.3 {
            assert_eq!(name.contains("supine"), up > 0.0, "{name}, lying {up}");
            clear[usize::from(up > 0.0)] += 1;
        }
    }
    assert!(clear.iter().all(|&falls| falls > 0), "it falls on its back and on its face: {clear:?}");
}

/// The direction in which the pelvis looks.
fn pelvis_forward(character: &Character) -> Vec3 {
    let def = character.def();
    let mut model = Vec::new();
    sinew_anim::local_to_model(&def.rig, character.pose(), &sinew_math::Affine::IDENTITY, &mut model);
    let mut bodies = Vec::new();
    def.mapping().bodies_from_model(&model, character.world_from_character(), &mut bodies);
    bodies[0].rotation * (def.ragdoll.bodies[0].character_from_body.rotation.inverse() * Vec3::Z)
}

#[test]
fn no_joint_jumps_at_any_change_of_state() {
    let def = shared(walker());
    let (mut world, mut character) = knocked_over(&def, Vec3::new(-20.0, 0.0, 70.0));
    let joints = ["hips", "head", "leftHand", "rightFoot", "rightLowerLeg"];
    let places = |character: &Character| joints.map(|joint| place_of(character, joint));
    let mut last = places(&character);
    for _ in 0..600 {
        world.step();
        character.update(&mut world);
        let now = places(&character);
        for (joint, (a, b)) in joints.iter().zip(last.iter().zip(&now)) {
            let speed = (*b - *a).length() * 60.0;
            assert!(speed < 9.0, "{joint} moves at {speed} m/s, {:?}", character.events());
        }
        last = now;
    }
    assert_eq!(character.state(), State::Animated);
}

#[test]
fn stays_down_if_told_to() {
    let mut def = walker();
    def.after_settling = AfterSettling::StayDown;
    let def = shared(def);
    let (mut world, mut character) = knocked_over(&def, Vec3::Z * 60.0);
    run_until(&mut world, &mut character, 9.0, |_| false);
    assert_eq!(character.state(), State::Limp);
    assert!(place_of(&character, "head").y < 0.4);
}

#[test]
fn stands_up_without_a_clip() {
    let mut def = walker();
    let motions = MotionSet { get_ups: Vec::new(), ..def.motions().clone() };
    def.set_motions(motions).expect("they could be played before");
    let def = shared(def);
    let (mut world, mut character) = knocked_over(&def, Vec3::Z * 60.0);
    let events = run_until(&mut world, &mut character, 10.0, |c| c.state() == State::Animated);
    assert!(events.iter().any(|(_, event)| *event == Event::GettingUp { clip: None }), "{events:?}");
    assert!(place_of(&character, "head").y > 1.3);
}

#[test]
fn follows_stairs_down() {
    let def = shared(walker());
    let mut world = world();
    for step in 0..4 {
        let top = 0.17 * (4 - step) as f32;
        world.add_body(&BodyDef {
            kind: BodyKind::Static,
            position: Vec3::new(0.0, 0.5 * top, 0.3 * step as f32),
            shapes: vec![ShapeDef::new(Shape::Box { half_extents: Vec3::new(1.0, 0.5 * top, 0.15) })],
            ..BodyDef::default()
        });
    }
    let mut character = Character::new(def, Transform::from_translation(Vec3::Y * 0.68), 0.0);
    run_until(&mut world, &mut character, 3.0, |_| false);
    let place = character.world_from_character().translation;
    assert!(place.y.abs() < 1e-3 && place.z > 3.0, "{place}");
}

#[test]
fn a_restored_character_goes_on_as_the_original() {
    let def = shared(walker());
    for seconds in [0.3, 1.0, 3.4, 5.0] {
        let (mut world, mut character) = knocked_over(&def, Vec3::new(60.0, 0.0, 30.0));
        run_until(&mut world, &mut character, seconds, |_| false);
        let mut saved = Writer::new();
        world.save(&mut saved);
        character.save(&mut saved);
        let bytes = saved.into_bytes();
        run_until(&mut world, &mut character, 2.0, |_| false);

        let mut other_world = World::new(WorldDef::default());
        let mut other = Character::new(def.clone(), Transform::IDENTITY, 0.0);
        let mut reader = Reader::new(&bytes);
        other_world.load(&mut reader).expect("the world's snapshot is valid");
        other.load(&mut reader).expect("the character's snapshot is valid");
        run_until(&mut other_world, &mut other, 2.0, |_| false);
        assert_eq!(world.hash(), other_world.hash(), "after {seconds} s");
        assert_eq!(character.pose(), other.pose(), "after {seconds} s");
        assert_eq!(character.state(), other.state());

        for length in (0..bytes.len()).step_by(97) {
            let mut reader = Reader::new(&bytes[..length]);
            let whole = other_world.load(&mut reader).is_ok() && other.load(&mut reader).is_ok();
            assert!(!whole, "{length} of {} bytes", bytes.len());
        }
    }
}
