//! An animated character interacts with the world: walls, other characters, rays, balls, crates, cliffs and lifts.

use crate::actor::{floor, shared, walker};
use core::f32::consts::PI;
use sinew_math::{Random, Reader, Rotation, Transform, Vec3, Writer, max};
use sinew_physics::ray::Ray;
use sinew_physics::{
    BodyContact, BodyDef, BodyId, BodyKind, Probe, Shape, ShapeCast, ShapeDef, Velocity, World, WorldDef,
};
use sinew_ragdoll::{Character, CharacterDef, CharacterEvent, FootPlanting, HitBodies, State};
use sinew_scenes::mannequin::WALK_SPEED;
use std::sync::Arc;

/// Returns a world with a floor.
pub fn level() -> World {
    let mut world = World::new(WorldDef::default());
    world.add_body(&floor());
    world
}

/// Adds a fixed box from corner to corner.
fn block(world: &mut World, min: Vec3, max: Vec3) -> BodyId {
    let half_extents = (max - min) * 0.5;
    world.add_body(&BodyDef::fixed(Shape::Box { half_extents }).at((min + max) * 0.5))
}

/// Steps and returns the character's events.
pub fn run(world: &mut World, character: &mut Character, steps: usize) -> Vec<CharacterEvent> {
    let mut events = Vec::new();
    for _ in 0..steps {
        world.step();
        character.update(world);
        events.extend_from_slice(character.events());
    }
    events
}

fn place(character: &Character) -> Vec3 {
    character.world_from_character().translation
}

#[test]
fn wall_stops_a_walking_character() {
    let def = shared(walker());
    let mut world = level();
    block(&mut world, Vec3::new(-3.0, 0.0, 2.0), Vec3::new(3.0, 4.0, 2.3));
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    run(&mut world, &mut character, 300);
    let radius = def.in_world.mover.as_ref().expect("the body exists").radius;
    let z = place(&character).z;
    assert!((z - (2.0 - radius)).abs() < 0.02, "the character stands at {z} m; the wall is at 2 m");
    assert_eq!(character.state(), State::Animated);
    // Without a mover the character passes through.
    let mut ghost = Character::new(def, Transform::IDENTITY, 0.0);
    run(&mut world, &mut ghost, 300);
    assert!(place(&ghost).z > 5.0);
}

#[test]
fn character_walks_as_fast_as_its_clip() {
    let def = shared(walker());
    let mut world = level();
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    run(&mut world, &mut character, 240);
    let expected = WALK_SPEED * 240.0 / 60.0;
    let at = place(&character);
    assert!((at.z - expected).abs() < 0.1 && at.y.abs() < 0.01 && at.x.abs() < 1e-3, "{at} for {expected}");
}

#[test]
fn two_characters_stop_each_other() {
    let def = shared(walker());
    let mut world = level();
    let toward = Transform::new(Vec3::Z * 4.0, Rotation::from_axis_angle(Vec3::Y, core::f32::consts::PI));
    let mut one = Character::spawn(&mut world, &def, Transform::IDENTITY);
    let mut other = Character::spawn(&mut world, &def, toward);
    for _ in 0..300 {
        world.step();
        one.update(&mut world);
        other.update(&mut world);
        let apart = (place(&one) - place(&other)).length();
        let radius = def.in_world.mover.as_ref().expect("the body exists").radius;
        assert!(apart > 2.0 * radius - 0.01, "{apart} m apart");
    }
    assert!(place(&one).z < 2.1 && place(&other).z > 1.9);
}

/// Returns the body poses in the drawn pose.
fn shown_bodies(character: &Character) -> Vec<Transform> {
    let def = character.def();
    let (mut model, mut poses) = (Vec::new(), Vec::new());
    sinew_anim::local_to_model(&def.rig, character.pose(), &sinew_math::Affine::IDENTITY, &mut model);
    def.mapping().bodies_from_model(&model, character.world_from_character(), &mut poses);
    poses
}

/// Returns a horizontal ray through the midpoint of a drawn bone.
fn across(character: &Character, bone: &str) -> Ray {
    let def = character.def();
    let body = def.body_named(bone).expect("a bone");
    let middle = shown_bodies(character)[body].point(def.ragdoll.bodies[body].mass.center);
    let from = Vec3::new(4.0, 1.0, -2.0);
    Ray { origin: middle + from, direction: -from * 2.0 }
}

