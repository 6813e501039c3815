//! Movers in worlds: the cabin, a house of triangles, pieces of a dungeon.

use crate::room::Room;
use sinew::formats::{TriangleMesh, load_mesh};
use sinew::math::trig::{cos, sin};
use sinew::math::{Random, Rotation, Transform, Vec3};
use sinew::physics::boxes::Aabb;
use sinew::physics::ray::Ray;
use sinew::physics::{
    BodyDef, Hull, MoverDef, MoverId, OverlapWith, PenetrationOf, Probe, Shape, World, WorldDef,
};
use sinew_scenes::cabin::Site;
use std::io::Write as _;
use std::path::Path;

const WORLDS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/worlds");

/// Number of random walks: a hundredth, but all with `SINEW_FULL` set.
fn walks(all: usize) -> usize {
    if std::env::var_os("SINEW_FULL").is_some() { all } else { all / 100 }
}

fn cabin() -> World {
    let mut world = World::new(WorldDef::default());
    for prop in Site::CabinWithStairs.props() {
        world.add_body(&prop.body);
    }
    world
}

/// A file's triangles, `scale` metres for each of its units; `None`, and a line that says so, if it is not there.
fn level(name: &str, scale: f32) -> Option<TriangleMesh> {
    let path = format!("{WORLDS}/{name}");
    if !Path::new(&path).is_file() {
        // Not println, which the harness swallows where a test passes.
        let _ = writeln!(std::io::stderr(), "movers in {name} skipped: no ../shared/data");
        return None;
    }
    let level = load_mesh(&path).expect("the file can be read");
    let positions = level.positions.iter().map(|&p| p * scale).collect();
    Some(TriangleMesh { positions, ..level })
}

fn bounds(level: &TriangleMesh) -> Aabb {
    let at = |p: Vec3| Aabb { min: p, max: p };
    level.positions.iter().map(|&p| at(p)).reduce(|a, b| a.merge(&b)).expect("it has corners")
}

fn with_floor(level: &TriangleMesh) -> World {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    world.add_body(&level.to_body().expect("it has triangles"));
    world
}

fn probe(def: &MoverDef, center: Vec3, margin: f32) -> Probe {
    let shape = Shape::Capsule { half_height: 0.5 * def.height - def.radius, radius: def.radius + margin };
    Probe { shape, world_from_shape: Transform::from_translation(center) }
}

fn depth(world: &World, id: MoverId) -> f32 {
    let mover = world.mover(id);
    let mut found = Vec::new();
    world.query().all(&PenetrationOf(probe(mover.def(), mover.center(), 0.0)), &mut found);
    found.first().map_or(0.0, |deepest| deepest.depth)
}

