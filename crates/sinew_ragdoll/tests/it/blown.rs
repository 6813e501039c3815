//! Explosions, bullets, wind and conveyor belts act on animated characters.

use crate::actor::{shared, walker};
use crate::in_world::{level, run};
use sinew_math::{Rotation, Transform, Vec3, max};
use sinew_physics::{
    BodyDef, Explosion, Fade, FieldDef, FieldKind, Material, Region, Shape, ShapeDef, UniformGravity, Wind,
    World, WorldDef,
};
use sinew_ragdoll::{Character, CharacterDef, CharacterEvent, State, Toughness};
use std::sync::Arc;

fn pelvis(world: &World, character: &Character) -> Vec3 {
    world.center_of_mass(character.bodies()[0])
}

/// Returns a standing character that no clip moves, with its world.
fn standing(def: &Arc<CharacterDef>) -> (World, Character) {
    let mut world = level();
    let mut character = Character::spawn(&mut world, def, Transform::IDENTITY);
    character.set_move(Vec3::ZERO);
    run(&mut world, &mut character, 40);
    (world, character)
}

/// Simulates an explosion one metre from a standing character that gives it `momentum` (N·s). Returns the character's
/// events.
fn blast(world: &mut World, character: &mut Character, momentum: f32) -> Vec<CharacterEvent> {
    let center = pelvis(world, character) - Vec3::X;
    let unit = Explosion::new(center, 3.0, 1.0);
    let unit_impulse = {
        let (mut trial_world, mut trial) = (world.clone(), character.clone());
        trial_world.explode(&unit);
        trial_world.step();
        let own = |body| trial.body_index(body).is_some();
        let pushed = trial_world.events().pushed.iter().filter(|push| own(push.body));
        let sum: Vec3 = pushed.map(|push| push.impulse).sum();
        trial.update(&mut trial_world);
        sum.length()
    };
    assert!(unit_impulse > 0.1, "a blast of 1 Pa·s gives an impulse of only {unit_impulse} N·s");
    world.explode(&Explosion { impulse: momentum / unit_impulse, ..unit });
    run(world, character, 1)
}

#[test]
fn explosion_knocks_over_a_standing_character() {
    let def = shared(walker());
    let (mut world, mut character) = standing(&def);
    let events = blast(&mut world, &mut character, 400.0);
    let struck = |event: &CharacterEvent| match *event {
        CharacterEvent::Struck { impulse, .. } => Some(impulse),
        _ => None,
    };
    let felt = events.iter().find_map(struck).expect("the explosion is reported");
    assert!((felt - 400.0).abs() < 4.0, "{felt} N·s");
    assert_eq!(character.state(), State::Limp, "{events:?}");
    let mass: f32 = character.bodies().iter().map(|&body| world.mass(body).mass).sum();
    let momentum: Vec3 =
        character.bodies().iter().map(|&body| world.velocity(body).linear * world.mass(body).mass).sum();
    assert!(
        momentum.x > 0.9 * 400.0 && momentum.x < 1.1 * 400.0,
        "momentum {momentum} N·s of a mass of {mass} kg"
    );
    let from = pelvis(&world, &character);
    run(&mut world, &mut character, 60);
    let way = pelvis(&world, &character) - from;
    assert!(way.x > 1.5, "it moves {way}");
    let events = run(&mut world, &mut character, 60 * 14);
    assert!(events.contains(&CharacterEvent::Up), "{:?}, {events:?}", character.state());
}

#[test]
fn weak_explosion_causes_a_flinch_and_displacement() {
    let def = shared(walker());
    let mut last = 0.0;
    for momentum in [10.0, 20.0, 30.0, 40.0] {
        let (mut world, mut character) = standing(&def);
        let from = pelvis(&world, &character);
        let events = blast(&mut world, &mut character, momentum);
        assert_eq!(character.state(), State::Flinching, "momentum {momentum} N·s: {events:?}");
        let (mut before, mut jump, mut most) = (from, 0.0, 0.0);
        for _ in 0..90 {
            run(&mut world, &mut character, 1);
            let now = pelvis(&world, &character);
            jump = max(jump, (now - before).length());
            most = max(most, (now - from).x);
            before = now;
        }
        println!("{momentum} N·s: the pelvis goes {most} m, {jump} m in a step");
        assert!(
            most > last && jump < 0.02,
            "momentum {momentum} N·s: farthest {most} m, at the end {last} m, largest step {jump} m"
        );
        assert_eq!(character.state(), State::Animated);
        last = most;
    }
    assert!(last > 0.02, "{last} m");
}

#[test]
fn bullet_or_impulse_on_an_animated_body_counts_as_a_hit() {
    let def = shared(walker());
    let chest = def.body_named("chest").expect("the character has a chest");
    for (size, state) in [(1.0, State::Animated), (20.0, State::Flinching), (90.0, State::Limp)] {
        let (mut world, mut character) = standing(&def);
        world.apply_impulse_at_center(character.bodies()[chest], Vec3::X * size);
        run(&mut world, &mut character, 1);
        assert_eq!(character.state(), state, "{size} N·s");
    }
    let (mut world, mut character) = standing(&def);
    let at = world.center_of_mass(character.bodies()[chest]);
    world.apply_bullet_impact(character.bodies()[chest], 0.01, Vec3::X * 800.0, at);
    run(&mut world, &mut character, 1);
    assert_eq!(
        character.state(),
        State::Flinching,
        "the impulse of a rifle's bullet, 8 N·s, must cause a flinch"
    );
}