#[test]
fn rays_and_shape_casts_hit_the_drawn_bone() {
    let def = shared(walker());
    let mut world = level();
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    run(&mut world, &mut character, 97);
    let (mut worst, mut sum, mut count): (f32, f32, f32) = (0.0, 0.0, 0.0);
    for _ in 0..60 {
        run(&mut world, &mut character, 1);
        for bone in ["head", "leftLowerLeg", "chest", "rightLowerArm"] {
            let ray = across(&character, bone);
            let mut hits = Vec::new();
            world.query().all(&ray, &mut hits);
            let found = hits.iter().any(|hit| character.body_index(hit.body) == def.body_named(bone));
            assert!(found, "{bone}: {hits:?}");
        }
        let poses = shown_bodies(&character);
        for (&body, pose) in character.bodies().iter().zip(&poses) {
            let off = (world.transform(body).translation - pose.translation).length();
            (worst, sum, count) = (max(worst, off), sum + off, count + 1.0);
        }
    }
    let mean = sum / count;
    // A foot that lands at 2.5 m/s stops within a step.
    assert!(
        worst < 0.05 && mean < 0.004,
        "bodies are {mean} m from their bones on average, {worst} m at most"
    );
    let ball = Probe::at(Shape::Sphere { radius: 0.05 }, place(&character) + Vec3::new(0.0, 1.2, 5.0));
    let hit = world.query().first(&ShapeCast { probe: ball, translation: Vec3::Z * -10.0 }).expect("a hit");
    assert!(character.body_index(hit.body).is_some());
}

fn ball(world: &mut World, at: Vec3, velocity: Vec3) -> BodyId {
    let shape = Shape::Sphere { radius: 0.11 };
    let mut def = BodyDef::dynamic(shape.clone()).at(at);
    def.mass = Some(shape.mass_properties(77.0));
    def.linear_velocity = velocity;
    def.shapes[0].material.restitution = 0.7;
    world.add_body(&def)
}

#[test]
fn ball_bounces_off_and_the_contact_is_reported() {
    let mut def = walker();
    def.in_world.toughness = sinew_ragdoll::Toughness::Impulse(60.0);
    let def = shared(def);
    let mut world = level();
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    run(&mut world, &mut character, 30);
    let chest = place(&character) + Vec3::Y * 1.25;
    let thrown = ball(&mut world, chest + Vec3::Z * 1.0, Vec3::Z * -20.0);
    let (mut events, mut met) = (Vec::new(), false);
    for _ in 0..12 {
        events.extend(run(&mut world, &mut character, 1));
        let chest = character.bodies()[def.body_named("chest").expect("the body exists")];
        let is_this_hit = |hit: &sinew_physics::Hit| [hit.a.body, hit.b.body] == [chest, thrown];
        met |= world.events().hits.iter().any(is_this_hit);
    }
    assert!(met, "the contact event names the bone");
    let speed = world.velocity(thrown).linear.z;
    assert!(speed > 5.0, "the ball rebounds at {speed} m/s");
    assert!(events.iter().any(|event| matches!(event, CharacterEvent::Struck { .. })), "{events:?}");
    assert!(events.iter().any(|event| matches!(event, CharacterEvent::Flinched { .. })), "{events:?}");
    assert!(!events.iter().any(|event| matches!(event, CharacterEvent::WentLimp)), "17 N·s do not fell it");
}

#[test]
fn hit_bodies_can_be_left_out() {
    let mut def = walker();
    def.in_world.hit_bodies = HitBodies::Absent;
    let def = shared(def);
    let mut world = level();
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    run(&mut world, &mut character, 30);
    assert_eq!(world.body_ids().count(), 1);
    assert!(world.query().first(&across(&character, "head")).is_none());
    assert!(character.mover().is_some());
}

/// Adds a box with a given mass.
fn load(world: &mut World, mass: f32, half: f32, at: Vec3) -> BodyId {
    let shape = Shape::Box { half_extents: Vec3::splat(half) };
    let mut def = BodyDef::dynamic(shape.clone()).at(at);
    def.mass = Some(shape.mass_properties(mass / (8.0 * half * half * half)));
    world.add_body(&def)
}