/// True if a point sees the outside of what is next to it in every direction: triangles are solid from there alone.
fn is_in_front(triangles: &[[Vec3; 3]], point: Vec3) -> bool {
    let mut random = Random::new(1);
    let mut direction = || random.rotation() * Vec3::X;
    (0..60).all(|_| {
        let way = direction();
        let meets = |&[a, b, c]: &[Vec3; 3]| {
            let (ab, ac, from) = (b - a, c - a, point - a);
            let across = way.cross(ac);
            let span = ab.dot(across);
            let u = from.dot(across) / span;
            let along = from.cross(ab);
            let (v, t) = (way.dot(along) / span, ac.dot(along) / span);
            (span != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some((t, span > 0.0))
        };
        let hits = triangles.iter().filter_map(meets);
        hits.min_by(|a, b| a.0.total_cmp(&b.0)).is_none_or(|(_, in_front)| in_front)
    })
}

fn corners(level: &TriangleMesh) -> Vec<[Vec3; 3]> {
    level.triangles.iter().map(|triangle| triangle.map(|corner| level.positions[corner as usize])).collect()
}

/// Lets a mover stand, and sends it to the farthest place to which there is room: the number of places, and where it is stuck. What slides off
/// a rim on the way looks around again from where it is then. `None`: it has no ground.
fn explore(world: &mut World, id: MoverId) -> Option<(usize, Result<(), String>)> {
    const TRIES: usize = 3;
    let (mut places, mut stuck) = (0, String::new());
    for _ in 0..TRIES {
        world.set_mover_walk(id, Vec3::ZERO);
        for _ in 0..60 {
            world.step();
        }
        if !world.mover(id).is_grounded() {
            break;
        }
        let room = Room::around(world, id);
        places = usize::max(places, room.len());
        match room.walk(world, id) {
            Ok(()) => return Some((places, Ok(()))),
            Err([to, from]) => stuck = format!("at {}, from {from} to {to}", world.mover(id).position()),
        }
    }
    (places > 0).then_some((places, Err(stuck)))
}

/// Random walks from free places within `within`, at up to 50 m/s every other time: never inside of anything, never through, and from
/// where one ends it gets to the farthest place to which a flood fill finds room.
fn wander(world: &mut World, triangles: &[[Vec3; 3]], within: &Aabb, seed: u64, count: usize) {
    let mut random = Random::new(seed);
    let mut deepest = 0.0_f32;
    let (mut floods, mut places, mut stuck) = (0, 0, Vec::new());
    for walk in 0..count {
        let def = loop {
            let mut between = |axis: usize| random.range(within.min[axis], within.max[axis]);
            let position = Vec3::new(between(0), between(1), between(2));
            let def = MoverDef { ground_acceleration: 300.0, ..MoverDef::at(position) };
            let center = position + Vec3::Y * 0.9;
            let is_free = !world.query().any(&OverlapWith(probe(&def, center, 0.02)));
            if is_free && is_in_front(triangles, center) {
                break def;
            }
        };
        let id = world.add_mover(&def);
        let fast = if walk % 2 == 0 { 5.0 } else { 50.0 };
        for step in 0..120 {
            if step % 20 == 0 {
                let (angle, speed) = (random.range(0.0, 6.3), random.range(0.0, fast));
                world.set_mover_walk(id, Vec3::new(cos(angle), 0.0, sin(angle)) * speed);
            }
            let before = world.mover(id).center();
            world.step();
            let now = world.mover(id).center();
            let deep = depth(world, id);
            deepest = if deep > deepest { deep } else { deepest };
            assert!(deep < 1e-3, "walk {walk}: {deep} m inside at {now}");
            assert!(now.y > 0.89, "walk {walk}: under the ground at {now}");
            let blocked = |from: Vec3| world.query().any(&Ray { origin: from, direction: now - from });
            let through =
                (now - before).length() > 0.25 && blocked(before) && blocked(before + Vec3::Y * 0.4);
            assert!(!through, "walk {walk}: through something from {before} to {now}");
        }
        if let Some((room, result)) = explore(world, id) {
            (floods, places) = (floods + 1, places + room);
            stuck.extend(result.err().map(|place| format!("walk {walk}: {place}")));
        }
        world.remove_mover(id);
    }
    println!(
        "deepest {deepest} m in {count} walks; {floods} floods of {} places",
        places / usize::max(floods, 1)
    );
    assert!(floods > count / 2 && places > 20 * floods, "{floods} floods, {places} places");
    assert!(stuck.is_empty(), "{} of {floods} stuck: {stuck:#?}", stuck.len());
}

#[test]
fn walks_in_and_around_the_cabin() {
    let within = Aabb { min: Vec3::new(-4.0, 0.05, -8.0), max: Vec3::new(4.0, 3.0, 4.0) };
    wander(&mut cabin(), &[], &within, 1, walks(3_000));
}

#[test]
fn walks_in_the_house() {
    let Some(house) = level("house_2story_stairs.glb", 3.0) else { return };
    let mut within = bounds(&house);
    within.min.y = 0.05;
    wander(&mut with_floor(&house), &corners(&house), &within, 2, walks(2_500));
}

#[test]
fn walks_in_the_dungeon() {
    let (Some(stairs), Some(wall)) =
        (level("kaykit_dungeon/stairs.obj", 1.0), level("kaykit_dungeon/wall.obj", 1.0))
    else {
        return;
    };
    let mut world = with_floor(&stairs);
    let mut triangles = corners(&stairs);
    for (turn, x, z) in [(0.0, 0.0, -5.0), (0.0, 3.0, 5.0), (1.6, -4.0, 0.0), (0.7, 4.0, 1.0)] {
        let mut body = wall.to_body().expect("it has triangles");
        body.position = Vec3::new(x, 0.0, z);
        body.rotation = Rotation::from_axis_angle(Vec3::Y, turn);
        let placed = |corner: Vec3| body.rotation * corner + body.position;
        triangles.extend(corners(&wall).into_iter().map(|triangle| triangle.map(placed)));
        world.add_body(&body);
    }
    let within = Aabb { min: Vec3::new(-6.0, 0.05, -6.0), max: Vec3::new(6.0, 3.0, 6.0) };
    wander(&mut world, &triangles, &within, 3, walks(2_500));
}

/// Solids, turned at random, half in the floor or in the air, within four walls.
fn clutter(random: &mut Random) -> World {
    const HALF: f32 = 6.0;
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    for (x, z) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
        let along = |share: f32| if share == 0.0 { HALF + 1.0 } else { 0.5 };
        let half_extents = Vec3::new(along(x), 4.0, along(z));
        let at = Vec3::new(x, 0.0, z) * (HALF + 0.5);
        world.add_body(&BodyDef::fixed(Shape::Box { half_extents }).at(at));
    }
    for kind in 0..40 {
        let size = random.range(0.1, 1.2);
        let mut length = || size * random.range(0.2, 1.0);
        let (a, b, c) = (length(), length(), length());
        let shape = match kind % 4 {
            0 => Shape::Box { half_extents: Vec3::new(a, b, c) },
            1 => Shape::Cylinder { half_height: a, radius: b },
            2 => Shape::Capsule { half_height: a, radius: b },
            _ => {
                let points: Vec<Vec3> = (0..12).map(|_| (random.rotation() * Vec3::X) * size).collect();
                Shape::Hull(Hull::new(&points).expect("random points span a solid").into())
            }
        };
        let mut place = || random.range(-HALF, HALF);
        let (x, z) = (place(), place());
        let mut def = BodyDef::fixed(shape).at(Vec3::new(x, random.range(0.0, 1.5), z));
        def.rotation = random.rotation();
        world.add_body(&def);
    }
    world
}

