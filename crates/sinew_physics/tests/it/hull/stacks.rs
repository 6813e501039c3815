//! Hulls in worlds: stacks of every size stand and sleep, and a hull of a box's corners acts like the box.

use super::{box_hull, pebble};
use crate::build::{box_body, capsule_body, floor, sphere_body};
use sinew_math::{Random, Vec3};
use sinew_physics::*;

/// Stacks five cubes of half size `half` on the floor. Returns how far they sank and moved in 3 s, as shares of their
/// size, and how many of them sleep.
fn stack(shape: &Shape, half: f32) -> (f32, f32, usize) {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let ids: Vec<BodyId> = (0..5)
        .map(|k| {
            let position = Vec3::Y * (half * (2 * k + 1) as f32);
            world.add_body(&BodyDef {
                position,
                shapes: vec![ShapeDef::new(shape.clone())],
                ..BodyDef::default()
            })
        })
        .collect();
    (0..240).for_each(|_| world.step());
    let (mut sunk, mut drift): (f32, f32) = (0.0, 0.0);
    for (k, &id) in ids.iter().enumerate() {
        let offset = world.transform(id).translation - Vec3::Y * (half * (2 * k + 1) as f32);
        sunk = sunk.max(-offset.y / half);
        drift = drift.max(Vec3::new(offset.x, 0.0, offset.z).length() / half);
    }
    (sunk, drift, ids.iter().filter(|&&id| !world.is_awake(id)).count())
}

/// Collision margins scale with the shape, so small cubes stand like large ones.
#[test]
fn stacks_of_cubes_stand_at_every_size() {
    for half in [0.01, 0.1, 1.0] {
        for shape in [Shape::Box { half_extents: Vec3::splat(half) }, box_hull(Vec3::splat(half))] {
            let (sunk, drift, asleep) = stack(&shape, half);
            println!("{half}: sunk {sunk}, drift {drift}, {asleep} asleep");
            assert!(sunk < 0.08, "half side {half}: sunk by {sunk} half sides");
            assert!(drift < 0.02, "half side {half}: moved by {drift} half sides");
            assert_eq!(asleep, 5, "half side {half}: all cubes must sleep");
        }
    }
}

/// Pebbles thrown on the floor and on each other come to rest above it.
#[test]
fn a_heap_comes_to_rest() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let mut random = Random::new(17);
    let ids: Vec<BodyId> = (0..10)
        .map(|k| {
            let shapes = vec![ShapeDef::new(pebble(0.15, &mut random))];
            let position = random.in_cube() * 0.1 + Vec3::Y * (0.3 + 0.3 * k as f32);
            world.add_body(&BodyDef {
                position,
                shapes,
                angular_velocity: random.in_cube(),
                ..BodyDef::default()
            })
        })
        .collect();
    (0..600).for_each(|_| world.step());
    for &id in &ids {
        assert!(world.penetration(id) < 0.006, "a pebble is {} m deep", world.penetration(id));
        assert!(world.velocity(id).linear.length() < 0.05, "a pebble moves at {:?}", world.velocity(id));
        let center = world.center_of_mass(id);
        assert!(center.y > 0.03 && center.length() < 3.0, "a pebble is at {center}");
    }
}

/// A warm step with hulls against each other and against all other shapes allocates nothing.
#[test]
fn a_warm_step_allocates_nothing() {
    let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
    floor(&mut world);
    let mut random = Random::new(21);
    for k in 0..12 {
        let position = random.in_cube() * 0.1 + Vec3::Y * (0.2 + 0.25 * k as f32);
        world.add_body(&match k % 6 {
            0 => box_body(Vec3::splat(0.1), position),
            1 => sphere_body(0.1, position),
            2 => capsule_body(0.1, 0.07, position),
            _ => BodyDef {
                position,
                shapes: vec![ShapeDef::new(pebble(0.12, &mut random))],
                ..BodyDef::default()
            },
        });
    }
    (0..300).for_each(|_| world.step());
    let seen = allocation_counter::measure(|| (0..30).for_each(|_| world.step()));
    assert_eq!(seen.count_total, 0);
}