#[test]
fn crate_is_pushed_with_at_most_the_movers_force() {
    let def = shared(walker());
    let pushed = |mass: f32| {
        let mut world = level();
        let load = load(&mut world, mass, 0.4, Vec3::new(0.0, 0.4, 1.5));
        let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
        let mut fastest = 0.0;
        for _ in 0..240 {
            run(&mut world, &mut character, 1);
            fastest = max(fastest, world.velocity(load).linear.length());
        }
        (world.transform(load).translation.z - 1.5, fastest)
    };
    let (way, fastest) = pushed(40.0);
    assert!(way > 1.0 && fastest < 1.3 * WALK_SPEED, "moved {way} m, fastest {fastest} m/s");
    // Sliding 500 kg takes 2.9 kN. Without a bound, hands and feet would push the crate by their own motion.
    let (way, fastest) = pushed(500.0);
    assert!(way.abs() < 0.02 && fastest < 0.1, "moved {way} m, fastest {fastest} m/s");
}

/// A sliding crate of 300 kg at walking speed pushes the character along; without a mover it would pass through.
#[test]
fn moving_crate_pushes_the_character() {
    let mut world = level();
    let mut character = Character::spawn(&mut world, &shared(walker()), Transform::IDENTITY);
    character.set_move(Vec3::ZERO);
    let load = load(&mut world, 300.0, 0.4, Vec3::new(0.0, 0.4, -1.0));
    let mut nearest = f32::INFINITY;
    for _ in 0..180 {
        // The crate is kept moving.
        world.set_velocity(load, Velocity { linear: Vec3::Z * 0.4, ..Velocity::default() });
        run(&mut world, &mut character, 1);
        nearest = sinew_math::min(nearest, place(&character).z - world.transform(load).translation.z);
    }
    let (went, crate_went) = (place(&character).z, world.transform(load).translation.z + 1.0);
    assert!(crate_went > 0.5, "the crate moved {crate_went} m");
    assert!(
        went > 0.3 && nearest > 0.4,
        "the character moved {went} m; its centre was at least {nearest} m from the crate's"
    );
    assert!(matches!(character.state(), State::Animated | State::Flinching), "{:?}", character.state());
}

#[test]
fn character_falls_off_a_cliff() {
    let def = shared(walker());
    let mut world = level();
    block(&mut world, Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 10.0, 2.0));
    let mut character = Character::spawn(&mut world, &def, Transform::from_translation(Vec3::Y * 10.0));
    let events = run(&mut world, &mut character, 60 * 4);
    assert!(events.contains(&CharacterEvent::WentLimp), "{events:?}");
    let pelvis = world.transform(character.bodies()[0]).translation;
    assert!(pelvis.y < 1.0 && pelvis.is_finite(), "it lies at {pelvis}");
    assert!(character.mover().is_none(), "a fallen character must have no mover");
}

#[test]
fn character_walks_off_a_short_drop() {
    let def = shared(walker());
    let mut world = level();
    block(&mut world, Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 1.0, 1.0));
    let mut character = Character::spawn(&mut world, &def, Transform::from_translation(Vec3::Y));
    let events = run(&mut world, &mut character, 180);
    assert!(!events.contains(&CharacterEvent::WentLimp), "{events:?}");
    assert!(place(&character).y.abs() < 0.01 && place(&character).z > 2.5, "{}", place(&character));
}

#[test]
fn fast_landing_makes_the_character_limp() {
    let def = shared(walker());
    let mut world = level();
    block(&mut world, Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 4.0, 1.0));
    let mut character = Character::spawn(&mut world, &def, Transform::from_translation(Vec3::Y * 4.0));
    let events = run(&mut world, &mut character, 180);
    // A fall of 4 m takes 0.9 s, which is too short for the threshold on time in the air.
    assert!(
        events.contains(&CharacterEvent::WentLimp),
        "an impact at 8.9 m/s exceeds the toughness of 7 m/s"
    );
}

/// Adds a moving platform.
fn lift(world: &mut World, at: Vec3, velocity: Velocity) -> BodyId {
    let def = BodyDef {
        kind: BodyKind::Kinematic,
        position: at,
        linear_velocity: velocity.linear,
        angular_velocity: velocity.angular,
        shapes: vec![ShapeDef::new(Shape::Box { half_extents: Vec3::new(3.0, 0.1, 3.0) })],
        ..BodyDef::default()
    };
    world.add_body(&def)
}

