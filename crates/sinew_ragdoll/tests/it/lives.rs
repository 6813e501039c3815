//! Events, held objects, sizes and levels of detail of characters.

use crate::actor::{floor, shared, walker};
use crate::in_world::{level, run};
use sinew_math::{Reader, Transform, Vec3, Writer, max};
use sinew_physics::{BodyDef, BodyId, Shape, World, WorldDef};
use sinew_ragdoll::{
    Character, CharacterDef, CharacterEvent, Detail, Distances, Grip, HitBodies, MotionSet, Preset, State,
};
use sinew_scenes::mannequin::WALK_SPEED;
use std::sync::Arc;

/// Returns a standing character whose walk has footstep events.
fn walker_with_footsteps() -> CharacterDef {
    let mut def = walker();
    let motions = def.motions().clone();
    let half = 0.5 * motions.clips[0].duration;
    let events =
        [("left", 0.0), ("right", half)].map(|(foot, time)| (0, sinew_anim::ClipEvent::new(time, foot)));
    let motions = MotionSet { idle: Some(1), events: events.to_vec(), ..motions };
    def.set_motions(motions).expect("the motions were accepted before");
    def
}

fn joints(character: &Character) -> Vec<Vec3> {
    let def = character.def();
    let mut model = Vec::new();
    sinew_anim::local_to_model(&def.rig, character.pose(), &character.world_from_model(), &mut model);
    model.iter().map(|joint| joint.translation).collect()
}

#[test]
fn each_footstep_is_reported_once() {
    let def = shared(walker_with_footsteps());
    let mut world = level();
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    let events = run(&mut world, &mut character, 600);
    let steps: Vec<&str> = events
        .iter()
        .filter_map(|event| match event {
            CharacterEvent::Clip(fired) => Some(def.set().event(fired).name.as_str()),
            _ => None,
        })
        .collect();
    let expected = 2.0 * 10.0 / def.motions().clips[0].duration;
    assert!((steps.len() as f32 - expected).abs() <= 1.0, "{} steps, expected {expected}", steps.len());
    assert!(
        steps.windows(2).all(|pair| pair[0] != pair[1]),
        "steps must alternate between left and right: {steps:?}"
    );
    // A lying character takes no steps.
    character.hit(&mut world, 0, Vec3::X * 90.0);
    let events = run(&mut world, &mut character, 60);
    assert!(!events.iter().any(|event| matches!(event, CharacterEvent::Clip(_))), "{events:?}");
}

#[test]
fn events_of_a_call_are_reported_once_by_the_next_update() {
    let def = shared(walker_with_footsteps());
    let mut world = level();
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    run(&mut world, &mut character, 20);
    character.hit(&mut world, 5, Vec3::X * 5.0);
    let mut events = run(&mut world, &mut character, 90);
    events.extend(run(&mut world, &mut character, 10));
    let count = |wanted: CharacterEvent| events.iter().filter(|event| **event == wanted).count();
    assert_eq!(
        (count(CharacterEvent::Flinched { body: 5 }), count(CharacterEvent::Recovered)),
        (1, 1),
        "{events:?}"
    );
    character.set_preset(&mut world, Preset::Powered);
    character.set_preset(&mut world, Preset::Limp);
    let events = run(&mut world, &mut character, 2);
    assert_eq!(events.iter().filter(|event| **event == CharacterEvent::Powered).count(), 1, "{events:?}");
    assert_eq!(events.iter().filter(|event| **event == CharacterEvent::WentLimp).count(), 1, "{events:?}");
}

#[test]
fn contacts_are_reported_by_bone_on_request() {
    let mut def = walker_with_footsteps();
    def.in_world.tells_contacts = true;
    let def = shared(def);
    let head = def.body_named("head").expect("the character has a head");
    let mut world = level();
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    character.set_move(Vec3::ZERO);
    run(&mut world, &mut character, 10);
    let above = world.center_of_mass(character.bodies()[head]) + Vec3::new(0.0, 0.5, 0.0);
    let ball = world.add_body(&BodyDef::dynamic(Shape::Sphere { radius: 0.05 }).at(above));
    let events = run(&mut world, &mut character, 90);
    let contact_count = |begins: bool| {
        let wanted = CharacterEvent::Contact { body: head, other: ball, begins };
        events.iter().filter(|event| **event == wanted).count()
    };
    assert!(contact_count(true) >= 1 && contact_count(true) - contact_count(false) <= 1, "{events:?}");
}

