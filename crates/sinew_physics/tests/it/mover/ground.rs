//! Movers on stairs and ledges, and their jumps and changes of height.

use super::{block, depth, level, settle};
use sinew_math::Vec3;
use sinew_physics::*;

/// Adds twelve steps up along x, starting at 2 m, a landing, and twelve steps down.
fn stairs(world: &mut World, rise: f32) -> f32 {
    let tread = 0.3;
    for i in 0..24_u8 {
        let high = if i < 12 { i + 1 } else { 24 - i };
        let x = 2.0 + f32::from(i) * tread;
        block(world, Vec3::new(x, 0.0, -2.0), Vec3::new(x + tread, rise * f32::from(high), 2.0));
    }
    2.0 + 24.0 * tread
}

#[test]
fn stairs_are_climbed_and_descended_without_leaving_the_ground() {
    for rise in [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.39] {
        for speed in [0.3, 0.6, 1.0, 2.0, 4.0, 6.0] {
            let mut world = level();
            let end = stairs(&mut world, rise);
            let id = world.add_mover(&MoverDef { step_height: 0.4, ..MoverDef::at(Vec3::X * 1.0) });
            settle(&mut world, id);
            world.set_mover_walk(id, Vec3::X * speed);
            let (mut highest, mut slowest) = (0.0_f32, f32::INFINITY);
            let steps = ((end + 1.0) / (speed * world.def().dt())) as usize + 60;
            for _ in 0..steps {
                let before = world.mover(id).position().x;
                world.step();
                let mover = world.mover(id);
                assert!(
                    mover.is_grounded(),
                    "steps of {rise} m at {speed} m/s: not grounded at {}",
                    mover.position()
                );
                assert_eq!(
                    depth(&world, id),
                    0.0,
                    "steps of {rise} m at {speed} m/s: inside the steps at {}",
                    mover.position()
                );
                highest = if mover.position().y > highest { mover.position().y } else { highest };
                let gone = mover.position().x - before;
                slowest = if gone < slowest { gone } else { slowest };
            }
            let at = world.mover(id).position();
            assert!(
                highest > rise * 11.9,
                "steps of {rise} m at {speed} m/s: highest point only {highest} m, at {at}"
            );
            assert!(at.x > end && at.y < 0.01, "steps of {rise} m at {speed} m/s: the end is at {at}");
            assert!(slowest > -1e-3, "steps of {rise} m at {speed} m/s: thrown back by {slowest} m");
        }
    }
}

#[test]
fn edges_above_the_step_height_stop_a_mover() {
    for (height, climbs) in
        [(0.1, true), (0.3, true), (0.34, true), (0.37, false), (0.5, false), (1.0, false)]
    {
        for speed in [0.5, 2.0, 6.0] {
            let mut world = level();
            block(&mut world, Vec3::new(2.0, 0.0, -2.0), Vec3::new(9.0, height, 2.0));
            let id = world.add_mover(&MoverDef::default());
            settle(&mut world, id);
            world.set_mover_walk(id, Vec3::X * speed);
            for _ in 0..(4.0 / (speed * world.def().dt())) as usize {
                world.step();
            }
            let at = world.mover(id).position();
            assert_eq!(at.x > 2.5, climbs, "a step of {height} m at {speed} m/s: the end is at {at}");
        }
    }
}

#[test]
fn a_mover_off_a_ledge_falls_freely() {
    let mut world = level();
    block(&mut world, Vec3::new(-5.0, 0.0, -2.0), Vec3::new(0.0, 10.0, 2.0));
    let id = world.add_mover(&MoverDef::at(Vec3::new(-2.0, 10.0, 0.0)));
    settle(&mut world, id);
    world.set_mover_walk(id, Vec3::X * 3.0);
    while world.mover(id).is_grounded() {
        world.step();
    }
    let (from, dt) = (world.mover(id).position(), world.def().dt());
    let mut steps = 0;
    while !world.mover(id).is_grounded() {
        world.step();
        steps += 1;
        if !world.mover(id).is_grounded() {
            let t = steps as f32 * dt;
            let fallen = from.y - world.mover(id).position().y;
            assert!((fallen - 4.905 * t * t).abs() < 0.01 + 1e-3 * fallen, "fell {fallen} m in {t} s");
        }
        assert!(steps < 200);
    }
    assert!(world.mover(id).position().y < 0.01 && world.mover(id).position().x > 2.0);
}

