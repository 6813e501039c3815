//! Bodies in flight are integrated eight at a time. They move like single bodies, and like bodies solved as islands.

use crate::build::box_body;
use sinew_math::{Random, Transform, Vec3};
use sinew_physics::*;

/// Adds a spinning box with index `i`. Boxes of different indices never meet.
fn spinning(world: &mut World, i: u32) -> BodyId {
    let mut random = Random::new(u64::from(i) + 1);
    let extents = Vec3::new(random.range(0.1, 0.2), random.range(0.2, 0.4), random.range(0.4, 0.8));
    let mut def = box_body(extents, Vec3::new(10.0 * i as f32, 50.0, 0.0));
    (def.linear_velocity, def.angular_velocity) = (random.direction() * 5.0, random.direction() * 12.0);
    (def.linear_damping, def.angular_damping) = (random.range(0.0, 0.2), random.range(0.0, 0.2));
    world.add_body(&def)
}

fn flown(world: &mut World, id: BodyId, steps: usize) -> (Transform, Velocity) {
    for _ in 0..steps {
        world.step();
    }
    (world.transform(id), world.velocity(id))
}

#[test]
fn flying_body_has_the_same_bits_alone_and_in_a_crowd() {
    for i in [0, 7, 11, 18] {
        let mut crowd = World::new(WorldDef::default());
        let ids: Vec<_> = (0..19).map(|i| spinning(&mut crowd, i)).collect();
        let mut alone = World::new(WorldDef::default());
        let only = spinning(&mut alone, i);
        assert_eq!(flown(&mut crowd, ids[i as usize], 60), flown(&mut alone, only, 60), "body {i}");
    }
}

#[test]
fn flight_matches_islands() {
    // A gravity field makes the step solve bodies as islands.
    let field = FieldKind::Uniform(UniformGravity { acceleration: WorldDef::default().gravity });
    for i in 0..8 {
        let mut free = World::new(WorldDef::default());
        let mut fielded = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        fielded.add_field(&FieldDef::new(field));
        let [(pose, v), (expected, w)] = [&mut free, &mut fielded].map(|world| {
            let id = spinning(world, i);
            world.apply_torque(id, Vec3::X);
            flown(world, id, 60)
        });
        assert!(
            (pose.translation - expected.translation).length() < 1e-4,
            "body {i}: pose {pose:?}, expected {expected:?}"
        );
        assert!(
            pose.rotation.dot(expected.rotation).abs() > 1.0 - 1e-6,
            "body {i}: pose {pose:?}, expected {expected:?}"
        );
        assert!((v.linear - w.linear).length() < 1e-4, "body {i}: velocity {v:?}, expected {w:?}");
        assert!((v.angular - w.angular).length() < 2e-3, "body {i}: velocity {v:?}, expected {w:?}");
    }
}

#[test]
fn spin_and_speed_stay_within_the_worlds_limits() {
    let mut world =
        World::new(WorldDef { gravity: Vec3::ZERO, max_speed: 20.0, max_turn: 0.1, ..WorldDef::default() });
    let mut def = box_body(Vec3::new(0.1, 0.2, 0.3), Vec3::ZERO);
    (def.linear_velocity, def.angular_velocity) = (Vec3::X * 1e4, Vec3::new(1e3, 1.0, 1e3));
    let id = world.add_body(&def);
    for _ in 0..10 {
        world.step();
        let v = world.velocity(id);
        assert!((v.linear.length() - 20.0).abs() < 1e-3, "the velocity exceeds the world's limits: {v:?}");
        // At most 0.1 rad in each of 240 substeps per second; the spin of a tumbling body changes with its moments.
        assert!(
            v.angular.is_finite() && v.angular.length() < 3.0 * 24.0,
            "the velocity exceeds the world's limits: {v:?}"
        );
    }
}
