//! Tests of `Character::clear`: a character that goes limp in a wall or floor is moved out of it.

use sinew_math::{Random, Reader, Rotation, Transform, Vec3, Writer, max, min};
use sinew_physics::{BodyDef, BodyId, BodyKind, Filter, Shape, ShapeDef, Velocity, World, WorldDef};
use sinew_ragdoll::{Character, CharacterDef};
use std::sync::Arc;

/// Number of steps in half a second.
const HALF_SECOND: usize = 30;

fn deepest(world: &World, character: &Character) -> f32 {
    let statics: Vec<BodyId> = world.body_ids().filter(|&id| world.kind(id) == BodyKind::Static).collect();
    let of = |&body: &BodyId| statics.iter().fold(0.0, |most, &other| max(most, world.overlap(body, other)));
    character.bodies().iter().map(of).fold(0.0, max)
}

fn fastest(world: &World, character: &Character) -> f32 {
    character.bodies().iter().fold(0.0, |most, &body| max(most, world.velocity(body).linear.length()))
}

/// Returns a world with a floor and a wall 0.2 m thick across z = 0.
fn world_with_wall() -> World {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let wall = Shape::cuboid(Vec3::new(3.0, 1.5, 0.1));
    world.add_body(&BodyDef::fixed(wall).at(Vec3::Y * 1.5));
    world
}

fn limp_at(world: &mut World, def: &Arc<CharacterDef>, place: Transform) -> Character {
    let mut character = Character::spawn(world, def, place);
    character.update(world);
    character.go_limp(world);
    character
}

/// Steps until no body is deeper than 2 cm in static bodies. Returns the number of steps and the largest body speed
/// until then; `None` after two seconds.
fn out_of_it(world: &mut World, character: &mut Character) -> Option<(usize, f32)> {
    let mut speed = 0.0;
    for step in 0..120 {
        world.step();
        character.update(world);
        speed = max(speed, fastest(world, character));
        if deepest(world, character) < 0.02 {
            return Some((step, speed));
        }
    }
    None
}

#[test]
fn limp_character_leaves_the_floor_within_half_a_second() {
    let def = Arc::new(sinew::mannequin::character());
    for (depth, seed) in [0.15, 0.25, 0.4, 0.6, 0.8].into_iter().zip(0..) {
        let mut world = World::new(WorldDef::default());
        world.add_body(&BodyDef::fixed(Shape::HalfSpace));
        let turn = Rotation::from_axis_angle(Vec3::Y, Random::new(seed).range(0.0, 6.0));
        let mut character = limp_at(&mut world, &def, Transform::new(Vec3::Y * -depth, turn));
        let (step, speed) = out_of_it(&mut world, &mut character).expect("the body leaves the solid");
        assert!(
            step < HALF_SECOND && speed <= 2.5,
            "depth {depth} m: clear after {step} steps, fastest {speed} m/s"
        );
    }
}

#[test]
fn limp_character_leaves_a_wall_on_the_nearer_side() {
    let def = Arc::new(sinew::mannequin::character());
    for seed in 0..20 {
        let mut random = Random::new(seed);
        let mut world = world_with_wall();
        let (z, turn) = (random.range(-0.12, 0.12), random.range(0.0, 6.0));
        let place = Transform::new(Vec3::Z * z, Rotation::from_axis_angle(Vec3::Y, turn));
        let mut character = Character::spawn(&mut world, &def, place);
        character.update(&mut world);
        character.go_limp(&mut world);
        let (step, speed) = out_of_it(&mut world, &mut character).expect("the body leaves the solid");
        assert!(
            step < HALF_SECOND && speed <= 2.5,
            "seed {seed}: clear after {step} steps, fastest {speed} m/s"
        );
        let at = character.bodies().iter().map(|&body| world.transform(body).translation.z);
        let (low, high) =
            at.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), z| (min(low, z), max(high, z)));
        assert!(
            low > 0.1 || high < -0.1,
            "seed {seed}: the character is on both sides, from {low} to {high}"
        );
        // From the centre, both sides are equally near.
        assert!(
            z.abs() < 0.06 || (low > 0.0) == (z > 0.0),
            "seed {seed}: started at {z} m, now from {low} to {high}"
        );
    }
}