/// Returns the largest distance, over some steps, of the held body from its pose at the bone, metres.
fn apart(
    world: &mut World,
    character: &mut Character,
    bone: usize,
    held: BodyId,
    at: Vec3,
    steps: usize,
) -> f32 {
    let mut far = 0.0;
    for _ in 0..steps {
        run(world, character, 1);
        let wanted = world.transform(character.bodies()[bone]).point(at);
        far = max(far, (world.transform(held).translation - wanted).length());
    }
    far
}

#[test]
fn held_sword_stays_in_the_hand_until_released() {
    let def = shared(walker_with_footsteps());
    let hand = def.body_named("rightHand").expect("the character has hands");
    let mut world = level();
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    let blade = Shape::Box { half_extents: Vec3::new(0.02, 0.02, 0.3) };
    let sword = world.add_body(&BodyDef::dynamic(blade).at(Vec3::Y * 3.0));
    let at = Vec3::Z * 0.25;
    let grip = Grip { bone_from_held: Transform::from_translation(at), ..Grip::default() };
    character.hold(&mut world, "rightHand", sword, &grip);
    assert!(apart(&mut world, &mut character, hand, sword, at, 120) < 2e-3, "walking");
    let walked = character.world_from_character().translation;
    assert!(
        (walked.z - 2.0 * WALK_SPEED).abs() < 0.1,
        "the sword must not block its bearer; walked {walked}"
    );
    character.hit(&mut world, hand, Vec3::X * 4.0);
    assert_eq!(character.state(), State::Flinching);
    assert!(apart(&mut world, &mut character, hand, sword, at, 60) < 2e-3, "flinching");
    character.set_preset(&mut world, Preset::Powered);
    assert!(apart(&mut world, &mut character, hand, sword, at, 60) < 2e-3, "powered");
    character.go_limp(&mut world);
    assert!(apart(&mut world, &mut character, hand, sword, at, 120) < 2e-3, "limp");
    let far = apart(&mut world, &mut character, hand, sword, at, 600);
    assert_eq!(character.state(), State::Animated);
    assert!(far < 5e-3, "getting up: {far} m");
    let mut w = Writer::new();
    world.save(&mut w);
    character.save(&mut w);
    let bytes = w.into_bytes();
    assert!(character.release(&mut world, sword) && !character.release(&mut world, sword));
    run(&mut world, &mut character, 120);
    assert!(world.transform(sword).translation.y < 0.1, "it lies on the floor");
    let (mut other_world, mut r) = (World::new(WorldDef::default()), Reader::new(&bytes));
    let mut other = Character::new(def, Transform::IDENTITY, 0.0);
    other_world.load(&mut r).expect("the snapshot is valid");
    other.load(&mut r).expect("the snapshot is valid");
    assert_eq!(other.held().collect::<Vec<_>>(), [sword]);
}

#[test]
fn lost_or_dropped_sword_is_reported() {
    let def = shared(walker_with_footsteps());
    let mut world = level();
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    let blade = Shape::Box { half_extents: Vec3::new(0.02, 0.02, 0.3) };
    let sword = world.add_body(&BodyDef::dynamic(blade).at(Vec3::Y * 3.0));
    let strength = sinew_physics::Strength { force: 2000.0, torque: 500.0 };
    character.hold(&mut world, "rightHand", sword, &Grip { strength, ..Grip::default() });
    assert!(
        run(&mut world, &mut character, 30)
            .iter()
            .all(|event| !matches!(event, CharacterEvent::LetGo { .. }))
    );
    world.apply_impulse_at_center(sword, Vec3::X * 100.0);
    let events = run(&mut world, &mut character, 5);
    let lost = |events: &[CharacterEvent]| {
        events.iter().filter(|event| matches!(event, CharacterEvent::LetGo { .. })).count()
    };
    assert_eq!(lost(&events), 1, "{events:?}");
    run(&mut world, &mut character, 60);
    character.hold(&mut world, "leftHand", sword, &Grip { drops: true, ..Grip::default() });
    run(&mut world, &mut character, 10);
    character.go_limp(&mut world);
    assert_eq!(lost(&run(&mut world, &mut character, 2)), 1);
    character.despawn(&mut world);
    assert_eq!(world.body_ids().count(), 2, "only the floor and the sword must remain");
    assert_eq!(world.joint_ids().count(), 0);
}

