//! Contact events that are easily lost or reported twice: those of sleeping, bouncing and slowly rolling bodies, and of
//! bodies on many triangles.

use crate::build::{box_body, floor, sphere_body};
use sinew_math::{Reader, Rotation, Transform, Vec3, Writer};
use sinew_physics::*;
use std::sync::Arc;

type Pair = (BodyId, BodyId);

/// Events of several steps, added up.
#[derive(Debug, Default)]
struct Seen {
    begin: Vec<Pair>,
    end: Vec<Pair>,
    shapes_begin: usize,
    shapes_end: usize,
    hits: usize,
}

fn run(world: &mut World, steps: usize) -> Seen {
    let mut seen = Seen::default();
    for _ in 0..steps {
        world.step();
        let events = world.events();
        seen.begin.extend_from_slice(&events.begin);
        seen.end.extend_from_slice(&events.end);
        seen.shapes_begin += events.shapes_begin.len();
        seen.shapes_end += events.shapes_end.len();
        seen.hits += events.hits.len();
    }
    seen
}

fn reloaded(world: &World) -> World {
    let mut w = Writer::new();
    world.save(&mut w);
    let mut other = World::new(WorldDef::default());
    other.load(&mut Reader::new(w.as_bytes())).expect("the snapshot must load");
    other
}

/// Returns a world with a crate asleep on a floor, within a sensor.
fn nap() -> (World, BodyId, BodyId, BodyId) {
    let mut world = World::new(WorldDef::default());
    let floor = floor(&mut world);
    let mut zone = box_body(Vec3::splat(0.5), Vec3::ZERO);
    (zone.kind, zone.shapes[0].sensing) = (BodyKind::Static, Sensing::Sensor);
    let zone = world.add_body(&zone);
    let sleeper = world.add_body(&box_body(Vec3::splat(0.2), Vec3::Y * 0.2));
    let seen = run(&mut world, 120);
    assert_eq!((&seen.begin[..], seen.end.len()), (&[(floor, sleeper)][..], 0));
    assert!(!world.is_awake(sleeper));
    (world, floor, zone, sleeper)
}

#[test]
fn removing_a_sleeping_body_ends_its_touches() {
    let ways: [fn(&mut World, BodyId); 4] = [
        |world, sleeper| world.set_transform(sleeper, Transform::from_translation(Vec3::Y * 9.0)),
        |world, sleeper| world.remove_body(sleeper),
        |world, sleeper| {
            world.wake(sleeper);
            world.remove_body(sleeper);
        },
        |world, sleeper| {
            let shape = world.shape_ids(sleeper).next().expect("the body has a shape");
            world.set_filter(shape, Filter { mask: 0, ..Filter::default() });
        },
    ];
    for (way, take_away) in ways.into_iter().enumerate() {
        let (mut world, floor, zone, sleeper) = nap();
        take_away(&mut world, sleeper);
        let mut other = reloaded(&world);
        for world in [&mut world, &mut other] {
            world.step();
            let events = world.events();
            assert_eq!(events.end, [(floor, sleeper)], "way {way}");
            assert_eq!(events.sensor_end, [(zone, sleeper)], "way {way}");
            assert_eq!((events.shapes_end.len(), events.sensor_shapes_end.len()), (1, 1));
            let rest = run(world, 5);
            assert!(rest.end.is_empty() && rest.begin.is_empty(), "way {way}: {rest:?}");
        }
        assert_eq!(world.hash(), other.hash(), "way {way}");
    }
}

#[test]
fn disabling_an_untouched_pair_wakes_nothing() {
    let (mut world, floor, zone, sleeper) = nap();
    let other = world.add_body(&box_body(Vec3::splat(0.2), Vec3::new(3.0, 0.2, 0.0)));
    run(&mut world, 120);
    world.disable_pair(sleeper, other);
    world.step();
    assert!(!world.is_awake(sleeper) && !world.is_awake(other));
    world.disable_pair(zone, sleeper);
    world.step();
    assert_eq!(world.events().sensor_end, [(zone, sleeper)]);
    world.disable_pair(sleeper, floor);
    world.step();
    assert_eq!(world.events().end, [(floor, sleeper)]);
    assert!(world.is_awake(sleeper) && !world.is_awake(other));
}

