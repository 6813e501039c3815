//! Movers in worlds: the cabin, a house of triangles, pieces of a dungeon.

use needs_data::needs_data;
use sinew::formats::{TriangleMesh, load_mesh};
use sinew::math::trig::{cos, sin};
use sinew::math::{Random, Transform, Vec3};
use sinew::physics::boxes::Aabb;
use sinew::physics::{BodyDef, MoverDef, MoverId, PenetrationOf, Probe, Shape, World, WorldDef};
use sinew_scenes::cabin::Site;
use sinew_scenes::walks::{Ours, Tally, Terrain};

const WORLDS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/worlds");

/// Number of walks per seed.
const SHARE: usize = 20;

/// Seeds of `all` random walks, `SHARE` walks each: the first seed, all with `SINEW_FULL=1` set, or with
/// `SINEW_FULL=k/n` the k-th of n parts.
fn seeds(all: usize) -> impl Iterator<Item = u64> {
    let all = (all / SHARE) as u64;
    let part = std::env::var("SINEW_FULL").ok();
    let (part, parts) = part.as_deref().map_or((0, all), |part| {
        let (k, n) = part.split_once('/').unwrap_or(("1", "1"));
        let number = |digits: &str| digits.parse::<u64>().expect("SINEW_FULL must be 1 or k/n");
        (number(k) - 1, number(n))
    });
    (0..all).filter(move |seed| seed % parts == part)
}

fn cabin() -> World {
    let mut world = World::new(WorldDef::default());
    for prop in Site::CabinWithStairs.props() {
        world.add_body(&prop.body);
    }
    world
}

/// A file's triangles, `scale` metres for each of its units, for tests with `needs_data`.
fn level(name: &str, scale: f32) -> TriangleMesh {
    let path = format!("{WORLDS}/{name}");
    let level = load_mesh(&path).expect("the file can be read");
    let positions = level.positions.iter().map(|&p| p * scale).collect();
    TriangleMesh { positions, ..level }
}

fn bounds(level: &TriangleMesh) -> Aabb {
    let at = |p: Vec3| Aabb { min: p, max: p };
    level.positions.iter().map(|&p| at(p)).reduce(|a, b| a.merge(&b)).expect("the mesh has corners")
}

fn with_floor(level: &TriangleMesh) -> World {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    world.add_body(&level.to_body().expect("the mesh has triangles"));
    world
}

fn depth(world: &World, id: MoverId) -> f32 {
    let mover = world.mover(id);
    let shape = Shape::Capsule { half_height: mover.half_height(), radius: mover.def().radius };
    let probe = Probe { shape, world_from_shape: Transform::from_translation(mover.center()) };
    let mut found = Vec::new();
    world.query().all(&PenetrationOf(probe), &mut found);
    found.first().map_or(0.0, |deepest| deepest.depth)
}

/// Runs `SHARE` walks for each seed on the ground of that seed. Checks that no walk goes into or through a body, that
/// the mover then reaches the farthest position that a flood fill finds, and that flood fills find at least `places`
/// positions on average.
fn wander(name: &str, all: usize, places: usize, ground: impl Fn(u64) -> Terrain) {
    let mut tally = Tally::default();
    for seed in seeds(all) {
        let terrain = ground(seed);
        let mut random = Random::new(seed);
        let mut world = terrain.build();
        for walk in 0..SHARE {
            let mut walker = Ours::new(world, terrain.free_place(&mut random));
            let fast = if walk % 2 == 0 { 5.0 } else { 50.0 };
            tally.walk(&terrain, &mut walker, &format!("seed {seed}, walk {walk}"), fast, &mut random);
            world = walker.leave();
        }
    }
    let Tally { walks, deepest, floods, ref wrong, .. } = tally;
    let mean = tally.places / usize::max(floods, 1);
    println!(
        "{name}: deepest {deepest} m in {walks} walks, {floods} flood fills of {mean} positions on average, {} faults",
        wrong.len()
    );
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(deepest < 1e-3, "a mover was {deepest} m inside a body");
    assert!(floods > walks / 2 && mean >= places, "{floods} floods reach {mean} cells on average");
}

#[test]
fn walks_in_and_around_the_cabin() {
    wander("cabin", 3_000, 50, |_| Terrain::cabin());
}

#[needs_data]
#[test]
fn walks_in_the_house() {
    let house = level("house_2story_stairs.glb", 3.0);
    wander("house", 2_500, 50, |_| Terrain::house(&house));
}

#[needs_data]
#[test]
fn walks_in_the_dungeon() {
    let (stairs, wall) = (level("kaykit_dungeon/stairs.obj", 1.0), level("kaykit_dungeon/wall.obj", 1.0));
    wander("dungeon", 2_500, 50, |_| Terrain::dungeon(&stairs, &wall));
}

#[test]
fn walks_in_clutter() {
    wander("clutter", 2_000, 50, Terrain::clutter);
}

/// The mover walks out of the door, down the stairs, and back up, at 1 to 6 m/s.
#[test]
fn mover_walks_the_cabins_stairs_down_and_up_on_the_ground() {
    for speed in [1.0, 2.0, 3.5, 6.0] {
        let mut world = cabin();
        let start = Site::CabinWithStairs.spawn().world_from_character.translation;
        let id = world.add_mover(&MoverDef { radius: 0.25, ..MoverDef::at(start) });
        for _ in 0..30 {
            world.step();
        }
        for (way, end) in [(1.0, 4.0), (-1.0, start.z)] {
            world.set_mover_walk(id, Vec3::Z * (way * speed));
            while (world.mover(id).position().z - end) * way < 0.0 {
                world.step();
                let mover = world.mover(id);
                assert!(mover.is_grounded(), "{speed} m/s: not grounded at {}", mover.position());
                assert!(world.step_count() < 2_000, "{speed} m/s: stuck at {}", mover.position());
                assert_eq!(depth(&world, id), 0.0);
            }
            let height = world.mover(id).position().y;
            let expected = if way > 0.0 { 0.0 } else { start.y };
            assert!((height - expected).abs() < 0.02, "{speed} m/s: at a height of {height} m");
        }
    }
}

/// The steps of the dungeon are triangles.
#[needs_data]
#[test]
fn mover_climbs_the_dungeons_stairs() {
    let stairs = level("kaykit_dungeon/stairs.obj", 1.0);
    let size = bounds(&stairs);
    let mut highest = 0.0_f32;
    for turn in 0..4_u8 {
        let mut world = with_floor(&stairs);
        let angle = f32::from(turn) * core::f32::consts::FRAC_PI_2;
        let way = Vec3::new(cos(angle), 0.0, sin(angle));
        let center = (size.min + size.max) * 0.5;
        let from = Vec3::new(center.x, 0.01, center.z) - way * (0.5 * (size.max - size.min).length() + 1.0);
        let id = world.add_mover(&MoverDef { step_height: 0.55, ..MoverDef::at(from) });
        for _ in 0..30 {
            world.step();
        }
        world.set_mover_walk(id, way * 3.0);
        for _ in 0..200 {
            world.step();
            assert!(depth(&world, id) < 1e-3);
            let height = world.mover(id).position().y;
            highest = if height > highest { height } else { highest };
        }
    }
    // The landing is 4 m high; its walls continue above.
    assert!((highest - 4.0).abs() < 0.02, "the mover reached {highest} m");
}