#[test]
fn scaled_characters_walk_fall_and_get_up() {
    let def = walker_with_footsteps();
    for factor in [0.6, 1.0, 1.5] {
        let sized = def.scaled(factor);
        assert!((sized.ragdoll.height - factor * def.ragdoll.height).abs() < 1e-4);
        assert!(
            (sized.ragdoll.total_mass / def.ragdoll.total_mass / (factor * factor * factor) - 1.0).abs()
                < 1e-4
        );
        let sized = shared(sized);
        let mut world = level();
        let mut character = Character::spawn(&mut world, &sized, Transform::IDENTITY);
        let head =
            sized.rig.joints.iter().position(|joint| joint.name == "head").expect("the character has a head");
        let high = joints(&character)[head].y;
        assert!((1.3..1.7).contains(&(high / factor)), "the head is at {high} m, scale {factor}");
        run(&mut world, &mut character, 120);
        let way = character.world_from_character().translation.z;
        assert!((way - 2.0 * factor * WALK_SPEED).abs() < 0.1, "{way} m, {factor}");
        let pelvis = world.transform(character.bodies()[0]).translation.y;
        assert!((0.4..0.65).contains(&(pelvis / (factor * def.ragdoll.height))), "{pelvis} m, {factor}");
        character.go_limp(&mut world);
        let events = run(&mut world, &mut character, 60 * 12);
        assert!(events.contains(&CharacterEvent::Up), "{factor}: {events:?}");
    }
}

#[test]
fn level_of_detail_changes_without_a_pop() {
    let def = shared(walker_with_footsteps());
    let (mut world, mut twins) = (level(), level());
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    let mut twin = Character::spawn(&mut twins, &def, Transform::IDENTITY);
    let order =
        [Detail::HitBodies, Detail::Keyed, Detail::Full, Detail::Keyed, Detail::HitBodies, Detail::Full];
    for detail in order {
        character.set_level_of_detail(&mut world, detail);
        assert_eq!(character.level_of_detail(), detail);
        assert_eq!(character.bodies().is_empty(), detail == Detail::Keyed, "{detail:?}");
        run(&mut world, &mut character, 17);
        run(&mut twins, &mut twin, 17);
        assert_eq!(character.pose(), twin.pose(), "{detail:?}");
        let (place, other) = (character.world_from_character(), twin.world_from_character());
        assert!(
            (place.translation - other.translation).length() < 1e-5,
            "{detail:?}: pose {place:?}, expected {other:?}"
        );
    }
}

#[test]
fn lower_detail_waits_until_the_character_is_up() {
    let def = shared(walker_with_footsteps());
    let mut world = level();
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    run(&mut world, &mut character, 20);
    character.go_limp(&mut world);
    character.set_level_of_detail(&mut world, Detail::Keyed);
    run(&mut world, &mut character, 60);
    assert_eq!((character.state(), character.bodies().is_empty()), (State::Limp, false));
    let events = run(&mut world, &mut character, 600);
    assert!(events.contains(&CharacterEvent::Up) && character.bodies().is_empty());
    // A light hit has no effect; a hard one still makes the character fall.
    character.hit(&mut world, 2, Vec3::X * 5.0);
    assert_eq!(character.state(), State::Animated);
    character.hit(&mut world, 2, Vec3::X * 90.0);
    assert_eq!(character.state(), State::Limp);
    let events = run(&mut world, &mut character, 600);
    assert!(events.contains(&CharacterEvent::Up) && character.bodies().is_empty());
    character.despawn(&mut world);
    assert_eq!(world.body_ids().count(), 1);
}

