//! Reactions to hits: flinches, falls, and partial drives of a character.

use crate::actor::{shared, walker};
use crate::in_world::{level, run};
use sinew_math::{Transform, Vec3, max, min};
use sinew_physics::ray::Ray;
use sinew_physics::{BodyDef, Shape, World};
use sinew_ragdoll::{
    Blow, Character, CharacterDef, CharacterEvent, DriveMode, MotionSet, Muscle, Part, Preset, State,
    Toughness,
};
use std::sync::Arc;

fn walking(def: &Arc<CharacterDef>) -> (World, Character) {
    let mut world = level();
    let mut character = Character::spawn(&mut world, def, Transform::IDENTITY);
    run(&mut world, &mut character, 40);
    (world, character)
}

/// Returns the world positions of all joints that have bodies.
fn places(character: &Character) -> Vec<Vec3> {
    let def = character.def();
    let mut model = Vec::new();
    sinew_anim::local_to_model(&def.rig, character.pose(), &character.world_from_model(), &mut model);
    def.ragdoll.bodies.iter().map(|body| model[body.joint].translation).collect()
}

/// Returns the largest distance of a joint from its position in an undisturbed copy, metres.
fn apart(one: &Character, twin: &Character) -> f32 {
    let far = |(a, b): (&Vec3, &Vec3)| (*a - *b).length();
    places(one).iter().zip(&places(twin)).map(far).fold(0.0, max)
}

#[test]
fn hit_hand_yields_and_returns_smoothly() {
    let def = shared(walker());
    let hand = def.body_named("rightHand").expect("the character has hands");
    let (mut world, mut character) = walking(&def);
    let (mut twin_world, mut twin) = walking(&def);
    character.hit(&mut world, hand, Vec3::new(-6.0, 0.0, 0.0));
    assert_eq!(character.state(), State::Flinching);
    let (mut most, mut jump) = (0.0, 0.0);
    let mut last: Option<(Vec<Vec3>, Vec<Vec3>)> = None;
    let mut seen: [Vec<Vec3>; 3] = Default::default();
    for step in 0..90 {
        run(&mut world, &mut character, 1);
        run(&mut twin_world, &mut twin, 1);
        let off = apart(&character, &twin);
        most = max(most, off);
        if step >= 60 {
            assert!(off < 2e-3, "after {step} steps the pose is still {off} m off");
        }
        seen.rotate_left(1);
        seen[2] = places(&character).iter().zip(&places(&twin)).map(|(a, b)| *a - *b).collect();
        if let (true, Some(_)) = (step > 10, &last) {
            for ((a, b), c) in seen[0].iter().zip(&seen[1]).zip(&seen[2]) {
                jump = max(jump, (*a - *b * 2.0 + *c).length() * 3600.0);
            }
        }
        last = Some((places(&character), places(&twin)));
    }
    assert_eq!(character.state(), State::Animated);
    assert!(most > 0.05, "the hand moves only {most} m");
    assert!(jump < 60.0, "on the way back the acceleration exceeds the clip's by {jump} m/s²");
    let way = character.world_from_character().translation - twin.world_from_character().translation;
    assert!(way.length() < 1e-3, "the flinch interrupted the walk: {way}");
}

/// A character walks along a wall 10 cm from its hand, and the hand is hit toward the wall.
#[test]
fn arm_hit_into_a_wall_leaves_it_at_once() {
    let def = shared(walker());
    let hand = def.body_named("rightHand").expect("the character has hands");
    let (mut world, mut character) = walking(&def);
    let side = if places(&character)[hand].x > 0.0 { 1.0 } else { -1.0 };
    let beside = |character: &Character| places(character)[hand].x * side;
    let (mut free_world, mut free) = walking(&def);
    let mut face = beside(&free);
    for _ in 0..90 {
        run(&mut free_world, &mut free, 1);
        face = max(face, beside(&free));
    }
    face += 0.06;
    let half_extents = Vec3::new(0.2, 2.0, 5.0);
    let at = Vec3::new(side * (face + 0.2), 2.0, 0.0);
    world.add_body(&BodyDef::fixed(Shape::Box { half_extents }).at(at));
    let (mut ghost_world, mut ghost) = walking(&def);
    let blow = Vec3::X * (side * 6.0);
    ghost.hit(&mut ghost_world, hand, blow);
    character.hit(&mut world, hand, blow);
    let (mut inside, mut deepest, mut would) = (0, f32::NEG_INFINITY, 0.0);
    for _ in 0..90 {
        run(&mut world, &mut character, 1);
        run(&mut ghost_world, &mut ghost, 1);
        would = max(would, beside(&ghost) - face);
        deepest = max(deepest, beside(&character) - face);
        inside += u32::from(beside(&character) > face);
    }
    assert!(would > 0.05, "without a wall the hand must reach beyond it; distance {would} m");
    assert!(
        inside <= 6 && deepest < 0.02,
        "the hand is inside the wall for {inside} steps, up to {deepest} m"
    );
    assert_eq!(character.state(), State::Animated);
}