fn stander() -> Arc<CharacterDef> {
    let mut def = walker();
    let motions = def.motions().clone();
    def.set_motions(sinew_ragdoll::MotionSet { idle: Some(1), ..motions })
        .expect("the motions were accepted before");
    shared(def)
}

#[test]
fn lift_and_turntable_carry_the_character() {
    let def = stander();
    let mut world = World::new(WorldDef::default());
    let velocity = Velocity { linear: Vec3::new(0.5, 1.0, 0.0), angular: Vec3::Y * 0.5 };
    let platform = lift(&mut world, Vec3::Y * -0.1, velocity);
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    character.set_move(Vec3::ZERO);
    run(&mut world, &mut character, 30);
    let seen = |world: &World, character: &Character| {
        world.transform(platform).inverse() * character.world_from_character()
    };
    let before = seen(&world, &character);
    run(&mut world, &mut character, 180);
    let after = seen(&world, &character);
    assert!(
        place(&character).y > 3.0,
        "the lift has not carried the character up: it is at {}",
        place(&character)
    );
    assert!((after.translation - before.translation).length() < 0.02, "{before:?} {after:?}");
    assert!(after.rotation.angle_to(before.rotation) < 0.01);
}

#[test]
fn set_move_and_face_steer_the_character() {
    let def = stander();
    let mut world = level();
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    character.set_move(Vec3::X * 0.9);
    character.face(Vec3::X);
    run(&mut world, &mut character, 120);
    let at = character.world_from_character();
    assert!((at.translation.x - 0.9 * 2.0).abs() < 0.1 && at.translation.z.abs() < 0.05, "{at:?}");
    assert!(
        (at.rotation * Vec3::Z - Vec3::X).length() < 0.01,
        "the character must face its direction of motion"
    );
    character.jump(&mut world);
    let mut highest = 0.0;
    for _ in 0..60 {
        run(&mut world, &mut character, 1);
        highest = max(highest, place(&character).y);
    }
    let expected = 3.5 * 3.5 / (2.0 * 9.81);
    assert!((highest - expected).abs() < 0.05, "jumps {highest} m, expected {expected} m");
    character.teleport(&mut world, Transform::from_translation(Vec3::new(-4.0, 0.0, 2.0)));
    character.set_move(Vec3::ZERO);
    run(&mut world, &mut character, 60);
    assert!((place(&character) - Vec3::new(-4.0, 0.0, 2.0)).length() < 0.02, "{}", place(&character));
    assert!((world.transform(character.bodies()[0]).translation - place(&character)).length() < 1.3);
}

#[test]
fn despawn_removes_bodies_joints_and_movers() {
    let def = shared(walker());
    for after in [0, 30, 90, 300, 600] {
        let mut world = level();
        let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
        run(&mut world, &mut character, 10);
        if after > 0 {
            character.hit(&mut world, 0, Vec3::Z * 100.0);
        }
        run(&mut world, &mut character, after);
        character.despawn(&mut world);
        assert_eq!(world.body_ids().count(), 1, "after {after} steps");
        assert_eq!(world.joint_ids().count() + world.mover_ids().count(), 0, "after {after} steps");
        world.step();
    }
}

#[test]
fn character_gets_up_with_the_same_bodies() {
    let def = shared(walker());
    let mut world = level();
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    run(&mut world, &mut character, 30);
    let bodies = character.bodies().to_vec();
    character.hit(&mut world, 2, Vec3::new(70.0, 0.0, 20.0));
    assert_eq!(character.state(), State::Limp);
    let events = run(&mut world, &mut character, 60 * 12);
    assert!(events.contains(&CharacterEvent::Up), "{events:?}");
    assert_eq!(character.bodies(), bodies, "the bodies must keep their ids");
    assert!(bodies.iter().all(|&body| world.kind(body) == BodyKind::Kinematic));
    let before = place(&character);
    run(&mut world, &mut character, 60);
    assert!((place(&character) - before).length() > 0.8 * WALK_SPEED);
    let height = def.in_world.mover.as_ref().expect("the body exists").height;
    assert_eq!(world.mover(character.mover().expect("the character stands")).def().height, height);
}