/// A moving limp character leaves on the side from which it came, and its velocity component into the wall is removed.
#[test]
fn moving_character_leaves_a_wall_on_its_entry_side() {
    let def = Arc::new(sinew::mannequin::character());
    for speed in [-3.0f32, 3.0] {
        let mut world = world_with_wall();
        let ahead = Transform::from_translation(Vec3::new(0.0, 0.0, 0.05 * speed.signum()));
        let mut character = limp_at(&mut world, &def, Transform::from_translation(Vec3::Z * 5.0));
        let by = ahead.translation - Vec3::Z * 5.0;
        for &body in character.bodies() {
            let pose = world.transform(body);
            world.set_transform(body, Transform { translation: pose.translation + by, ..pose });
            world.set_velocity(body, Velocity { linear: Vec3::Z * speed, ..Velocity::default() });
        }
        assert!(character.clear(&mut world) && !character.clear(&mut world));
        let (step, _) = out_of_it(&mut world, &mut character).expect("the body leaves the solid");
        let chest = world.transform(character.bodies()[0]).translation.z;
        assert!(
            step < HALF_SECOND && chest * speed < 0.0,
            "pushed at {speed} m/s: after {step} steps the chest is at {chest}"
        );
    }
}

/// A character is not moved out of shapes that its filter excludes.
#[test]
fn filtered_shapes_do_not_move_the_character() {
    let def = Arc::new(sinew::mannequin::character());
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let water = ShapeDef {
        filter: Filter { layers: 0x8000_0000, mask: 0x8000_0000, ..Filter::default() },
        ..ShapeDef::new(Shape::cuboid(Vec3::splat(0.5)))
    };
    world.add_body(&BodyDef::fixed(water).at(Vec3::Y * 0.5));
    let mut character = limp_at(&mut world, &def, Transform::IDENTITY);
    assert!(!character.clear(&mut world));
    assert!(character.bodies().iter().all(|&body| world.kind(body) == BodyKind::Dynamic));
}

/// A snapshot taken while the character is moved out continues identically, also after a limb is detached during this
/// time.
#[test]
fn snapshot_during_clearing_continues_identically() {
    let def = Arc::new(sinew::mannequin::character());
    let mut world = world_with_wall();
    let mut character = limp_at(&mut world, &def, Transform::from_translation(Vec3::new(0.0, -0.3, 0.02)));
    for _ in 0..5 {
        world.step();
        character.update(&mut world);
    }
    let mut bytes = Writer::new();
    world.save(&mut bytes);
    character.save(&mut bytes);
    let mut input = Reader::new(bytes.as_bytes());
    let mut other = World::new(WorldDef::default());
    other.load(&mut input).expect("the saved state is valid");
    let mut twin = Character::new(def, Transform::IDENTITY, 0.0);
    twin.load(&mut input).expect("the bytes are a snapshot");
    for step in 0..120 {
        for (world, character) in [(&mut world, &mut character), (&mut other, &mut twin)] {
            if step == 2 {
                character.detach(world, "leftUpperArm").expect("it has an arm");
            }
            world.step();
            character.update(world);
        }
        assert_eq!(world.hash(), other.hash(), "step {step}");
    }
    let own = (0..character.bodies().len()).filter(|&body| character.has_body(body));
    let statics: Vec<BodyId> = world.body_ids().filter(|&id| world.kind(id) == BodyKind::Static).collect();
    for body in own.map(|body| character.bodies()[body]) {
        assert!(statics.iter().all(|&other| world.overlap(body, other) < 0.02));
    }
}
