//! Movers on platforms, belts, one-way floors and other movers.

use super::{block, depth, level, settle};
use sinew_math::{Random, Vec3};
use sinew_physics::*;

fn platform(world: &mut World, half_extents: Vec3, at: Vec3, linear: Vec3, angular: Vec3) -> BodyId {
    let mut def = BodyDef::fixed(Shape::Box { half_extents }).at(at);
    def.kind = BodyKind::Kinematic;
    let id = world.add_body(&def);
    world.set_velocity(id, Velocity { linear, angular });
    id
}

/// The lift moves up and down by 4 m for 20 s.
#[test]
fn a_lift_carries_a_mover() {
    let mut world = level();
    let lift = platform(&mut world, Vec3::new(2.0, 0.1, 2.0), Vec3::Y * 0.4, Vec3::ZERO, Vec3::ZERO);
    let id = world.add_mover(&MoverDef::at(Vec3::new(0.3, 0.6, 0.2)));
    settle(&mut world, id);
    let over = |world: &World| world.mover(id).position() - world.transform(lift).translation;
    let start = over(&world);
    for step in 0..1200 {
        let speed = if (step / 200) % 2 == 0 { 1.2 } else { -1.2 };
        world.set_velocity(lift, Velocity { linear: Vec3::Y * speed, angular: Vec3::ZERO });
        world.step();
        assert!(world.mover(id).is_grounded(), "step {step}: the mover must stay on the ground");
        assert!(
            (over(&world) - start).length() < 1e-3,
            "step {step}: at {}, at the start {start}",
            over(&world)
        );
        assert_eq!(depth(&world, id), 0.0);
        assert!((world.mover(id).velocity().y - speed).abs() < 1e-4);
    }
}

/// A mover that jumps off a lift has the lift's velocity plus that of the jump, for both directions and any speed:
/// relative to the lift it rises by the height of the jump.
#[test]
fn a_jump_from_a_lift_adds_its_velocity() {
    let mut random = Random::new(3);
    for case in 0..40 {
        let (speed, jump) = (random.range(-12.0, 12.0), random.range(0.3, 5.0));
        let side = if case % 3 == 0 { random.range(-3.0, 3.0) } else { 0.0 };
        let mut world = World::new(WorldDef::default());
        let half = Vec3::new(3.0, 0.2, 3.0);
        let lift = platform(&mut world, half, Vec3::Y * -0.2, Vec3::ZERO, Vec3::ZERO);
        let id = world.add_mover(&MoverDef::at(Vec3::Y * 0.005));
        let (mut apex, mut left) = (0.0, Vec3::ZERO);
        for step in 0..420 {
            // The lift accelerates for 3 s, so that the mover stays on it.
            let share = sinew_math::min(step as f32 / 180.0, 1.0);
            let linear = Vec3::new(side, speed, 0.0) * share;
            world.set_velocity(lift, Velocity { linear, angular: Vec3::ZERO });
            if step == 240 {
                assert!(
                    world.mover(id).is_grounded(),
                    "case {case}: not grounded on a platform at {speed} m/s"
                );
                world.mover_jump(id, jump);
            }
            world.step();
            let over = world.mover(id).position().y - world.transform(lift).translation.y - 0.2;
            if step == 240 {
                left = world.mover(id).velocity();
            }
            if step >= 240 {
                apex = sinew_math::max(apex, over - 0.005);
            }
        }
        let (g, dt) = (9.81, world.def().dt());
        let expected = Vec3::new(side, speed + jump - g * dt, 0.0);
        assert!(
            (left - expected).length() < 1e-3,
            "case {case}: left with velocity {left}, expected {expected}"
        );
        // The apex may be half a step away from the nearest step.
        let rise = jump * jump / (2.0 * g);
        assert!(
            (apex - rise).abs() < 2e-3 + 0.01 * rise,
            "case {case}: a jump at {jump} m/s from {speed} m/s: apex {apex} m, expected {rise} m"
        );
    }
}