#[test]
fn restored_character_continues_identically() {
    let def = shared(walker());
    for steps in [20, 40, 60, 150, 400, 500] {
        let mut world = level();
        let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
        run(&mut world, &mut character, 15);
        character.hit(&mut world, 3, Vec3::X * 10.0);
        run(&mut world, &mut character, 25);
        character.hit(&mut world, 2, Vec3::X * 90.0);
        run(&mut world, &mut character, steps);
        let mut w = Writer::new();
        world.save(&mut w);
        character.save(&mut w);
        run(&mut world, &mut character, 60);
        let bytes = w.into_bytes();
        let mut reader = Reader::new(&bytes);
        let mut other_world = World::new(WorldDef::default());
        let mut other = Character::new(def.clone(), Transform::IDENTITY, 0.0);
        other_world.load(&mut reader).expect("the snapshot is valid");
        other.load(&mut reader).expect("the snapshot is valid");
        run(&mut other_world, &mut other, 60);
        assert_eq!(world.hash(), other_world.hash(), "after {steps}");
        assert_eq!(character.pose(), other.pose(), "after {steps}");
    }
}

#[test]
fn character_is_send_and_sync() {
    fn require_send_and_sync<T: Send + Sync>(_: &T) {}
    let def = shared(walker());
    let mut world = level();
    let character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    require_send_and_sync(&character);
}

#[test]
fn character_gets_up_on_a_rising_lift_and_on_a_crate() {
    let def = stander();
    let mut world = World::new(WorldDef::default());
    let velocity = Velocity { linear: Vec3::new(0.3, 0.6, 0.0), angular: Vec3::ZERO };
    let platform = lift(&mut world, Vec3::Y * -0.1, velocity);
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    character.set_move(Vec3::ZERO);
    run(&mut world, &mut character, 30);
    character.hit(&mut world, 2, Vec3::new(0.0, 0.0, -70.0));
    let events = run(&mut world, &mut character, 60 * 12);
    let settled = events.iter().any(|event| matches!(event, CharacterEvent::Settled { .. }));
    assert!(settled, "the character never settled on the platform: {events:?}");
    assert!(events.contains(&CharacterEvent::Up), "{events:?}");
    let height = place(&character).y - (world.transform(platform).translation.y + 0.1);
    assert!(height.abs() < 0.02, "the character stands {height} m above the lift");

    let mut world = level();
    let shape = Shape::Box { half_extents: Vec3::new(1.5, 0.3, 1.5) };
    world.add_body(&BodyDef::dynamic(shape).at(Vec3::Y * 0.3));
    let mut character = Character::spawn(&mut world, &def, Transform::from_translation(Vec3::Y * 0.6));
    character.set_move(Vec3::ZERO);
    run(&mut world, &mut character, 30);
    character.hit(&mut world, 2, Vec3::new(0.0, 0.0, -46.0));
    let events = run(&mut world, &mut character, 60 * 12);
    assert!(events.contains(&CharacterEvent::Up), "{events:?}");
    let at = place(&character);
    assert!((at.y - 0.6).abs() < 0.02 || at.y.abs() < 0.02 && at.length() > 1.5, "it stands at {at}");
}

