//! Free motion, pendulums, friction, stacks and restored worlds, compared with closed forms.

use crate::build::{ball, box_body, floor, half_space_tilted, sphere_body};
use sinew_math::{Random, Rotation, Vec3};
use sinew_physics::*;

fn run(world: &mut World, steps: usize) {
    for _ in 0..steps {
        world.step();
    }
}

#[test]
fn free_fall_is_exact_to_the_integrator() {
    let mut world = World::new(WorldDef::default());
    let id = world.add_body(&sphere_body(0.1, Vec3::new(0.0, 100.0, 0.0)));
    run(&mut world, 60);
    // Symplectic Euler with substep h: y = −g t²/2 − g h t/2.
    let dt = f64::from(world.def().dt());
    let (t, h) = (60.0 * dt, dt / 4.0);
    let expected = 100.0 - 9.81 * t * t / 2.0 - 9.81 * h * t / 2.0;
    let y = f64::from(world.transform(id).translation.y);
    assert!((y - expected).abs() < 1e-4, "height {y} m, expected {expected} m");
}

#[test]
fn projectile_lands_at_the_position_of_the_closed_form() {
    let mut world = World::new(WorldDef::default());
    let mut def = sphere_body(0.05, Vec3::ZERO);
    def.linear_velocity = Vec3::new(10.0, 12.0, -3.0);
    let id = world.add_body(&def);
    run(&mut world, 120);
    let t = 120.0 * world.def().dt();
    let h = world.def().dt() / 4.0;
    let expected = def.linear_velocity * t - Vec3::Y * (0.5 * 9.81 * t * (t + h));
    assert!((world.transform(id).translation - expected).length() < 2e-3);
}

#[test]
fn pendulum_periods_match_the_closed_form() {
    for (amplitude, period) in [(30.0f32, 2.040_99), (90.0, 2.367_84), (150.0, 3.535_10)] {
        let mut world = World::new(WorldDef::default());
        let anchor = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });
        let turn = Rotation::from_axis_angle(Vec3::Z, amplitude.to_radians());
        let radius = 0.04f32;
        let mut def = sphere_body(radius, turn * -Vec3::Y);
        // The ball is fixed to its massless rod: a compound pendulum with I = (0.4 r² + l²) m.
        let period = period * (1.0 + 0.4 * radius * radius).sqrt();
        def.shapes[0].filter.mask = 0;
        let bob = world.add_body(&def);
        world.add_joint(&ball(&world, anchor, bob, Vec3::ZERO));
        let measured = swing_period(&mut world, bob);
        assert!(
            (measured / period - 1.0).abs() < 0.003,
            "amplitude {amplitude}°: period {measured} s, expected {period} s"
        );
    }
}

/// Returns the interpolated time between two passes through the lowest point in the same direction, seconds.
fn swing_period(world: &mut World, bob: BodyId) -> f32 {
    let mut passes = Vec::new();
    let mut before = world.transform(bob).translation.x;
    for step in 0..1200 {
        world.step();
        let x = world.transform(bob).translation.x;
        if before > 0.0 && x <= 0.0 {
            passes.push((step as f32 + before / (before - x)) * world.def().dt());
        }
        before = x;
    }
    let n = passes.len() - 1;
    (passes[n] - passes[0]) / n as f32
}

#[test]
fn coulomb_friction_holds_below_its_angle_and_slides_above() {
    for friction in [0.3f32, 0.5, 0.8] {
        for (offset, slides) in [(-0.5f32, false), (0.5, true)] {
            let angle = sinew_math::trig::atan2(friction, 1.0) + offset.to_radians();
            let mut world = World::new(WorldDef::default());
            half_space_tilted(&mut world, angle, friction);
            let turn = Rotation::from_axis_angle(Vec3::Z, angle);
            let mut def = box_body(Vec3::new(0.3, 0.1, 0.3), turn * Vec3::new(0.0, 0.1, 0.0));
            def.rotation = turn;
            def.shapes[0].material.friction = friction;
            let id = world.add_body(&def);
            run(&mut world, 60);
            let start = world.transform(id).translation;
            run(&mut world, 600);
            let moved = (world.transform(id).translation - start).length();
            let down = turn * -Vec3::X;
            if slides {
                let t = 600.0 * world.def().dt();
                let (sin, cos) = sinew_math::trig::sin_cos(angle);
                let gain = 9.81 * (sin - friction * cos);
                // The block also slid during the first second: s = a (t₁ t + t²/2).
                let expected = gain * (t + 0.5 * t * t);
                assert!(
                    (moved / expected - 1.0).abs() < 0.02,
                    "μ {friction}: slid {moved} m, expected {expected} m"
                );
                assert!((world.transform(id).translation - start).dot(down) > 0.0);
            } else {
                assert!(moved < 1e-3, "μ {friction}: crept {moved} m in 10 s");
            }
        }
    }
}