/// Returns a field with this sideways acceleration, m/s².
fn pull(acceleration: Vec3) -> FieldDef {
    FieldDef::new(FieldKind::Uniform(UniformGravity { acceleration }))
}

#[test]
fn character_resists_a_field_until_its_feet_slip() {
    let def = shared(walker());
    let after = |acceleration: f32, steps: usize| {
        let (mut world, mut character) = standing(&def);
        world.add_field(&pull(Vec3::X * acceleration));
        let from = pelvis(&world, &character);
        run(&mut world, &mut character, steps);
        (character.state(), (pelvis(&world, &character) - from).x)
    };
    let (state, way) = after(3.0, 180);
    assert!(state == State::Animated && way.abs() < 0.01, "wind of 3 m/s²: {state:?}, moved {way} m");
    let (state, way) = after(7.0, 12);
    assert!(state == State::Animated && way > 0.01, "wind of 7 m/s²: {state:?}, moved {way} m");
    let (state, _) = after(7.0, 60);
    assert_eq!(state, State::Limp, "7 m/s² must make the character fall");
    // In the air the character accelerates like any free body.
    let (mut world, mut character) = standing(&def);
    world.add_field(&pull(Vec3::X * 3.0));
    character.jump(&mut world);
    let from = pelvis(&world, &character);
    let (mut aloft, mut high, mut off) = (0, 0.0, 0.0);
    for _ in 0..120 {
        run(&mut world, &mut character, 1);
        high = max(high, pelvis(&world, &character).y - from.y);
        let up = character.world_from_character().translation.y;
        off = max(off, (pelvis(&world, &character).y - from.y - up).abs());
        if character.mover().is_some_and(|mover| world.mover_ground(mover).is_none()) {
            aloft += 1;
        } else if aloft > 0 {
            break;
        }
    }
    let (time, way) = (aloft as f32 / 60.0, (pelvis(&world, &character) - from).x);
    assert!(high > 0.55 && off < 0.12, "the body is {high} m high and {off} m from its mover");
    let falls = 0.5 * 3.0 * time * time;
    assert!(
        time > 0.6 && (way - falls).abs() < 0.25 * falls,
        "moved {way} m in {time} s; free fall: {falls} m"
    );
}

#[test]
fn strong_wind_makes_a_character_fall_and_updraft_lifts_it() {
    let mut def = walker();
    def.in_world.toughness = Toughness::Impulse(60.0);
    let def = shared(def);
    let wind = |speed: f32, steps: usize| {
        let (mut world, mut character) = standing(&def);
        world.add_field(&FieldDef::new(FieldKind::Wind(Wind {
            velocity: Vec3::X * speed,
            ..Wind::default()
        })));
        run(&mut world, &mut character, steps);
        character.state()
    };
    assert_eq!(wind(12.0, 240), State::Animated, "a fresh breeze");
    assert_eq!(wind(60.0, 240), State::Limp, "a hurricane");
    let (mut world, mut character) = standing(&def);
    let field = world.add_field(&pull(Vec3::Y * 12.0));
    run(&mut world, &mut character, 40);
    let high = pelvis(&world, &character).y;
    assert!(high > 1.2, "an updraft above the weight must lift the character; height {high} m");
    world.remove_field(field);
    // Fields of a region act only inside it.
    let (mut world, mut character) = standing(&def);
    let room = Region::ball(Vec3::X * 9.0, 2.0, Fade::Linear);
    world.add_field(&FieldDef { region: room, ..pull(Vec3::X * 30.0) });
    run(&mut world, &mut character, 60);
    assert_eq!(character.state(), State::Animated);
}

#[test]
fn conveyor_belt_carries_a_standing_character() {
    let def = shared(walker());
    let mut world = World::new(WorldDef::default());
    let material = Material { surface_velocity: Vec3::X * 1.5, ..Material::DEFAULT };
    let half_extents = Vec3::new(20.0, 0.5, 4.0);
    let belt = ShapeDef { material, ..ShapeDef::new(Shape::Box { half_extents }) };
    world.add_body(&BodyDef::fixed(belt).at(Vec3::Y * -0.5));
    let turn = Rotation::from_axis_angle(Vec3::Y, 0.4);
    let mut character = Character::spawn(&mut world, &def, Transform::new(Vec3::ZERO, turn));
    character.set_move(Vec3::ZERO);
    run(&mut world, &mut character, 60);
    let from = pelvis(&world, &character);
    run(&mut world, &mut character, 120);
    let way = pelvis(&world, &character) - from;
    assert!((way.x - 3.0).abs() < 0.05 && way.z.abs() < 0.02, "{way}");
    assert_eq!(character.state(), State::Animated);
}