#[test]
fn distant_character_freezes_and_resumes_its_pose() {
    let distances = Distances::default();
    let mut world = World::new(WorldDef::default());
    world.add_body(&floor());
    let def = shared(walker_with_footsteps());
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    run(&mut world, &mut character, 30);
    let look = |world: &mut World, character: &mut Character, distance: f32| {
        let detail = distances.detail(distance, character.level_of_detail());
        character.set_level_of_detail(world, detail);
        detail
    };
    assert_eq!(look(&mut world, &mut character, 200.0), Detail::Frozen);
    assert_eq!((world.mover_ids().count(), world.body_ids().count()), (0, 1), "movers or bodies remain");
    let (place, pose) = (character.world_from_character(), character.pose().to_vec());
    run(&mut world, &mut character, 100);
    assert_eq!((character.world_from_character(), character.pose()), (place, &pose[..]));
    assert_eq!(look(&mut world, &mut character, 125.0), Detail::Frozen);
    assert_eq!(look(&mut world, &mut character, 119.0), Detail::Keyed);
    assert_eq!(
        look(&mut world, &mut character, 125.0),
        Detail::Keyed,
        "the level of detail must not oscillate"
    );
    assert_eq!(look(&mut world, &mut character, 10.0), Detail::Full);
    assert_eq!(look(&mut world, &mut character, f32::NAN), Detail::Frozen);
    assert_eq!(look(&mut world, &mut character, 10.0), Detail::Full);
    let before = joints(&character);
    run(&mut world, &mut character, 1);
    let step = joints(&character).iter().zip(&before).map(|(a, b)| (*a - *b).length()).fold(0.0, max);
    assert!(step < 0.12, "the pose must resume smoothly: a joint moves by {step} m");
    run(&mut world, &mut character, 119);
    let way = character.world_from_character().translation.z - place.translation.z;
    assert!((way - 2.0 * WALK_SPEED).abs() < 0.1, "{way} m");
}

#[test]
fn no_level_of_detail_adds_disabled_hit_bodies() {
    let mut def = walker_with_footsteps();
    def.in_world.hit_bodies = HitBodies::Absent;
    let mut world = level();
    let mut character = Character::spawn(&mut world, &shared(def), Transform::IDENTITY);
    character.set_level_of_detail(&mut world, Detail::Keyed);
    character.set_level_of_detail(&mut world, Detail::Full);
    assert!(character.bodies().is_empty() && character.mover().is_some());
}

/// Returns the largest displacement over the floor of the ball of a foot while its shoe is flat in the clip, metres.
fn slide(def: &Arc<CharacterDef>, velocity: Vec3) -> f32 {
    // Phases of a cycle between which the left shoe is flat on the floor.
    const FLAT: [f32; 2] = [0.10, 0.31];
    let mut world = level();
    let mut character = Character::spawn(&mut world, def, Transform::IDENTITY);
    character.set_move(velocity);
    character.face(velocity);
    run(&mut world, &mut character, 150);
    let clip = def.clip(0);
    let duration = def.set().clip(clip).clip.duration();
    let balls = ["leftToes", "rightToes"]
        .map(|name| def.rig.joints.iter().position(|joint| joint.name == name).expect("it has toes"));
    let (mut from, mut most) = ([None::<Vec3>; 2], 0.0);
    for _ in 0..240 {
        run(&mut world, &mut character, 1);
        let mut tracks = character.animator().tracks();
        let walk = tracks.find(|track| track.def().clip == clip).expect("the character walks");
        let phase = walk.playhead().clip_time() / duration;
        let places = joints(&character);
        for foot in 0..2 {
            let own = (phase + 0.5 * foot as f32) % 1.0;
            let place = places[balls[foot]];
            from[foot] = match (own > FLAT[0] && own < FLAT[1], from[foot]) {
                (true, Some(from)) => {
                    let way = place - from;
                    most = max(most, Vec3::new(way.x, 0.0, way.z).length());
                    Some(from)
                }
                (true, None) => Some(place),
                (false, _) => None,
            };
        }
    }
    most
}

#[test]
fn code_driven_feet_do_not_slide() {
    let def = shared(walker_with_footsteps());
    for (speed, way) in
        [(0.6, Vec3::Z), (0.9, Vec3::X), (WALK_SPEED, Vec3::Z), (1.5, -Vec3::X), (2.0, Vec3::Z)]
    {
        let far = slide(&def, way * speed);
        assert!(far < 0.02, "at {speed} m/s a shoe slides by {far} m");
    }
}