/// A code-driven character stops at a wall, with hands and feet on its own side. (Driven by its clips, it would walk on
/// the spot with its hands in the wall.)
#[test]
fn limbs_stay_out_of_a_wall_that_stops_the_walk() {
    let mut def = walker();
    let motions = def.motions().clone();
    def.set_motions(MotionSet { idle: Some(1), ..motions }).expect("the motions were accepted before");
    let def = shared(def);
    let mut world = level();
    let half_extents = Vec3::new(3.0, 2.0, 0.2);
    world.add_body(&BodyDef::fixed(Shape::Box { half_extents }).at(Vec3::new(0.0, 2.0, 2.2)));
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    character.set_move(Vec3::Z * 1.2);
    let mut deepest = 0.0;
    for _ in 0..300 {
        run(&mut world, &mut character, 1);
        deepest = places(&character).iter().map(|at| at.z - 2.0).fold(deepest, max);
    }
    assert!(deepest < 0.005, "the hand is {deepest} m inside the wall");
    assert!(character.world_from_character().translation.z > 1.65, "it reaches the wall");
}

/// A clip-driven character that a wall stops walks on the spot: its hands stay out of the wall as they swing forward, also
/// with a mover narrower than the swing of the limbs.
#[test]
fn hands_of_a_walker_that_a_wall_stops_stay_out_of_it() {
    let deepest = |wide: bool| {
        let mut def = walker();
        let radius = def.swept_radius();
        assert!((0.4..0.7).contains(&radius), "{radius} m");
        if wide {
            def.in_world.mover.as_mut().expect("the body exists").radius = radius;
        }
        let mut world = level();
        let half_extents = Vec3::new(3.0, 2.0, 0.2);
        world.add_body(&BodyDef::fixed(Shape::Box { half_extents }).at(Vec3::new(0.0, 2.0, 2.2)));
        let mut character = Character::spawn(&mut world, &shared(def), Transform::IDENTITY);
        let mut deepest = f32::NEG_INFINITY;
        for _ in 0..300 {
            run(&mut world, &mut character, 1);
            deepest = places(&character).iter().map(|at| at.z - 2.0).fold(deepest, max);
        }
        deepest
    };
    let (narrow, wide) = (deepest(false), deepest(true));
    assert!(narrow < 0.0 && wide < 0.0, "depth in the wall: {narrow} m and {wide} m");
}

#[test]
fn impulse_thresholds_decide_between_flinch_and_fall() {
    let fells = |toughness: Toughness, size: f32| {
        let mut def = walker();
        def.in_world.toughness = toughness;
        let def = shared(def);
        let (mut world, mut character) = walking(&def);
        let chest = def.body_named("chest").expect("the character has a chest");
        character.hit(&mut world, chest, Vec3::X * size);
        character.state() == State::Limp
    };
    assert!(fells(Toughness::None, 0.5));
    assert!(!fells(Toughness::Impulse(20.0), 19.0) && fells(Toughness::Impulse(20.0), 21.0));
    fn heads_only(def: &CharacterDef, blow: &Blow) -> bool {
        def.body_named("head") == Some(blow.body)
    }
    assert!(!fells(Toughness::Function(heads_only), 500.0));
}

#[test]
fn hit_by_a_ray_flinches_the_limb_and_a_second_hit_fells() {
    let def = shared(walker());
    let (mut world, mut character) = walking(&def);
    let at = places(&character)[def.body_named("head").expect("the character has a head")] + Vec3::Y * 0.1;
    let shot = Ray { origin: at + Vec3::Z * 3.0, direction: Vec3::Z * -6.0 };
    let hit = world.query().first(&shot).expect("the shot hits the head");
    assert_eq!(character.body_index(hit.body), def.body_named("head"));
    assert!(character.hit_at(&mut world, &hit, Vec3::Z * -8.0).is_some());
    assert_eq!(character.state(), State::Flinching);
    let events = run(&mut world, &mut character, 8);
    let head = hit.body;
    let flinched = CharacterEvent::Flinched { body: character.body_index(head).expect("it is its own") };
    assert_eq!(events, [flinched], "expected exactly one event");
    let floor = world.body_ids().next().expect("the floor");
    let other = sinew_physics::BodyHit { body: floor, ..hit };
    assert!(character.hit_at(&mut world, &other, Vec3::Z).is_none(), "not of this character");
    character.hit(&mut world, 0, Vec3::Z * -120.0);
    assert_eq!(character.state(), State::Limp);
    let events = run(&mut world, &mut character, 60 * 12);
    assert!(events.contains(&CharacterEvent::Up), "{events:?}");
    assert_eq!(world.joint_ids().count(), 0, "no pin is left");
}