#[test]
fn a_turntable_carries_and_turns_a_mover() {
    let mut world = level();
    let spin = Vec3::Y * 1.5;
    let table = platform(&mut world, Vec3::new(3.0, 0.1, 3.0), Vec3::Y * 0.4, Vec3::X * 0.1, spin);
    let id = world.add_mover(&MoverDef::at(Vec3::new(1.5, 0.51, 0.2)));
    world.step();
    for _ in 0..30 {
        world.step();
    }
    let on = |world: &World| world.transform(table).inverse_point(world.mover(id).position());
    let (start, yaw) = (on(&world), world.mover(id).yaw());
    for step in 0..1200 {
        world.step();
        assert!(world.mover(id).is_grounded(), "step {step}: the mover must stay on the ground");
        assert!((on(&world) - start).length() < 1e-3, "step {step}: at {}, at the start {start}", on(&world));
    }
    let turned = world.mover(id).yaw() - yaw;
    assert!((turned - 1.5 * 1200.0 * world.def().dt()).abs() < 1e-3, "the mover turned by {turned} rad");
    // The mover leaves with the table's velocity at its position.
    let velocity = world.mover(id).velocity();
    let at = world.mover(id).position() - world.transform(table).translation;
    let expected = Vec3::X * 0.1 + spin.cross(at);
    assert!((velocity - expected).length() < 1e-2, "velocity {velocity}, expected {expected}");
    world.mover_jump(id, 3.0);
    world.step();
    let flies = world.mover(id).velocity();
    assert!(
        (flies - expected - Vec3::Y * (3.0 - 9.81 * world.def().dt())).length() < 2e-2,
        "velocity after the jump {flies}"
    );
}

#[test]
fn a_belt_carries_a_mover_and_walking_adds() {
    let mut world = level();
    let mut belt = BodyDef::fixed(Shape::Box { half_extents: Vec3::new(20.0, 0.1, 2.0) }).at(Vec3::Y * 0.1);
    belt.shapes[0].material.surface_velocity = Vec3::X * 1.5;
    world.add_body(&belt);
    let id = world.add_mover(&MoverDef::at(Vec3::new(-10.0, 0.3, 0.0)));
    settle(&mut world, id);
    let second = |world: &mut World| {
        let before = world.mover(id).position();
        (0..60).for_each(|_| world.step());
        (world.mover(id).position() - before) / (60.0 * world.def().dt())
    };
    let rides = second(&mut world);
    assert!((rides - Vec3::X * 1.5).length() < 1e-3, "velocity on the belt {rides}");
    world.set_mover_walk(id, Vec3::new(-1.5, 0.0, 0.5));
    second(&mut world);
    let walks = second(&mut world);
    assert!((walks - Vec3::Z * 0.5).length() < 1e-2, "walking added {walks}");
}

#[test]
fn a_moving_wall_pushes_a_mover() {
    let mut world = level();
    platform(&mut world, Vec3::new(0.2, 2.0, 2.0), Vec3::new(3.0, 2.0, 0.0), Vec3::X * -2.0, Vec3::ZERO);
    let id = world.add_mover(&MoverDef::default());
    for _ in 0..180 {
        world.step();
        assert!(depth(&world, id) < 1e-3, "the wall is {} m inside the mover", depth(&world, id));
    }
    let at = world.mover(id).position();
    assert!((at.x - (3.0 - 6.0 - 0.5)).abs() < 0.01 && at.y < 0.01, "{at}");
}

#[test]
fn a_one_way_floor_passes_and_holds_a_mover() {
    let mut world = level();
    let mut shelf = BodyDef::fixed(Shape::Box { half_extents: Vec3::new(2.0, 0.1, 2.0) }).at(Vec3::Y * 1.9);
    shelf.shapes[0].rule = ContactRule::OneWay(OneWay::default());
    world.add_body(&shelf);
    let id = world.add_mover(&MoverDef { height: 1.5, ..MoverDef::default() });
    settle(&mut world, id);
    world.mover_jump(id, 7.5);
    for _ in 0..120 {
        world.step();
    }
    let at = world.mover(id).position();
    assert!(world.mover(id).is_grounded() && (at.y - 2.0).abs() < 0.01, "{at}");
    world.set_mover_walk(id, Vec3::X * 3.0);
    for _ in 0..120 {
        world.step();
    }
    assert!(world.mover(id).position().y < 0.01, "the mover must fall off the floor's edge");
}