#[test]
fn jump_height_follows_jump_speed() {
    for speed in [2.0, 4.5, 8.0_f32] {
        let mut world = level();
        let id = world.add_mover(&MoverDef::default());
        settle(&mut world, id);
        let from = world.mover(id).position().y;
        world.mover_jump(id, speed);
        let (mut top, mut steps) = (0.0_f32, 0);
        loop {
            world.step();
            steps += 1;
            let height = world.mover(id).position().y - from;
            top = if height > top { height } else { top };
            // The jump requested in the air must not be executed in the step in which the mover lands.
            if world.mover(id).is_grounded() {
                break;
            }
            // A jump in the air has no effect.
            world.mover_jump(id, speed);
            assert!(steps < 200);
        }
        let expected = speed * speed / (2.0 * 9.81);
        // The highest point may be half a step away from the nearest step.
        let between = 9.81 * 0.5 * (0.5 * world.def().dt()) * (0.5 * world.def().dt());
        assert!(
            top <= expected + 1e-4 && top >= expected - between - 1e-4,
            "the mover jumped {top} m high, expected {expected} m"
        );
        let seconds = steps as f32 * world.def().dt();
        assert!((seconds - 2.0 * speed / 9.81).abs() < 2.0 * world.def().dt(), "the jump lasted {seconds} s");
    }
}

#[test]
fn a_mover_grows_only_where_there_is_room() {
    let mut world = level();
    block(&mut world, Vec3::new(2.0, 1.2, -2.0), Vec3::new(4.0, 1.5, 2.0));
    let id = world.add_mover(&MoverDef::default());
    settle(&mut world, id);
    world.set_mover_walk(id, Vec3::X * 2.0);
    for _ in 0..120 {
        world.step();
    }
    assert!(world.mover(id).position().x < 2.0, "an upright mover must not fit under the roof");
    assert!(world.set_mover_height(id, 1.0));
    while world.mover(id).position().x < 3.0 {
        world.step();
        assert!(world.step_count() < 600);
    }
    assert!(!world.set_mover_height(id, 1.8), "a mover must not grow under the low roof");
    assert!(world.mover(id).def().height == 1.0 && depth(&world, id) == 0.0);
    while world.mover(id).position().x < 5.0 {
        world.step();
        assert!(world.step_count() < 600);
    }
    assert!(world.set_mover_height(id, 1.8), "a mover must grow behind the roof");
    world.step();
    assert!(depth(&world, id) == 0.0 && world.mover(id).is_grounded());
}

#[test]
fn ground_reports_its_material() {
    let mut world = level();
    let mut stage = BodyDef::fixed(Shape::Box { half_extents: Vec3::new(2.0, 0.5, 2.0) });
    stage.shapes[0].material.tag = 7;
    let stage = world.add_body(&stage);
    let id = world.add_mover(&MoverDef::at(Vec3::new(0.0, 1.0, 0.0)));
    assert!(world.mover_ground(id).is_none());
    settle(&mut world, id);
    let ground = world.mover_ground(id).expect("the mover stands on the ground");
    assert_eq!(ground.shape.map(|shape| shape.body), Some(stage));
    assert!(ground.material.tag == 7 && (ground.normal - Vec3::Y).length() < 1e-6);
    assert!((ground.point.y - 0.5).abs() < 1e-5 && ground.velocity == Vec3::ZERO);
    world.remove_body(stage);
    assert!(world.mover_ground(id).is_none());
    settle(&mut world, id);
    assert!(world.mover(id).position().y < 0.01);
}
