//! Characters held by a joint, a hook, a hand or arms, carried, driven around, or dying.

use crate::actor::{shared, walker};
use crate::in_world::{level, run};
use sinew_math::{Reader, Rotation, Transform, Vec3, Writer, max};
use sinew_physics::{BodyDef, BodyId, BodyKind, JointDef, JointId, JointKind, Shape, Velocity, World};
use sinew_ragdoll::{AfterSettling, Character, CharacterDef, CharacterEvent, Grab, Preset, State};

/// Upper bound on the speed of a limb, m/s.
const MOST_SPEED: f32 = 15.0;
/// Upper bound on the gap of a joint, metres.
const MOST_GAP: f32 = 0.05;

fn body(def: &CharacterDef, name: &str) -> usize {
    def.body_named(name).expect("the ragdoll has this body")
}

/// Returns a kinematic ball without contacts at a body, and the joint between the two.
fn hook(world: &mut World, held: BodyId) -> (BodyId, JointId) {
    let at = world.center_of_mass(held);
    let hook = BodyDef { kind: BodyKind::Kinematic, ..BodyDef::default() }.at(at);
    let hook = world.add_body(&hook);
    let on_held = Transform::from_translation(world.transform(held).inverse_point(at));
    let joint = JointDef::between(hook, held, Transform::IDENTITY, on_held, JointKind::Ball { limit: None });
    (hook, world.add_joint(&joint))
}

/// Largest observed limb speed and joint gap.
#[derive(Debug, Default)]
struct Seen {
    speed: f32,
    gap: f32,
}

impl Seen {
    fn look(&mut self, world: &World, character: &Character) {
        let dynamic = character.bodies().iter().filter(|&&body| world.kind(body) == BodyKind::Dynamic);
        self.speed = dynamic.map(|&body| world.velocity(body).linear.length()).fold(self.speed, max);
        for joint in world.joint_ids() {
            let gap = world.joint_gap(joint);
            self.gap = max(self.gap, gap);
        }
    }

    fn expect(&self, what: &str) {
        self.expect_within(what, MOST_GAP);
    }

    fn expect_within(&self, what: &str, most_gap: f32) {
        println!("{what}: {self:?}");
        assert!(self.speed <= MOST_SPEED, "{what}: a limb moves at {} m/s", self.speed);
        assert!(self.gap <= most_gap, "{what}: a joint gap is {} m", self.gap);
    }
}

/// Saves and loads world and character, as for a rollback.
fn reload(world: &mut World, character: &mut Character) {
    let mut w = Writer::new();
    world.save(&mut w);
    character.save(&mut w);
    let mut r = Reader::new(w.as_bytes());
    world.load(&mut r).expect("the snapshot is valid");
    let mut other = Character::new(character.def().clone(), Transform::IDENTITY, 0.0);
    other.load(&mut r).expect("the snapshot is valid");
    *character = other;
}

#[test]
fn hook_drags_a_limp_character_until_released() {
    let def = shared(walker());
    for speed in [1.0, 2.0, 3.0] {
        for limb in ["rightHand", "leftFoot", "chest"] {
            let mut world = level();
            let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
            character.go_limp(&mut world);
            run(&mut world, &mut character, 90);
            let (hook, joint) = hook(&mut world, character.bodies()[body(&def, limb)]);
            let mut seen = Seen::default();
            for step in 0..600 {
                // The hook accelerates within half a second, and pauses now and then.
                let pace = if step % 200 < 30 { (step % 200) as f32 / 30.0 } else { 1.0 };
                let rests = step % 200 >= 120;
                let linear = Vec3::X * if rests { 0.0 } else { speed * pace };
                world.set_velocity(hook, Velocity { linear, angular: Vec3::ZERO });
                world.step();
                character.update(&mut world);
                seen.look(&world, &character);
                assert_eq!(character.state(), State::Limp, "{limb} at {speed} m/s");
            }
            seen.expect(&format!("{limb} at {speed} m/s"));
            world.remove_joint(joint);
            let events = run(&mut world, &mut character, 900);
            assert_eq!(
                character.state(),
                State::Animated,
                "{limb}: a released character must get up: {events:?}"
            );
        }
    }
}