#[test]
fn weightless_pile_keeps_its_momentum() {
    let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
    let mut random = Random::new(11);
    let mut scale = 0.0;
    for i in 0..60 {
        let place = random.in_cube() * 0.8;
        let mut def = if i % 2 == 0 { sphere_body(0.12, place) } else { box_body(Vec3::splat(0.1), place) };
        def.linear_velocity = -place * 2.0;
        def.angular_velocity = random.in_cube() * 3.0;
        let id = world.add_body(&def);
        scale += world.mass(id).mass * def.linear_velocity.length();
    }
    let before = world.momentum();
    run(&mut world, 1000);
    let after = world.momentum();
    let drift = (after.linear - before.linear).length() / scale;
    assert!(drift < 1e-5, "linear momentum drifts by {drift} of Σ|mv|");
}

#[test]
fn a_box_comes_to_rest_on_the_floor_and_sleeps() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let mut def = box_body(Vec3::new(0.2, 0.3, 0.4), Vec3::new(0.0, 1.0, 0.0));
    def.rotation = Rotation::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 0.4);
    let id = world.add_body(&def);
    run(&mut world, 360);
    assert!(!world.is_awake(id), "the box must sleep; velocity {:?}", world.velocity(id));
    assert!(world.penetration(id) < 0.006, "the box penetrates the floor by {} m", world.penetration(id));
}

#[test]
fn a_stack_of_ten_boxes_stands() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let ids: Vec<BodyId> = (0..10)
        .map(|i| world.add_body(&box_body(Vec3::splat(0.25), Vec3::new(0.0, 0.25 + 0.5 * i as f32, 0.0))))
        .collect();
    run(&mut world, 600);
    let top = world.transform(ids[9]).translation;
    // Soft contacts yield under the weight above them: 1 mm of slop, and up to 5 mm at the bottom.
    assert!(top.x.abs() < 1e-3 && top.z.abs() < 1e-3 && (4.75 - top.y) < 0.04, "top at {top:?}");
    assert!(ids.iter().all(|&id| !world.is_awake(id)));
}

#[test]
fn a_restored_world_steps_like_the_original() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let mut random = Random::new(5);
    let mut last: Option<BodyId> = None;
    for i in 0..30 {
        let mut def = box_body(
            Vec3::new(0.1, 0.15, 0.2),
            Vec3::new(0.0, 0.5 + 0.35 * i as f32, 0.0) + random.in_cube() * 0.1,
        );
        def.rotation = random.rotation();
        let id = world.add_body(&def);
        if let Some(before) = last.filter(|_| i % 3 != 0) {
            let middle = (world.transform(before).translation + def.position) * 0.5;
            world.add_joint(&ball(&world, before, id, middle));
        }
        last = Some(id);
    }
    run(&mut world, 100);
    let mut w = sinew_math::Writer::new();
    world.save(&mut w);
    let bytes = w.into_bytes();
    let mut copy = World::new(WorldDef::default());
    copy.load(&mut sinew_math::Reader::new(&bytes)).expect("the snapshot must load");
    assert_eq!(copy.hash(), world.hash());
    for step in 0..300 {
        world.step();
        copy.step();
        assert_eq!(copy.hash(), world.hash(), "step {step} after the restore");
    }
    // Every truncated snapshot gives an error, not a panic.
    for end in (0..bytes.len()).step_by(37) {
        assert!(copy.load(&mut sinew_math::Reader::new(&bytes[..end])).is_err());
    }
}

#[test]
fn results_do_not_depend_on_threads_or_frame_rates() {
    let build = || {
        let mut world = World::new(WorldDef::default());
        floor(&mut world);
        for i in 0..40 {
            let place = Vec3::new((i % 8) as f32 * 0.6, 0.5 + (i / 8) as f32 * 0.7, (i % 3) as f32 * 0.2);
            let def = box_body(Vec3::splat(0.2), place);
            world.add_body(&def);
        }
        world
    };
    let mut serial = build();
    run(&mut serial, 240);
    for threads in [2, 3] {
        let mut world = build();
        for _ in 0..240 {
            world.step_with(&Threads::new(threads), &stage::NoProfiler);
        }
        assert_eq!(world.hash(), serial.hash(), "{threads} threads");
    }
}