#[test]
fn active_ragdoll_tracks_its_clips_and_withstands_a_push() {
    let def = shared(walker());
    let (mut world, mut character) = walking(&def);
    character.set_preset(&mut world, Preset::Powered);
    run(&mut world, &mut character, 120);
    assert_eq!(character.state(), State::Powered);
    let (_, twin) = {
        let (mut world, mut twin) = walking(&def);
        run(&mut world, &mut twin, 120);
        (world, twin)
    };
    let off = apart(&character, &twin);
    assert!(off < 0.15, "the powered pose is {off} m from its clips");
    character.hit(&mut world, 2, Vec3::X * 25.0);
    let events = run(&mut world, &mut character, 120);
    assert_eq!(character.state(), State::Powered, "{events:?}");
    character.set_preset(&mut world, Preset::Animated);
    run(&mut world, &mut character, 90);
    assert_eq!(character.state(), State::Animated);
    character.set_preset(&mut world, Preset::Limp);
    assert_eq!(character.state(), State::Limp);
}

#[test]
fn one_part_can_have_another_drive() {
    let def = shared(walker());
    let (mut world, mut character) = walking(&def);
    let (mut twin_world, mut twin) = walking(&def);
    character.set_drive(&mut world, Part::From("leftUpperArm"), DriveMode::Powered(Muscle::RELAXED), 0.1);
    run(&mut world, &mut character, 60);
    run(&mut twin_world, &mut twin, 60);
    let (with, without) = (places(&character), places(&twin));
    let off = |role: &str| {
        let body = def.body_named(role).expect("the body exists");
        (with[body] - without[body]).length()
    };
    assert!(off("rightHand") < 2e-3 && off("head") < 2e-3 && off("leftFoot") < 2e-3);
    assert!(off("leftHand") > 0.01, "a relaxed arm must follow late; distance {} m", off("leftHand"));
    assert_eq!(character.drives_mut().mode(0), DriveMode::Keyed);
}

#[test]
#[should_panic(expected = "no body is called 'tail'")]
fn unknown_part_is_named_in_the_panic() {
    let def = shared(walker());
    let (mut world, mut character) = walking(&def);
    character.set_drive(&mut world, Part::Named("tail"), DriveMode::Limp, 0.0);
}

#[test]
fn skin_matrices_map_the_bind_pose_to_the_current_pose() {
    let def = shared(walker());
    let (mut world, mut character) = walking(&def);
    run(&mut world, &mut character, 7);
    let (mut pose, mut palettes) = (Vec::new(), [0.0, 0.5, 1.0].map(|_| Vec::new()));
    for (palette, alpha) in palettes.iter_mut().zip([0.0, 0.5, 1.0]) {
        character.skin_palette(0, alpha, palette);
    }
    assert_eq!(character.interpolated(1.0, &mut pose), character.world_from_character());
    assert_eq!(palettes[0].len(), def.rig.skins[0].joints.len());
    // The joint's position in the bind pose is mapped to its current position. The matrix is stored by rows,
    // translation last.
    let mut model = Vec::new();
    sinew_anim::local_to_model(&def.rig, character.pose(), &character.world_from_model(), &mut model);
    let skin = &def.rig.skins[0];
    for ((matrix, &joint), bind) in palettes[2].iter().zip(&skin.joints).zip(&skin.inverse_bind) {
        let p = bind.inverse().translation;
        let row = |i: usize| {
            matrix[4 * i] * p.x + matrix[4 * i + 1] * p.y + matrix[4 * i + 2] * p.z + matrix[4 * i + 3]
        };
        let at = Vec3::new(row(0), row(1), row(2));
        assert!((at - model[joint].translation).length() < 1e-4, "{at}");
    }
    let z = palettes.each_ref().map(|palette| palette[0][11]);
    assert!((z[1] - 0.5 * (z[0] + z[2])).abs() < 1e-3 && z[2] > z[0] + 0.01, "{z:?}");
}

#[test]
fn flinch_preset_moves_the_body_and_returns() {
    let mut def = walker();
    def.in_world.toughness = Toughness::None;
    let def = shared(def);
    let (mut world, mut character) = walking(&def);
    let (mut twin_world, mut twin) = walking(&def);
    character.set_preset(&mut world, Preset::Flinching);
    assert_eq!(character.state(), State::Flinching);
    let mut most = 0.0;
    for _ in 0..60 {
        run(&mut world, &mut character, 1);
        run(&mut twin_world, &mut twin, 1);
        most = max(most, apart(&character, &twin));
    }
    assert_eq!(character.state(), State::Animated);
    assert!(most > 0.01 && apart(&character, &twin) < 2e-3, "{most} m, then {}", apart(&character, &twin));
}