#[test]
fn walks_in_clutter() {
    let within = Aabb { min: Vec3::new(-5.5, 0.05, -5.5), max: Vec3::new(5.5, 2.5, 5.5) };
    let mut random = Random::new(4);
    for seed in 0..walks(2_000) as u64 / 20 {
        wander(&mut clutter(&mut random), &[], &within, 100 + seed, 20);
    }
}

/// Out of the door, down the stairs, and back up, at speeds from a stroll to a sprint.
#[test]
fn the_cabins_stairs_down_and_up_without_leaving_the_ground() {
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
                assert!(mover.is_grounded(), "{speed} m/s: off the ground at {}", mover.position());
                assert!(world.step_count() < 2_000, "{speed} m/s: it stays at {}", mover.position());
                assert_eq!(depth(&world, id), 0.0);
            }
            let height = world.mover(id).position().y;
            let expected = if way > 0.0 { 0.0 } else { start.y };
            assert!((height - expected).abs() < 0.02, "{speed} m/s: {height} m high");
        }
    }
}

/// The steps of the dungeon: triangles.
#[test]
fn the_dungeons_stairs_are_climbed() {
    let Some(stairs) = level("kaykit_dungeon/stairs.obj", 1.0) else { return };
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
    // The landing is 4 m high, its walls go on above that.
    assert!((highest - 4.0).abs() < 0.02, "it came up to {highest} m");
}
