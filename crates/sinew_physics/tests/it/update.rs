//! Frames of any length: the same state after every step, and bounded time per frame.

use crate::objects::inhabited;
use core::time::Duration;
use sinew_math::{Random, Vec3};
use sinew_physics::particles::{GroupDef, ParticleDef};
use sinew_physics::stage::NoProfiler;
use sinew_physics::*;

/// Number of compared steps.
const STEPS: u64 = 180;

/// Returns the hash after every tenth step, taken when no time remains.
fn hashes(mut frame: impl FnMut() -> Duration) -> Vec<u64> {
    let mut world = inhabited();
    let step = world.def().step_nanoseconds;
    let mut hashes = Vec::new();
    for k in (10..=STEPS).step_by(10) {
        let mut left = Duration::from_nanos(step * k) - Duration::from_nanos(step * (k - 10));
        while left > Duration::ZERO {
            // The last frame has the remaining length.
            let time = Duration::min(frame(), left);
            assert_eq!(world.update(time).dropped, Duration::ZERO);
            left -= time;
        }
        assert_eq!(world.step_count(), k);
        hashes.push(world.hash());
    }
    hashes
}

#[test]
fn the_state_after_step_k_is_the_same_at_any_frame_rate() {
    let mut stepped = inhabited();
    let mut expected = Vec::new();
    for k in 1..=STEPS {
        stepped.step();
        if k % 10 == 0 {
            expected.push(stepped.hash());
        }
    }
    for rate in [24, 30, 60, 144] {
        let frame = Duration::from_secs(1) / rate;
        assert_eq!(hashes(|| frame), expected, "the hashes differ at {rate} frames per second");
    }
    let mut random = Random::new(1);
    let jittered = hashes(|| Duration::from_secs_f32(random.range(0.0, 0.03)));
    assert_eq!(jittered, expected, "the hashes differ with frames of random lengths");
}

#[test]
fn time_beyond_catch_up_steps_is_dropped_and_reported() {
    let mut world = World::new(WorldDef { catch_up_steps: 4, ..WorldDef::default() });
    let step = Duration::from_nanos(world.def().step_nanoseconds);
    assert_eq!(world.update(step * 4), Update { steps: 4, alpha: 0.0, dropped: Duration::ZERO });
    let late = world.update(step * 10 + step / 2);
    assert_eq!((late.steps, late.dropped), (4, step * 6));
    assert!((late.alpha - 0.5).abs() < 1e-6, "time less than a step must wait for the next frame");
    assert_eq!(world.step_count(), 8);
    // The frame lasts longer than five hundred years.
    let late = world.update(Duration::from_secs(500 * 365 * 86_400));
    assert_eq!(late.steps, 4);
    assert_eq!(world.update(Duration::MAX).steps, 4);
    assert!(world.update(Duration::ZERO).alpha < 1.0);
}

#[test]
fn default_settings_catch_up_at_most_a_quarter_of_a_second() {
    let mut world = World::new(WorldDef::default());
    let late = world.update(Duration::from_secs(1));
    assert_eq!(late.steps, 15);
    assert!((late.dropped.as_secs_f32() - 0.75).abs() < world.def().dt());
}

#[test]
fn update_with_calls_the_host_for_every_step_of_a_frame() {
    let push = Vec3::new(3.0, 0.0, 0.0);
    let world = || {
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let shapes = vec![ShapeDef::new(Shape::Sphere { radius: 0.1 })];
        let body = world.add_body(&BodyDef { shapes, ..BodyDef::default() });
        (world, body)
    };
    let ((mut stepped, a), (mut updated, b)) = (world(), world());
    for _ in 0..3 {
        stepped.apply_force(a, push, Vec3::ZERO);
        stepped.step();
    }
    let three = Duration::from_nanos(3 * updated.def().step_nanoseconds);
    updated.update_with(three, |world| {
        world.apply_force(b, push, Vec3::ZERO);
        world.step_with(&Threads::new(2), &NoProfiler);
    });
    assert_eq!(updated.hash(), stepped.hash());
}

#[test]
#[should_panic(expected = "each call takes one step")]
fn callback_that_takes_no_step_panics() {
    World::new(WorldDef::default()).update_with(Duration::from_millis(20), |_| {});
}

#[test]
fn interpolated_poses_lie_between_two_steps() {
    let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
    let shapes = vec![ShapeDef::new(Shape::Sphere { radius: 0.1 })];
    let def = BodyDef { linear_velocity: Vec3::X, shapes, ..BodyDef::default() };
    let body = world.add_body(&def);
    let particle = ParticleDef { position: Vec3::Y, velocity: Vec3::X, mass: 1.0, radius: 0.1 };
    let group = world.add_particles(&GroupDef { particles: vec![particle], ..GroupDef::default() });
    let mut time = 0.0;
    for _ in 0..50 {
        let frame = Duration::from_millis(7);
        let alpha = world.update(frame).alpha;
        time += frame.as_secs_f32();
        if world.step_count() > 0 {
            // The interpolated pose is one step behind the elapsed time.
            let expected = time - world.def().dt();
            let of_particle = world.particles(group).interpolated(alpha).next();
            for x in [world.interpolated(body, alpha).translation.x, of_particle.map_or(0.0, |at| at.x)] {
                assert!((x - expected).abs() < 1e-5, "interpolated x {x} m, expected {expected} m");
            }
        }
    }
}
