//! Restitution: rebound heights, collisions of balls, and rebounds from bodies that rest on each other.

use crate::build::{box_body, floor, sphere_body};
use sinew_math::{Vec3, max};
use sinew_physics::*;

const RADIUS: f32 = 0.1;

fn bouncy(mut def: BodyDef, restitution: f32) -> BodyDef {
    for shape in &mut def.shapes {
        shape.material = Material { restitution, friction: 0.0, ..shape.material };
    }
    def
}

/// Returns the heights above `ground` of the first `count` rebounds of a ball, metres.
fn rebounds(world: &mut World, ball: BodyId, ground: f32, count: usize) -> Vec<f32> {
    let (mut peaks, mut highest) = (Vec::new(), None);
    while peaks.len() < count {
        world.step();
        let height = world.transform(ball).translation.y - RADIUS - ground;
        let rises = world.velocity(ball).linear.y > 0.0;
        if rises || highest.is_some() {
            highest = Some(max(height, highest.unwrap_or(0.0)));
        }
        if !rises {
            peaks.extend(highest.take());
        }
        assert!(world.step_count() < 2_000, "the ball still bounces after {count} bounces: {peaks:?}");
    }
    peaks
}

#[test]
fn rebound_height_is_restitution_squared() {
    // Even the last impact has 2 m/s.
    for (restitution, count) in [(0.5f32, 2), (0.8, 5), (1.0, 8)] {
        for height in [2.0f32, 5.0, 10.0] {
            let mut world = World::new(WorldDef::default());
            floor(&mut world);
            let def = sphere_body(RADIUS, Vec3::Y * (RADIUS + height));
            let ball = world.add_body(&bouncy(def, restitution));
            let mut expected = height;
            for peak in rebounds(&mut world, ball, 0.0, count) {
                expected *= restitution * restitution;
                // A peak between two steps is missed by up to g dt² / 8, plus the error of a substep.
                let tolerance = 2e-3 * expected + 6e-4;
                assert!(
                    (peak - expected).abs() < tolerance,
                    "restitution {restitution}, dropped from {height} m: peak {peak} m, expected {expected} m"
                );
            }
        }
    }
}

#[test]
fn ball_bounces_on_resting_planks_as_high_as_on_the_floor() {
    for (planks, share) in [(1, 0.01), (2, 0.02)] {
        let mut world = World::new(WorldDef::default());
        floor(&mut world);
        for i in 0..planks {
            world.add_body(&box_body(Vec3::new(0.3, 0.05, 0.3), Vec3::Y * (0.05 + 0.1 * i as f32)));
        }
        let top = 0.1 * planks as f32;
        let def = sphere_body(RADIUS, Vec3::Y * (top + RADIUS + 2.0));
        let ball = world.add_body(&bouncy(def, 0.8));
        let peak = rebounds(&mut world, ball, top, 1)[0];
        assert!((peak / 1.28 - 1.0).abs() < share, "on {planks} planks the ball rebounds to {peak} m");
    }
}

/// Returns the velocities along x after the first ball has hit the row of the others, m/s.
fn collided(masses: &[f32], speed: f32, gap: f32) -> Vec<f32> {
    let mut world =
        World::new(WorldDef { gravity: Vec3::ZERO, sleeping: Sleeping::Off, ..WorldDef::default() });
    let volume = 4.0 / 3.0 * core::f32::consts::PI * RADIUS * RADIUS * RADIUS;
    let balls: Vec<BodyId> = (0..masses.len())
        .map(|i| {
            let x = (2.0 * RADIUS + gap) * i as f32 - if i == 0 { 0.5 } else { 0.0 };
            let mut def = bouncy(sphere_body(RADIUS, Vec3::X * x), 1.0);
            def.shapes[0].density = masses[i] / volume;
            def.linear_velocity = if i == 0 { Vec3::X * speed } else { Vec3::ZERO };
            world.add_body(&def)
        })
        .collect();
    for _ in 0..60 {
        world.step();
    }
    balls.iter().map(|&ball| world.velocity(ball).linear.x).collect()
}

#[test]
fn two_balls_conserve_momentum_and_energy() {
    for [m1, m2] in [[1.0f32, 1.0], [1.0, 3.0], [5.0, 1.0], [0.01, 10.0]] {
        let speeds = collided(&[m1, m2], 3.0, 0.0);
        let expected = [3.0 * (m1 - m2) / (m1 + m2), 3.0 * 2.0 * m1 / (m1 + m2)];
        for (speed, expected) in speeds.iter().zip(expected) {
            assert!((speed - expected).abs() < 1e-4, "{m1} kg hits {m2} kg: speeds {speeds:?}");
        }
    }
}

#[test]
fn last_ball_of_a_cradle_leaves_at_the_speed_of_the_first() {
    // The gaps exceed the distance that a ball moves in a substep, so that one hit ends before the next begins.
    let speeds = collided(&[1.0; 5], 2.0, 0.01);
    for (speed, expected) in speeds.iter().zip([0.0, 0.0, 0.0, 0.0, 2.0]) {
        assert!(
            (speed - expected).abs() < 1e-4,
            "speed {speed} m/s, expected {expected} m/s, of all balls {speeds:?}"
        );
    }
}

#[test]
fn bounces_of_a_weightless_heap_add_no_energy() {
    let mut world =
        World::new(WorldDef { gravity: Vec3::ZERO, sleeping: Sleeping::Off, ..WorldDef::default() });
    let mut random = sinew_math::Random::new(7);
    for i in 0..64 {
        let cell = Vec3::new((i % 4) as f32, (i / 4 % 4) as f32, (i / 16) as f32) * 0.25;
        let mut def =
            if i % 2 == 0 { sphere_body(RADIUS, cell) } else { box_body(Vec3::splat(RADIUS), cell) };
        def.linear_velocity = random.in_cube() * 4.0;
        world.add_body(&bouncy(def, 1.0));
    }
    let start = world.energy().kinetic;
    let mut before = start;
    for _ in 0..300 {
        world.step();
        let now = world.energy().kinetic;
        // Corners of a box that bounce together, each with its own speed, may gain slightly (at most 0.13 % here). Sums
        // in 32 bits have rounding errors.
        let no_more = start * (1.0 + 1e-6);
        assert!(
            now < before * 1.002 && now <= no_more,
            "step {}: energy {before} J before, {now} J now",
            world.step_count()
        );
        before = now;
    }
}