#[test]
fn slow_and_bouncing_contacts_are_reported() {
    // On the floor at 5 cm/s, and at 1.5 to 20 m/s with high restitution.
    for (speed, restitution) in [(0.05, 0.0), (1.5, 0.9), (5.0, 0.9), (20.0, 1.0)] {
        let def = WorldDef { sleeping: Sleeping::Off, gravity: Vec3::ZERO, ..WorldDef::default() };
        let mut world = World::new(def);
        let floor = floor(&mut world);
        let mut ball = sphere_body(0.1, Vec3::Y * (0.1 + 0.31 * speed));
        ball.linear_velocity = Vec3::Y * -speed;
        ball.shapes[0].material.restitution = restitution;
        let ball = world.add_body(&ball);
        let seen = run(&mut world, 60);
        assert_eq!(seen.begin, [(floor, ball)], "{speed} m/s");
        assert_eq!(seen.shapes_begin, 1);
        assert_eq!(seen.end.len(), usize::from(restitution > 0.0), "{speed} m/s");
        assert_eq!(seen.hits, usize::from(speed >= 1.0), "{speed} m/s");
    }
}

#[test]
fn ball_that_rolls_over_slabs_touches_each_once() {
    let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
    let slab = |i: usize| BodyDef {
        kind: BodyKind::Static,
        ..box_body(Vec3::new(0.5, 0.5, 0.5), Vec3::new(i as f32, -0.5, 0.0))
    };
    let slabs: Vec<BodyId> = (0..5).map(|i| world.add_body(&slab(i))).collect();
    let mut ball = sphere_body(0.2, Vec3::Y * 0.2);
    (ball.linear_velocity, ball.angular_velocity) = (Vec3::X * 0.5, Vec3::Z * -2.5);
    let ball = world.add_body(&ball);
    let seen = run(&mut world, 510);
    let expected: Vec<Pair> = slabs.iter().map(|&slab| (slab, ball)).collect();
    assert_eq!(seen.begin, expected);
    assert_eq!(seen.end, expected[..4]);
}

/// Returns a trench of two slopes of many triangles. Steps at its end rotate the normals from tile to tile.
fn trench() -> Shape {
    let (length, width) = (40, 3);
    let vertex = |i: usize, j: usize| {
        let across = (j as f32 - width as f32) * 0.1;
        Vec3::new(i as f32 * 0.1, across.abs() + 0.01 * (i % 2) as f32, across)
    };
    let index = |i: usize, j: usize| (i * (2 * width + 1) + j) as u32;
    let vertices: Vec<Vec3> = (0..=length).flat_map(|i| (0..=2 * width).map(move |j| vertex(i, j))).collect();
    let mut triangles = Vec::new();
    for (i, j) in (0..length).flat_map(|i| (0..2 * width).map(move |j| (i, j))) {
        let [a, b, c, d] = [index(i, j), index(i, j + 1), index(i + 1, j + 1), index(i + 1, j)];
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    Shape::Mesh(Arc::new(Mesh::new(&vertices, &triangles).expect("the mesh is valid")))
}

#[test]
fn contact_with_many_triangles_begins_once_and_hits_once() {
    let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
    let mut def = BodyDef { kind: BodyKind::Static, shapes: vec![trench().into()], ..BodyDef::default() };
    def.shapes[0].material.friction = 0.05;
    let trench = world.add_body(&def);
    let mut block = box_body(Vec3::new(0.15, 0.1, 0.1), Vec3::new(0.4, 0.8, 0.0));
    block.rotation = Rotation::from_axis_angle(Vec3::X, core::f32::consts::FRAC_PI_4);
    block.shapes[0].material.friction = 0.05;
    let block = world.add_body(&block);
    let seen = run(&mut world, 60);
    assert_eq!(
        (&seen.begin[..], seen.end.len()),
        (&[(trench, block)][..], 0),
        "the block must fall into the trench and touch it once"
    );
    assert_eq!((seen.shapes_begin, seen.shapes_end, seen.hits), (1, 0, 1));
    let parts = world.contacts_of(block).count();
    assert!(parts > 1, "the block must touch several triangles; it touches {parts}");
    // Both slopes carry the block while it slides; from tile to tile they rise and fall by 10 mm.
    let lying = world.transform(block).translation.y;
    run(&mut world, 300);
    let lies = world.transform(block).translation.y;
    assert!((lies - lying).abs() < 3e-3, "height {lying} m at rest before, {lies} m after");
    world.set_velocity(block, Velocity { linear: Vec3::X * 1.0, ..Velocity::default() });
    let seen = run(&mut world, 30);
    assert!(
        seen.begin.is_empty() && seen.end.is_empty(),
        "sliding from tile to tile must not begin or end contacts: {seen:?}"
    );
    world.set_transform(block, Transform::from_translation(Vec3::Y * 5.0));
    let seen = run(&mut world, 2);
    assert_eq!((&seen.end[..], seen.shapes_end), (&[(trench, block)][..], 1));
}