#[test]
fn character_waits_to_get_up_until_nobody_stands_on_it() {
    // Without this setting, legs that reach for the floor beside the lying character would hit it.
    let mut def = walker();
    def.in_world.foot_planting = FootPlanting::AsClips;
    let def = shared(def);
    let radius = def.in_world.mover.as_ref().expect("the body exists").radius;
    let mut world = level();
    let mut fallen = Character::spawn(&mut world, &def, Transform::IDENTITY);
    run(&mut world, &mut fallen, 30);
    fallen.go_limp(&mut world);
    run(&mut world, &mut fallen, 90);
    // The second character is placed above the fallen one, without overlap.
    let over = world.center_of_mass(fallen.bodies()[0]) + Vec3::Y * 0.15;
    let mut other = Character::spawn(&mut world, &def, Transform::from_translation(over));
    let mut least = f32::INFINITY;
    let (mut up_after, mut stood) = (None, 0);
    for step in 0..900 {
        if step < 420 {
            // The second character follows the fallen one as it rolls.
            let way = (world.center_of_mass(fallen.bodies()[0]) - place(&other)).with_y(0.0);
            other.set_move(way * 3.0);
        }
        if step == 420 {
            other.set_move(Vec3::X * 1.5);
        }
        world.step();
        let ground = other.mover().and_then(|id| world.mover_ground(id)).and_then(|ground| ground.shape);
        let stands = ground.is_some_and(|on| fallen.bodies().contains(&on.body));
        let was = fallen.state();
        fallen.update(&mut world);
        let begins = was == State::Limp && fallen.state() == State::GettingUp;
        assert!(!(begins && stands), "the character gets up in step {step} while another stands on it");
        stood += u32::from(stands && was == State::Limp);
        other.update(&mut world);
        if fallen.mover().is_some() {
            let way = place(&fallen) - place(&other);
            least = f32::min(least, way.with_y(0.0).length() - 2.0 * radius);
        }
        if fallen.state() == State::Animated && up_after.is_none() {
            up_after = Some(step);
        }
    }
    assert!(stood > 10, "the other character stood on it for only {stood} steps");
    assert!(up_after.is_some(), "the character stays down although the other has left: {:?}", fallen.state());
    assert!(least > -0.01, "they overlap by {} m", -least);
}

/// Returns the upward impulse that bodies gave other dynamic bodies in the last step, minus the impulse that they
/// received, N·s.
fn lifts(world: &World, own: &[BodyId], others: &[BodyId]) -> f32 {
    let up = |contact: BodyContact| {
        let [a, b] = [contact.a.body, contact.b.body];
        if [a, b].iter().any(|&body| world.kind(body) != BodyKind::Dynamic) {
            return 0.0;
        }
        let up = contact.normal.y * contact.impulse() + contact.friction.y;
        match (own.contains(&a) && others.contains(&b), own.contains(&b) && others.contains(&a)) {
            (true, _) => up,
            (_, true) => -up,
            _ => 0.0,
        }
    };
    world.contacts().map(up).sum()
}

/// Two characters have fallen on each other: neither gets up under a load, both finally stand, and getting up seldom
/// hits the other hard.
#[test]
fn upper_of_two_fallen_characters_gets_up_first() {
    let def = shared(walker());
    let mut struck = 0;
    for seed in 0..12 {
        let mut random = Random::new(seed);
        let mut world = level();
        let share = 0.03 * def.ragdoll.total_mass * world.def().gravity.length() * world.def().dt();
        let mut under = Character::spawn(&mut world, &def, Transform::IDENTITY);
        run(&mut world, &mut under, 30);
        under.go_limp(&mut world);
        run(&mut world, &mut under, 50);
        let aside = Vec3::new(random.range(-0.3, 0.3), 0.0, random.range(-0.3, 0.3));
        let pelvis = world.center_of_mass(under.bodies()[0]).with_y(0.6) + aside;
        let lies = Rotation::from_axis_angle(Vec3::Y, random.range(-PI, PI))
            * Rotation::from_axis_angle(Vec3::X, 1.4);
        let mut over = Character::new(def.clone(), Transform::new(pelvis, lies), 0.0);
        over.enter(&mut world);
        over.go_limp(&mut world);
        let mut both = [under, over];
        let (mut fastest, mut up) = (0.0, [None; 2]);
        for step in 0..1200 {
            world.step();
            let load = lifts(&world, both[0].bodies(), both[1].bodies());
            let mut loads = Vec::new();
            for (character, load) in both.iter_mut().zip([load, -load]) {
                let speed = |&id: &BodyId| world.velocity(id).linear.length();
                let was = character.state();
                if step > 100 && was == State::Limp {
                    fastest = character.bodies().iter().map(speed).fold(fastest, max);
                }
                character.update(&mut world);
                if was != State::GettingUp && character.state() == State::GettingUp {
                    loads.push(load);
                }
            }
            // Skipped when both begin: then neither carries the other.
            if let [load] = loads[..] {
                assert!(load < share, "seed {seed}: gets up under a load of {load} N·s in step {step}");
            }
            for (character, up) in both.iter().zip(&mut up) {
                if character.state() == State::Animated {
                    up.get_or_insert(step);
                }
            }
        }
        println!("seed {seed}: fastest limp {fastest:.2} m/s, up after {up:?} steps");
        assert!(up.iter().all(Option::is_some), "seed {seed}: {:?}", both.map(|one| one.state()));
        struck += u32::from(fastest > 10.0);
    }
    // Without waiting for each other, 8 of 12 are hit.
    assert!(struck <= 3, "{struck} of 12 characters are hit at more than 10 m/s");
}