#[test]
fn movers_stop_each_other_unless_their_filters_exclude_it() {
    let mut world = level();
    let at = |x: f32| MoverDef::at(Vec3::X * x);
    let (a, b) = (world.add_mover(&at(-2.0)), world.add_mover(&at(2.0)));
    world.set_mover_walk(a, Vec3::X * 3.0);
    world.set_mover_walk(b, Vec3::X * -3.0);
    for _ in 0..120 {
        world.step();
        let apart = (world.mover(b).position() - world.mover(a).position()).x;
        assert!(apart > 0.6, "the movers are {apart} m apart");
    }
    let apart = (world.mover(b).position() - world.mover(a).position()).x;
    assert!(apart < 0.61, "the movers must meet; they are {apart} m apart");
    // A mover whose filter excludes other movers passes.
    let ghost = Filter { mask: 0, ..world.mover(b).def().filter };
    world.set_mover_filter(b, ghost);
    for _ in 0..120 {
        world.step();
    }
    assert!(world.mover(a).position().x > 1.0);
}

#[test]
fn a_mover_stands_on_another_and_a_filter_lets_it_through_walls() {
    let mut world = level();
    let low = world.add_mover(&MoverDef::default());
    let high = world.add_mover(&MoverDef::at(Vec3::Y * 2.0));
    settle(&mut world, high);
    assert!((world.mover(high).position().y - 1.81).abs() < 0.01);
    assert_eq!(world.mover_ground(high).and_then(|ground| ground.mover), Some(low));
    world.remove_mover(low);
    settle(&mut world, high);
    assert!(world.mover(high).position().y < 0.01);

    let wall = block(&mut world, Vec3::new(1.0, 0.0, -3.0), Vec3::new(1.2, 3.0, 3.0));
    let wall = ShapeId { body: wall, shape: 0 };
    world.set_filter(wall, Filter { layers: 2, ..Filter::default() });
    world.set_mover_filter(high, Filter { mask: !2, ..Filter::default() });
    world.set_mover_walk(high, Vec3::X * 3.0);
    for _ in 0..60 {
        world.step();
    }
    assert!(world.mover(high).position().x > 2.0);
}

/// When a fast body is pulled away from under a mover, the mover stays where it is.
#[test]
fn fast_support_does_not_carry_a_mover_away() {
    let mut world = level();
    let half_extents = Vec3::new(0.2, 0.03, 0.2);
    let mut def = BodyDef::dynamic(Shape::Box { half_extents }).at(Vec3::Y * 0.03);
    def.shapes[0].density = 0.5 / (8.0 * 0.2 * 0.03 * 0.2);
    let hand = world.add_body(&def);
    let id = world.add_mover(&MoverDef::at(Vec3::new(0.05, 0.07, 0.0)));
    settle(&mut world, id);
    assert_eq!(world.mover_ground(id).and_then(|ground| ground.shape).map(|shape| shape.body), Some(hand));
    let start = world.mover(id).position();
    world.set_velocity(hand, Velocity { linear: Vec3::X * 40.0, angular: Vec3::Y * 40.0 });
    let mut yaw = 0.0;
    for step in 0..30 {
        world.step();
        let mover = world.mover(id);
        yaw = sinew_math::max(yaw, mover.yaw().abs());
        let went = (mover.position() - start) * Vec3::new(1.0, 0.0, 1.0);
        assert!(
            went.length() < 0.05 && mover.velocity().length() < 1.0,
            "step {step}: the mover moved {went}"
        );
    }
    assert!(yaw < 0.05, "the platform rotated the mover by {yaw} rad");
}