#[test]
fn hook_moves_or_fells_a_standing_character() {
    let def = shared(walker());
    for (speed, stays_up) in [(0.5, true), (1.0, true), (1.5, true), (4.0, false)] {
        let limbs = if stays_up { &["rightHand", "leftLowerArm"][..] } else { &["rightHand"] };
        for &limb in limbs {
            let mut world = level();
            let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
            character.set_move(Vec3::ZERO);
            run(&mut world, &mut character, 30);
            // A limb must yield before it can be held.
            character.hit(&mut world, body(&def, limb), Vec3::ZERO);
            let (hook, joint) = hook(&mut world, character.bodies()[body(&def, limb)]);
            let mut seen = Seen::default();
            for step in 0..300 {
                let linear = Vec3::Z * (speed * (step as f32 / 30.0).min(1.0));
                world.set_velocity(hook, Velocity { linear, angular: Vec3::ZERO });
                world.step();
                character.update(&mut world);
                seen.look(&world, &character);
                if step == 137 {
                    reload(&mut world, &mut character);
                }
            }
            let way = world.center_of_mass(character.bodies()[0]).z;
            let what = format!("{limb} at {speed} m/s: {:?}, {way} m", character.state());
            // A hook of this speed opens its own joint for three steps until the character falls.
            seen.expect_within(&what, if stays_up { MOST_GAP } else { 2.0 * MOST_GAP });
            let state = if stays_up { State::Flinching } else { State::Limp };
            assert_eq!(character.state(), state, "{what}");
            assert!((way - speed * 4.75).abs() < 1.2, "{what}");
            world.remove_joint(joint);
            let events = run(&mut world, &mut character, 900);
            assert_eq!(character.state(), State::Animated, "{what}: further events {events:?}");
        }
    }
}

#[test]
fn walker_leads_another_character_by_the_wrist() {
    let def = shared(walker());
    let mut world = level();
    let mut led = Character::spawn(&mut world, &def, Transform::IDENTITY);
    let mut hero = Character::spawn(&mut world, &def, Transform::from_translation(Vec3::new(-0.5, 0.0, 0.5)));
    [&mut hero, &mut led].into_iter().for_each(|character| character.set_move(Vec3::ZERO));
    let step = |world: &mut World, all: [&mut Character; 2]| {
        world.step();
        all.into_iter().for_each(|character| character.update(world));
    };
    (0..30).for_each(|_| step(&mut world, [&mut hero, &mut led]));
    led.hit(&mut world, body(&def, "rightLowerArm"), Vec3::ZERO);
    let wrist = led.bodies()[body(&def, "rightLowerArm")];
    let grab = Grab { reach: 1.0, ..Grab::HAND };
    let hand = ["leftHand", "rightHand"].into_iter().min_by(|a, b| {
        let away = |name: &str| {
            (world.center_of_mass(hero.bodies()[body(&def, name)]) - world.center_of_mass(wrist)).length()
        };
        away(a).total_cmp(&away(b))
    });
    let grip = hero.grab(&mut world, hand.expect("two hands"), wrist, &grab).expect("the point is in reach");
    let mut seen = Seen::default();
    let mut force = 0.0;
    for frame in 0..420 {
        if frame == 60 {
            hero.set_move(Vec3::Z * 1.0);
        }
        step(&mut world, [&mut hero, &mut led]);
        seen.look(&world, &led);
        force = max(force, world.reaction(grip).force.length());
    }
    let ways = [&hero, &led].map(|character| character.world_from_character().translation.z);
    println!("{ways:?} m, {force} N, {seen:?}");
    assert!(ways[0] > 5.5 && ways[1] > ways[0] - 1.6, "{ways:?}");
    assert_eq!([hero.state(), led.state()], [State::Animated, State::Flinching]);
    assert!(seen.speed <= MOST_SPEED && force < 1.25 * grab.max_force, "{seen:?}, {force} N");
    hero.release(&mut world, wrist);
    (0..90).for_each(|_| step(&mut world, [&mut hero, &mut led]));
    assert_eq!(led.state(), State::Animated);
}