/// Returns the largest speed of a body, m/s.
fn fastest(world: &World, character: &Character) -> f32 {
    character.bodies().iter().map(|&body| world.velocity(body).linear.length()).fold(0.0, max)
}

/// Hits a flinching character so that it falls, then runs until `state`. Returns the largest body speed since the
/// character came to rest.
fn until(world: &mut World, character: &mut Character, state: State) -> f32 {
    let mut most = 0.0;
    for step in 0..900 {
        run(world, character, 1);
        if step > 150 || character.state() != State::Limp {
            most = max(most, fastest(world, character));
        }
        if character.state() == state {
            return most;
        }
    }
    panic!("the character never entered {state:?}");
}

#[test]
fn fallen_flinching_character_is_rolled_over_slowly() {
    let def = shared(walker());
    let chest = def.body_named("chest").expect("the character has a chest");
    let (mut world, mut character) = walking(&def);
    character.hit(&mut world, chest, Vec3::X * 10.0);
    run(&mut world, &mut character, 10);
    assert_eq!(character.state(), State::Flinching);
    character.hit(&mut world, chest, Vec3::new(90.0, 0.0, 30.0));
    let most = until(&mut world, &mut character, State::GettingUp);
    assert!(most < 9.0, "a body moves at {most} m/s toward the start of the clip");
}

#[test]
fn hit_threshold_is_higher_while_getting_up_near_the_ground() {
    let def = shared(walker());
    let chest = def.body_named("chest").expect("the character has a chest");
    let (mut world, mut character) = walking(&def);
    character.hit(&mut world, chest, Vec3::new(70.0, 0.0, 20.0));
    until(&mut world, &mut character, State::GettingUp);
    character.hit(&mut world, chest, Vec3::X * 60.0);
    run(&mut world, &mut character, 1);
    assert_eq!(
        character.state(),
        State::GettingUp,
        "60 N·s make a standing character fall, but not a lying one"
    );
    character.hit(&mut world, chest, Vec3::X * 200.0);
    assert_eq!(character.state(), State::Limp);
    until(&mut world, &mut character, State::Animated);
    character.hit(&mut world, chest, Vec3::X * 60.0);
    assert_eq!(character.state(), State::Limp);
}

#[test]
fn character_turns_to_its_heading_while_getting_up() {
    let def = shared(walker());
    let chest = def.body_named("chest").expect("the character has a chest");
    let mut speeds = [0.0; 2];
    for (faces, speed) in [false, true].into_iter().zip(&mut speeds) {
        let (mut world, mut character) = walking(&def);
        character.hit(&mut world, chest, Vec3::new(70.0, 0.0, 20.0));
        until(&mut world, &mut character, State::GettingUp);
        let heading = character.world_from_character().rotation * Vec3::Z;
        if faces {
            character.face(-heading);
        }
        for _ in 0..20 {
            run(&mut world, &mut character, 1);
            *speed = max(*speed, fastest(&world, &character));
        }
        until(&mut world, &mut character, State::Animated);
        run(&mut world, &mut character, 60);
        let turned = (character.world_from_character().rotation * Vec3::Z).dot(heading);
        assert!(!faces || turned < -0.9, "the character must face the requested direction: {turned}");
    }
    let [free, facing] = speeds;
    assert!(facing < 1.2 * free + 0.5, "fastest joint: {facing} m/s while turning, {free} m/s without");
}

/// In the past, hit bodies waited for one step when the clips took them back, and moved by two steps' distance in the
/// next.
#[test]
fn hit_bodies_go_on_at_the_end_of_a_flinch() {
    let def = shared(walker());
    let hand = def.body_named("rightHand").expect("the character has a hand");
    let (mut world, mut character) = walking(&def);
    let mut fastest_led = 0.0;
    for _ in 0..60 {
        run(&mut world, &mut character, 1);
        let speed = world.velocity(character.bodies()[hand]).linear.length();
        fastest_led = max(fastest_led, speed);
    }
    for round in 0..12 {
        character.hit(&mut world, hand, Vec3::new(0.0, 0.0, 4.0));
        run(&mut world, &mut character, 30 + round);
        while character.state() == State::Flinching {
            run(&mut world, &mut character, 1);
        }
        let mut slowest = f32::INFINITY;
        for _ in 0..3 {
            let speed = world.velocity(character.bodies()[hand]).linear.length();
            slowest = min(slowest, speed);
            assert!(
                speed < 1.5 * fastest_led + 0.5,
                "a hand moves at {speed} m/s; led, at most at {fastest_led} m/s"
            );
            run(&mut world, &mut character, 1);
        }
        assert!(slowest > 0.0, "the hand must not stop for a step");
    }
}
