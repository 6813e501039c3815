//! Movers: snapshots, rollbacks, threads, frame lengths, allocations and invalid settings.

use super::{block, level};
use sinew_math::trig::{cos, sin};
use sinew_math::{Reader, Vec3, Writer};
use sinew_physics::stage::NoProfiler;
use sinew_physics::*;

/// Returns a world with crates, steps, a lift, and eight movers that walk in circles among them.
fn busy() -> (World, Vec<MoverId>) {
    let mut world = level();
    for i in 0..12_u8 {
        let angle = f32::from(i) * 0.52;
        let at = Vec3::new(3.0 * cos(angle), 0.3 + 0.6 * f32::from(i % 2), 3.0 * sin(angle));
        world.add_body(&BodyDef::dynamic(Shape::Box { half_extents: Vec3::splat(0.29) }).at(at));
    }
    for i in 0..4_u8 {
        let x = 4.0 + 0.3 * f32::from(i);
        block(&mut world, Vec3::new(x, 0.0, -1.0), Vec3::new(x + 0.3, 0.2 * f32::from(i + 1), 1.0));
    }
    let mut lift = BodyDef::fixed(Shape::Box { half_extents: Vec3::new(1.0, 0.1, 1.0) }).at(Vec3::Y * 0.1);
    lift.kind = BodyKind::Kinematic;
    lift.linear_velocity = Vec3::Y * 0.2;
    lift.angular_velocity = Vec3::Y * 0.4;
    world.add_body(&lift);
    let place = |i: u8| MoverDef::at(Vec3::new(-5.0 + 1.3 * f32::from(i), 0.5, 1.0));
    let ids = (0..8).map(|i| world.add_mover(&place(i))).collect();
    (world, ids)
}

fn steer(world: &mut World, ids: &[MoverId]) {
    let time = world.step_count() as f32 * world.def().dt();
    for (i, &id) in ids.iter().enumerate().filter(|(_, id)| world.contains_mover(**id)).collect::<Vec<_>>() {
        let angle = 0.7 * time + i as f32;
        world.set_mover_walk(id, Vec3::new(cos(angle), 0.0, sin(angle)) * 3.0);
        if (world.step_count() + 7 * i as u64).is_multiple_of(50) {
            world.mover_jump(id, 4.0);
        }
    }
}

fn run(world: &mut World, ids: &[MoverId], steps: usize) {
    for _ in 0..steps {
        steer(world, ids);
        world.step();
    }
}

#[test]
fn a_snapshot_holds_all_mover_state() {
    let (mut world, ids) = busy();
    run(&mut world, &ids, 77);
    let mut w = Writer::new();
    world.save(&mut w);
    let bytes = w.into_bytes();
    let (mut copy, _) = busy();
    copy.load(&mut Reader::new(&bytes)).expect("the snapshot must load");
    assert_eq!(copy.hash(), world.hash());
    for _ in 0..200 {
        run(&mut world, &ids, 1);
        run(&mut copy, &ids, 1);
        assert_eq!(copy.hash(), world.hash(), "after {} steps", world.step_count());
    }
    for length in (0..bytes.len()).step_by(97) {
        assert!(
            copy.load(&mut Reader::new(&bytes[..length])).is_err(),
            "a snapshot truncated to {length} of {} bytes must be refused",
            bytes.len()
        );
    }
}

/// Rolls back eight steps, during which one mover was added and another removed.
#[test]
fn rollback_repeats_the_same_path() {
    let (mut world, mut ids) = busy();
    run(&mut world, &ids, 40);
    for _ in 0..10 {
        world.mark();
        let known = ids.len();
        let once = |world: &mut World, ids: &mut Vec<MoverId>| {
            run(world, ids, 4);
            ids.push(world.add_mover(&MoverDef::at(Vec3::new(0.0, 3.0, 0.0))));
            let gone = ids[known - 1];
            if world.contains_mover(gone) {
                world.remove_mover(gone);
            }
            run(world, ids, 4);
            world.hash()
        };
        let first = once(&mut world, &mut ids);
        world.reset();
        ids.truncate(known);
        let second = once(&mut world, &mut ids);
        assert_eq!(first, second);
    }
}