#[test]
fn carried_character_does_not_get_up_in_the_air() {
    let def = shared(walker());
    let mut world = level();
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    character.go_limp(&mut world);
    run(&mut world, &mut character, 120);
    // Two bars under trunk and thighs lift the character like arms, carry it, and put it down.
    let trunk = world.center_of_mass(character.bodies()[body(&def, "chest")]);
    let legs = world.center_of_mass(character.bodies()[body(&def, "leftUpperLeg")]);
    let along = ((trunk - legs) * Vec3::new(1.0, 0.0, 1.0)).normalize();
    let across = Rotation::from_axis_angle(Vec3::Y, 0.5 * core::f32::consts::PI) * along;
    let middle = (trunk + legs) * 0.5 * Vec3::new(1.0, 0.0, 1.0);
    let lift = 1.2;
    let poses: Vec<(BodyId, Transform)> =
        character.bodies().iter().map(|&body| (body, world.transform(body))).collect();
    for (body, pose) in poses {
        let translation = pose.translation + Vec3::Y * lift;
        world.set_transform(body, Transform { translation, ..pose });
    }
    let bars = [-0.22, 0.22].map(|at| {
        let half_extents = Vec3::new(0.6, 0.05, 0.06);
        let turn = Rotation::from_arc(Vec3::X, across);
        let place = middle + along * at + Vec3::Y * (lift - 0.07);
        let bar = BodyDef { rotation: turn, ..BodyDef::fixed(Shape::Box { half_extents }).at(place) };
        let bar = world.add_body(&bar);
        world.set_kind(bar, BodyKind::Kinematic);
        bar
    });
    let mut high = f32::INFINITY;
    for step in 0..1800 {
        let linear = if step > 600 { Vec3::X * 0.5 } else { Vec3::ZERO };
        bars.iter().for_each(|&bar| world.set_velocity(bar, Velocity { linear, angular: Vec3::ZERO }));
        world.step();
        character.update(&mut world);
        assert_eq!(character.state(), State::Limp, "carried, step {step}");
        high = high.min(world.center_of_mass(character.bodies()[0]).y);
    }
    assert!(high > 0.9, "the bars must carry the character; height {high} m");
    bars.into_iter().for_each(|bar| world.remove_body(bar));
    let events = run(&mut world, &mut character, 900);
    assert_eq!(character.state(), State::Animated, "a character put down must get up: {events:?}");
}

#[test]
fn character_grabbed_while_getting_up_goes_limp() {
    let def = shared(walker());
    let mut world = level();
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    character.go_limp(&mut world);
    while character.state() != State::GettingUp {
        run(&mut world, &mut character, 1);
    }
    // Add a crane's hook on a kinematic trolley.
    let hand = character.bodies()[body(&def, "rightHand")];
    let at = world.center_of_mass(hand);
    let hook = BodyDef { mass: Some(Shape::sphere(0.1).mass_properties(1000.0)), ..BodyDef::default() };
    let hook = world.add_body(&hook.at(at));
    let trolley = world.add_body(&BodyDef { kind: BodyKind::Kinematic, ..BodyDef::default() }.at(at));
    let ball = JointKind::Ball { limit: None };
    let joint = JointDef::between(trolley, hook, Transform::IDENTITY, Transform::IDENTITY, ball);
    world.add_joint(&joint);
    let on_hand = Transform::from_translation(world.transform(hand).inverse_point(at));
    let joint = JointDef::between(hook, hand, Transform::IDENTITY, on_hand, ball);
    let joint = world.add_joint(&joint);
    let mut seen = Seen::default();
    for step in 0..240 {
        let linear = Vec3::Y * if step < 90 { 1.0 } else { 0.0 };
        world.set_velocity(trolley, Velocity { linear, angular: Vec3::ZERO });
        world.step();
        character.update(&mut world);
        seen.look(&world, &character);
    }
    seen.expect("on a crane");
    assert_eq!(character.state(), State::Limp);
    character.set_preset(&mut world, Preset::Animated);
    assert_eq!(character.state(), State::Limp, "a held character must not get up on request");
    world.remove_joint(joint);
    run(&mut world, &mut character, 900);
    assert_eq!(character.state(), State::Animated);
}

