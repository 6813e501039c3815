//! Random walks among random convex solids: movers are never inside a solid, never pass through one, and never get
//! stuck where there is room.

use super::{cases, depth};
use sinew_math::trig::{cos, sin};
use sinew_math::{Random, Transform, Vec3};
use sinew_physics::ray::Ray;
use sinew_physics::*;

/// Distance of the walls around the clutter from its centre, metres.
const ROOM: f32 = 12.0;

/// Returns a world with boxes, balls, capsules, cylinders, cones and hulls, rotated at random, on a floor and within
/// four walls.
fn clutter(random: &mut Random) -> World {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    for (x, z) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
        let half_extents = Vec3::new(
            ROOM + 1.0 - (ROOM + 0.75) * f32::abs(x),
            20.0,
            ROOM + 1.0 - (ROOM + 0.75) * f32::abs(z),
        );
        world.add_body(&BodyDef::fixed(Shape::Box { half_extents }).at(Vec3::new(x, 0.0, z) * (ROOM + 0.25)));
    }
    for _ in 0..60 {
        let size = random.range(0.1, 1.5);
        let mut length = || size * random.range(0.2, 1.0);
        let (a, b, c) = (length(), length(), length());
        let shape = match (random.unit() * 5.999) as u32 {
            0 => Shape::Box { half_extents: Vec3::new(a, b, c) },
            1 => Shape::Sphere { radius: a },
            2 => Shape::Capsule { half_height: a, radius: b },
            3 => Shape::Cylinder { half_height: a, radius: b },
            4 => Shape::Cone { half_height: a, radius: b },
            _ => Shape::Hull(hull(random, size).into()),
        };
        let at = Vec3::new(random.range(-ROOM, ROOM), random.range(0.0, 1.5), random.range(-ROOM, ROOM));
        let mut def = BodyDef::fixed(shape).at(at);
        def.rotation = random.rotation();
        world.add_body(&def);
    }
    world
}

fn hull(random: &mut Random, size: f32) -> Hull {
    let mut axis = || random.range(-size, size);
    let points: Vec<Vec3> = (0..12).map(|_| Vec3::new(axis(), axis(), axis())).collect();
    Hull::new(&points).expect("random points span a solid")
}

fn is_free(world: &World, def: &MoverDef) -> bool {
    let shape =
        Shape::Capsule { half_height: 0.5 * def.height - def.radius, radius: def.radius + 2.0 * def.skin };
    let world_from_shape = Transform::from_translation(def.position + Vec3::Y * (0.5 * def.height));
    !world.query().any(&OverlapWith(Probe { shape, world_from_shape }))
}

fn free_place(world: &World, random: &mut Random, def: &MoverDef) -> MoverDef {
    loop {
        let within = ROOM - 1.0;
        let position =
            Vec3::new(random.range(-within, within), random.range(0.02, 3.0), random.range(-within, within));
        let def = MoverDef { position, ..def.clone() };
        if is_free(world, &def) {
            return def;
        }
    }
}

/// Each walk takes 90 steps at up to 50 m/s and turns sometimes. After each step the test checks that the capsule
/// overlaps nothing, and that a ray from its last centre to the new one hits nothing.
#[test]
fn random_walks_in_clutter_never_enter_or_cross_a_solid() {
    let mut random = Random::new(11);
    let (walks, each) = (cases(300, 10_000), 20);
    let mut deepest = 0.0_f32;
    for _ in 0..walks / each {
        let mut world = clutter(&mut random);
        for walk in 0..each {
            let fast = if walk % 2 == 0 { 50.0 } else { 6.0 };
            let free =
                MoverDef { ground_acceleration: 500.0, air_acceleration: 200.0, ..MoverDef::default() };
            let id = world.add_mover(&free_place(&world, &mut random, &free));
            for step in 0..90 {
                if step % 15 == 0 {
                    let (angle, speed) = (random.range(0.0, 6.3), random.range(0.0, fast));
                    world.set_mover_walk(id, Vec3::new(cos(angle), 0.0, sin(angle)) * speed);
                    world.mover_jump(id, random.range(0.0, 6.0));
                }
                let before = world.mover(id).center();
                world.step();
                let now = world.mover(id).center();
                let deep = depth(&world, id);
                deepest = if deep > deepest { deep } else { deepest };
                assert!(deep < 1e-4, "{deep} m inside an obstacle at {now}");
                assert!(
                    now.x.abs() < ROOM && now.z.abs() < ROOM && now.y > 0.89,
                    "the mover left the room; it is at {now}"
                );
                // A mover that steps up passes over a corner: first upward, then along its way.
                let over = before + Vec3::Y * 0.4;
                let along = |from: Vec3| world.query().any(&Ray { origin: from, direction: now - from });
                let slides = (now - before).length() < 0.25;
                assert!(
                    slides || !along(before) || !along(over),
                    "the mover passed through a wall from {before} to {now}"
                );
            }
            world.remove_mover(id);
        }
    }
    println!("deepest {deepest} m");
}

/// A mover can move on wherever a capsule of its size, including its skin, fits 10 cm further at the same height or
/// slightly lower, if the mover is steered there.
#[test]
fn movers_are_never_stuck_where_there_is_room() {
    let mut random = Random::new(12);
    let mut stuck = 0;
    let mut tried = 0;
    for _ in 0..cases(15, 500) {
        let mut world = clutter(&mut random);
        for _ in 0..10 {
            let id = world.add_mover(&free_place(&world, &mut random, &MoverDef::default()));
            let angle = random.range(0.0, 6.3);
            let way = Vec3::new(cos(angle), 0.0, sin(angle));
            world.set_mover_walk(id, way * 3.0);
            for _ in 0..120 {
                world.step();
            }
            if world.mover(id).is_grounded() {
                let from = world.mover(id).position();
                for turn in 0..16 {
                    let angle = turn as f32 * core::f32::consts::TAU / 16.0;
                    let way = Vec3::new(cos(angle), 0.0, sin(angle));
                    let there = |far: f32| MoverDef::at(from + way * far + Vec3::Y * 0.012);
                    if !(1..=10).all(|i| is_free(&world, &there(0.01 * i as f32))) {
                        continue;
                    }
                    tried += 1;
                    world.set_mover_position(id, from);
                    world.set_mover_walk(id, way * 3.0);
                    for _ in 0..12 {
                        world.step();
                    }
                    if (world.mover(id).position() - from).dot(way) < 0.09 {
                        println!("stuck on the way from {from} toward {way}: {}", world.mover(id).position());
                        stuck += 1;
                    }
                }
            }
            world.remove_mover(id);
        }
    }
    assert!(tried > 100, "only {tried} paths were free");
    assert_eq!(stuck, 0, "movers got stuck on {stuck} of {tried} free paths");
}