#[test]
fn mover_results_do_not_depend_on_threads() {
    let hashes = [1, 2, 4].map(|count| {
        let (mut world, ids) = busy();
        let threads = Threads::new(count);
        for _ in 0..150 {
            steer(&mut world, &ids);
            world.step_with(&threads, &NoProfiler);
        }
        world.hash()
    });
    assert!(
        hashes[0] == hashes[1] && hashes[1] == hashes[2],
        "the hashes differ between numbers of threads: {hashes:?}"
    );
}

/// Frames at 30, 60 and 144 Hz: movers move in steps, so their positions depend only on the number of steps.
#[test]
fn any_frame_length_gives_the_same_state() {
    let after = |frames: u32| {
        let (mut world, ids) = busy();
        for (i, &id) in ids.iter().enumerate() {
            world.set_mover_walk(id, Vec3::new(cos(i as f32), 0.0, sin(i as f32)) * 3.0);
        }
        let frame = core::time::Duration::from_secs_f64(1.0 / f64::from(frames));
        let mut ways = Vec::new();
        while world.step_count() < 120 {
            world.update_with(frame, |world| {
                world.step();
                ways.push(ids.iter().map(|&id| world.mover(id).position()).collect::<Vec<_>>());
            });
        }
        ways.truncate(120);
        ways
    };
    let expected = after(60);
    assert_eq!(after(30), expected);
    assert_eq!(after(144), expected);
}

/// Repeats the same two seconds. After the first repetitions, the steps allocate nothing.
#[test]
fn a_warm_step_with_movers_does_not_allocate() {
    let (mut world, ids) = busy();
    let moves = |id: &BodyId| world.kind(*id) != BodyKind::Static;
    let state = |id| (id, world.transform(id), world.velocity(id));
    let bodies: Vec<_> = world.body_ids().filter(moves).map(state).collect();
    let mut cycle = || {
        for &(body, at, velocity) in &bodies {
            world.set_transform(body, at);
            world.set_velocity(body, velocity);
        }
        for (&id, i) in ids.iter().zip(0_u8..) {
            world.set_mover_position(id, Vec3::new(-5.0 + 1.3 * f32::from(i), 0.5, 1.0));
        }
        for step in 0..120_u8 {
            for (&id, i) in ids.iter().zip(0_u8..) {
                let angle = 0.02 * f32::from(step) + f32::from(i);
                world.set_mover_walk(id, Vec3::new(cos(angle), 0.0, sin(angle)) * 3.0);
            }
            world.step();
        }
    };
    (0..4).for_each(|_| cycle());
    let info = allocation_counter::measure(cycle);
    assert_eq!(info.count_total, 0, "{info:?}");
}

#[test]
fn mover_check_refuses_invalid_settings() {
    let good = MoverDef::default();
    assert!(good.check().is_ok());
    for wrong in [
        MoverDef { radius: 0.0, ..good.clone() },
        MoverDef { radius: f32::NAN, ..good.clone() },
        MoverDef { height: 0.5, ..good.clone() },
        MoverDef { up: Vec3::ZERO, ..good.clone() },
        MoverDef { skin: 0.0, ..good.clone() },
        MoverDef { mass: -1.0, ..good.clone() },
        MoverDef { push_force: f32::INFINITY, ..good.clone() },
        MoverDef { step_height: f32::NAN, ..good.clone() },
        MoverDef { slope_limit: 2.0, ..good.clone() },
        MoverDef { position: Vec3::splat(f32::NAN), ..good.clone() },
    ] {
        assert!(wrong.check().is_err(), "the check must refuse {wrong:?}");
    }
}