/// The character walks over crates lower than a step: its mover presses on them, and its feet do not kick them away.
#[test]
fn low_crates_are_not_kicked_away() {
    let def = stander();
    let mut random = Random::new(5);
    for case in 0..30 {
        let mut world = level();
        let half = random.range(0.1, 0.17);
        let at = Vec3::new(random.range(-0.2, 0.2), half, random.range(0.8, 1.6));
        let load = load(&mut world, random.range(12.0, 30.0), half, at);
        let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
        character.set_move(Vec3::Z * 1.2);
        let (mut fastest, mut highest) = (0.0, 0.0);
        for step in 0..360 {
            // The character pauses on the crate at times.
            let stands = (60 + 2 * case..150 + 2 * case).contains(&step);
            character.set_move(Vec3::Z * if stands { 0.0 } else { 1.2 });
            run(&mut world, &mut character, 1);
            fastest = max(fastest, world.velocity(load).linear.length());
            highest = max(highest, place(&character).y);
        }
        assert!(fastest < 3.0, "case {case}: a crate of half size {half} m reached {fastest} m/s");
        assert!(highest < 2.0 * half + 0.05, "case {case}: the crate was thrown to {highest} m");
    }
}

/// Small objects are under the character's feet. A contact with an object that only the foot moves is not a hit,
/// however hard an animated foot presses the object to the floor.
#[test]
fn object_under_a_foot_is_no_hit() {
    let def = shared(walker());
    for shift in [0.0, 0.004, 0.016, 0.026] {
        let mut world = level();
        for row in 0..8 {
            for column in -2..=2 {
                let at = Vec3::new(0.09 * column as f32 + shift, 0.04, 0.6 + 0.3 * row as f32);
                load(&mut world, 0.5, 0.04, at);
            }
        }
        let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
        character.set_move(Vec3::Z * 1.3);
        for event in run(&mut world, &mut character, 200) {
            let struck = if let CharacterEvent::Struck { impulse, .. } = event { impulse } else { 0.0 };
            assert!(struck < 10.0, "an object of half a kilogram hit with {struck} N·s");
        }
        assert!(place(&character).z > 2.5 && character.state() != State::Limp);
    }
}

/// The walker changes from standing to walking and back: clips are cross-faded gradually, so that hit bodies do not
/// kick.
#[test]
fn walk_starts_and_stops_smoothly() {
    let mut def = walker();
    let motions = def.motions().clone();
    def.set_motions(sinew_ragdoll::MotionSet { idle: Some(1), ..motions })
        .expect("the motions were accepted before");
    let mut world = level();
    let mut character = Character::spawn(&mut world, &shared(def), Transform::IDENTITY);
    let mut fastest = 0.0;
    for step in 0..360 {
        character.set_move(if (60..240).contains(&step) { Vec3::Z * WALK_SPEED } else { Vec3::ZERO });
        run(&mut world, &mut character, 1);
        if step > 0 {
            let speeds = character.bodies().iter().map(|&body| world.velocity(body).linear.length());
            fastest = speeds.fold(fastest, max);
        }
    }
    assert!(fastest < 8.0, "a hand or foot moves at {fastest} m/s");
}

#[test]
fn body_created_inside_pushes_the_character_aside_smoothly() {
    let def = shared(walker());
    let mut world = level();
    let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    character.set_move(Vec3::ZERO);
    run(&mut world, &mut character, 60);
    let before = place(&character);
    block(&mut world, before + Vec3::new(0.05, 0.0, -1.0), before + Vec3::new(2.0, 1.9, 1.0));
    let (mut most, mut last) = (0.0, before);
    for _ in 0..60 {
        run(&mut world, &mut character, 1);
        most = max(most, (place(&character) - last).length());
        last = place(&character);
    }
    let gone = (last - before).length();
    assert!(gone > 0.2, "the character moved {gone} m aside");
    assert!(most < 0.08, "the character moved {most} m of {gone} m within a step");
}