#[test]
fn character_place_follows_its_body() {
    let def = shared(walker());
    let mut world = level();
    let half_extents = Vec3::new(4.0, 0.5, 4.0);
    let truck = world.add_body(&BodyDef::fixed(Shape::Box { half_extents }).at(Vec3::Y * 0.5));
    world.set_kind(truck, BodyKind::Kinematic);
    let linear = Vec3::X * 2.0;
    world.set_velocity(truck, Velocity { linear, angular: Vec3::ZERO });
    let mut character = Character::spawn(&mut world, &def, Transform::from_translation(Vec3::Y));
    character.set_move(Vec3::ZERO);
    run(&mut world, &mut character, 60);
    character.hit(&mut world, body(&def, "chest"), Vec3::new(30.0, 0.0, 60.0));
    assert_eq!(character.state(), State::Limp);
    let (mut jump, mut aside, mut lowered, mut rise) = (0.0, 0.0, 0.0, 0.0);
    let mut before = character.world_from_character().translation;
    for step in 0..900 {
        let was = character.state();
        run(&mut world, &mut character, 1);
        let now = character.world_from_character().translation;
        let under = world.center_of_mass(character.bodies()[0]);
        let changed = (now - before - linear / 60.0).length();
        if matches!(character.state(), State::Limp | State::Preparing) {
            let way = (under - now) * Vec3::new(1.0, 0.0, 1.0);
            if step > 30 {
                aside = max(aside, way.length());
                lowered = max(lowered, (now.y - 1.0).abs());
            }
            jump = max(jump, changed);
        } else if was != character.state() {
            rise = max(rise, changed);
        }
        before = now;
    }
    println!("{jump} m in a step, {aside} m beside, {lowered} m in height, {rise} m where it begins to rise");
    assert!(
        jump < 0.06 && aside < 0.15 && lowered < 0.1,
        "largest step {jump} m, aside {aside} m, lowered {lowered} m"
    );
    assert!(character.state() == State::Animated && before.x > 28.0, "{:?} at {before}", character.state());
}

#[test]
fn stay_down_of_one_character_leaves_the_other_getting_up() {
    let def = shared(walker());
    let mut world = level();
    let mut pair =
        [0.0, 3.0].map(|x| Character::spawn(&mut world, &def, Transform::from_translation(Vec3::X * x)));
    let all = |world: &mut World, pair: &mut [Character; 2], steps: usize| {
        for _ in 0..steps {
            world.step();
            pair.iter_mut().for_each(|character| character.update(world));
        }
    };
    assert_eq!(pair[0].after_settling(), AfterSettling::GetUp);
    pair[0].set_after_settling(AfterSettling::StayDown);
    pair.iter_mut().for_each(|character| character.go_limp(&mut world));
    all(&mut world, &mut pair, 200);
    reload(&mut world, &mut pair[0]);
    all(&mut world, &mut pair, 700);
    assert_eq!(pair.each_ref().map(Character::state), [State::Limp, State::Animated]);
    // The character can be revived, and can die while it is rolled over.
    pair[0].set_after_settling(AfterSettling::GetUp);
    all(&mut world, &mut pair, 600);
    assert_eq!(pair[0].state(), State::Animated);
    let mut died = false;
    pair[0].go_limp(&mut world);
    for _ in 0..900 {
        all(&mut world, &mut pair, 1);
        if pair[0].state() == State::Preparing {
            pair[0].set_after_settling(AfterSettling::StayDown);
            died = true;
        }
        let reported = pair[0].events().iter();
        assert!(!(died && reported.clone().any(|event| matches!(event, CharacterEvent::GettingUp { .. }))));
    }
    assert!(!died || pair[0].state() == State::Limp);
}

#[test]
fn penetration_of_animated_feet_is_reported() {
    let def = shared(walker());
    let mut world = level();
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    character.set_move(Vec3::ZERO);
    run(&mut world, &mut character, 30);
    let foot = character.bodies()[body(&def, "leftFoot")];
    let floor = world.body_ids().next().expect("the floor");
    assert!((world.penetration(foot) - world.overlap(foot, floor)).abs() < 1e-6);
    let chest = character.bodies()[body(&def, "chest")];
    assert!(world.penetration(chest) == 0.0);
    let place = world.transform(foot);
    world.set_transform(foot, Transform { translation: place.translation - Vec3::Y * 0.1, ..place });
    assert!(world.penetration(foot) > 0.09, "{} m", world.penetration(foot));
}
