//! Conditions under which bodies fall asleep, and which bodies fall asleep together.

use super::{Nap, all_asleep, linear, nap, run, slab, steps_to_sleep};
use crate::build::{ball, box_body, floor, half_space_tilted, sphere_body};
use sinew_math::{ReadError, Reader, Vec3, Writer, trig};
use sinew_physics::*;

/// Number of steps per second.
const SECOND: usize = 60;

fn weightless() -> World {
    World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() })
}

fn adrift(velocity: Velocity) -> (World, BodyId) {
    let mut world = weightless();
    let id = world.add_body(&BodyDef {
        linear_velocity: velocity.linear,
        angular_velocity: velocity.angular,
        ..box_body(Vec3::splat(0.2), Vec3::ZERO)
    });
    (world, id)
}

#[test]
fn bodies_still_for_half_a_second_sleep() {
    let (mut world, _) = adrift(Velocity::default());
    assert!((30..=31).contains(&steps_to_sleep(&mut world)));
}

#[test]
fn creeping_bodies_do_not_sleep() {
    // In half a second the body moves by 7 mm, or rotates by 0.03 rad.
    for velocity in [linear(Vec3::X * 0.014), Velocity { angular: Vec3::Y * 0.06, ..Velocity::default() }] {
        let (mut world, id) = adrift(velocity);
        run(&mut world, 10 * SECOND);
        assert!(world.is_awake(id) && world.velocity(id) == velocity);
    }
    let (mut world, id) = adrift(linear(Vec3::X * 0.005));
    run(&mut world, SECOND);
    assert!(!world.is_awake(id), "2.5 mm in half a second must count as rest");
}

#[test]
fn bodies_creeping_down_a_slope_do_not_sleep() {
    // Without friction, with air drag: v = g sin θ (1/c + h), since drag acts before gravity.
    let (angle, damping) = (0.2, 200.0);
    let mut world = World::new(WorldDef::default());
    half_space_tilted(&mut world, angle, 0.0);
    let up = Vec3::new(-trig::sin(angle), trig::cos(angle), 0.0);
    let id = world.add_body(&BodyDef { linear_damping: damping, ..sphere_body(0.2, up * 0.2) });
    run(&mut world, 10 * SECOND);
    let expected = 9.81 * trig::sin(angle) * (1.0 / damping + 1.0 / 240.0);
    let speed = world.velocity(id).linear.length();
    assert!(
        world.is_awake(id) && (speed - expected).abs() < 0.03 * expected,
        "the body slides at {speed} m/s, expected {expected} m/s"
    );
}

/// At the highest point on a slope a ball is slow for seconds and still rolls back; a crate that friction holds there
/// falls asleep.
#[test]
fn a_ball_turning_back_on_a_slope_does_not_sleep() {
    for k in 0..15 {
        let angle = (0.1 + 0.1 * k as f32).to_radians();
        let (up, along) = (
            Vec3::new(-trig::sin(angle), trig::cos(angle), 0.0),
            Vec3::new(trig::cos(angle), trig::sin(angle), 0.0),
        );
        let mut world = World::new(WorldDef::default());
        half_space_tilted(&mut world, angle, 0.6);
        let (radius, speed) = (0.1, 0.1 + 0.01 * k as f32);
        let rolling = BodyDef {
            linear_velocity: along * speed,
            angular_velocity: Vec3::Z * (-speed / radius),
            ..sphere_body(radius, up * radius)
        };
        let ball = world.add_body(&rolling);
        let crate_ = world.add_body(
            &box_body(Vec3::splat(0.1), up * 0.1 - Vec3::Z)
                .turned(sinew_math::Rotation::from_axis_angle(Vec3::Z, angle)),
        );
        // Time up and down: twice v / (5/7 g sin θ).
        let steps = 2.0 * speed / (5.0 / 7.0 * 9.81 * trig::sin(angle)) * 60.0;
        for step in 0..steps as u32 {
            world.step();
            assert!(world.is_awake(ball), "{angle} rad: asleep in step {step}");
        }
        let back = world.velocity(ball).linear.dot(along);
        assert!(
            (back + speed).abs() < 0.05 * speed,
            "{angle} rad: returns at {back} m/s, thrown at {speed} m/s"
        );
        assert!(!world.is_awake(crate_));
    }
}

#[test]
fn slowly_pushed_bodies_do_not_sleep() {
    let Nap { mut world, sleeper, .. } = nap();
    let def = slab(0.1, Vec3::new(-0.31, 0.2, 0.0));
    let pusher = world.add_body(&BodyDef { linear_velocity: Vec3::X * 0.002, ..def });
    run(&mut world, 5 * SECOND);
    for _ in 0..2 * SECOND {
        world.step();
        assert!(world.is_awake(sleeper));
    }
    world.set_velocity(pusher, Velocity::default());
    assert!(steps_to_sleep(&mut world) <= 40);
}

/// Object that moves a body back and forth ten times per second, by `amplitude` metres in each direction.
struct Shaker {
    body: BodyId,
    amplitude: f32,
}

impl PhysicsObject for Shaker {
    fn kind(&self) -> &'static str {
        "shaker"
    }

    fn add_forces(&mut self, forces: &mut Forces<'_>) {
        let turns = core::f32::consts::TAU * 10.0;
        let mass = forces.mass(self.body).mass;
        let push = mass * self.amplitude * turns * turns * trig::cos(turns * forces.time() as f32);
        forces.apply_force_at_center(self.body, Vec3::X * push);
    }

    fn save(&self, _: &mut Writer) {}

    fn load(&mut self, _: &mut Reader<'_>) -> Result<(), ReadError> {
        Ok(())
    }
}

#[test]
fn bodies_that_tremble_below_the_thresholds_sleep() {
    for (amplitude, sleeps) in [(0.0005, true), (0.005, false)] {
        // The body swings about its start: x = −a cos ωt.
        let (mut world, body) = adrift(Velocity::default());
        world.add_object(Box::new(Shaker { body, amplitude }));
        let mut slept = false;
        for _ in 0..2 * SECOND {
            world.step();
            slept |= !world.is_awake(body);
        }
        assert_eq!(slept, sleeps, "a body that trembles by {amplitude} m");
    }
}

#[test]
fn sleep_thresholds_change_the_time_to_sleep() {
    let time = |sleep_thresholds: SleepThresholds| {
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, sleep_thresholds, ..WorldDef::default() });
        let velocity = Vec3::X * 0.005;
        world.add_body(&BodyDef { linear_velocity: velocity, ..box_body(Vec3::ONE, Vec3::ZERO) });
        (0..100).find(|_| {
            world.step();
            all_asleep(&world)
        })
    };
    let default = SleepThresholds::default();
    assert!(matches!(time(default), Some(29..=30)));
    assert!(matches!(time(SleepThresholds { time: 0.25, ..default }), Some(14..=15)));
    assert_eq!(time(SleepThresholds { time: 0.0, ..default }), Some(0));
    assert_eq!(time(SleepThresholds { time: 0.0, speed: 0.004, ..default }), None);
    assert_eq!(time(SleepThresholds { distance: 0.001, ..default }), None);
    assert_eq!(time(SleepThresholds { speed: 0.004, ..default }), None);
    for wrong in [
        SleepThresholds { time: -1.0, ..default },
        SleepThresholds { time: f32::NAN, ..default },
        SleepThresholds { distance: 0.0, ..default },
        SleepThresholds { angle: f32::INFINITY, ..default },
        SleepThresholds { spin: f32::NAN, ..default },
    ] {
        let def = WorldDef { sleep_thresholds: wrong, ..WorldDef::default() };
        assert!(def.check().is_err(), "the check must refuse {wrong:?}");
    }
}

#[test]
fn a_sleepless_body_keeps_only_its_island_awake() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let box_at = |x, y| box_body(Vec3::splat(0.2), Vec3::new(x, y, 0.0));
    let watchman = world.add_body(&BodyDef { sleeping: Sleeping::Off, ..box_at(0.0, 0.2) });
    let on_top = world.add_body(&box_at(0.0, 0.6));
    let apart = world.add_body(&box_at(2.0, 0.2));
    run(&mut world, 3 * SECOND);
    assert!(world.is_awake(watchman) && world.is_awake(on_top) && !world.is_awake(apart));
    assert_eq!(world.sleeping(watchman), Sleeping::Off);
    world.set_sleeping(watchman, Sleeping::On);
    run(&mut world, SECOND);
    assert!(all_asleep(&world));
    world.set_sleeping(on_top, Sleeping::Off);
    assert!(world.is_awake(watchman) && world.is_awake(on_top) && !world.is_awake(apart));
}

#[test]
fn put_to_sleep_acts_on_the_whole_island() {
    let mut world = World::new(WorldDef::default());
    let body = |y| sphere_body(0.1, Vec3::Y * y);
    let [upper, lower, apart] = [3.0, 2.5, 1.0].map(|y| world.add_body(&body(y)));
    let joint = ball(&world, upper, lower, Vec3::Y * 2.75);
    world.add_joint(&joint);
    world.step();
    world.put_to_sleep(lower);
    let (height, below) = (world.transform(upper), world.transform(apart));
    run(&mut world, SECOND / 4);
    assert!(!world.is_awake(upper) && !world.is_awake(lower) && world.is_awake(apart));
    assert!(world.transform(upper) == height && world.transform(apart).translation.y < below.translation.y);
    world.wake(upper);
    world.step();
    assert!(world.is_awake(lower) && world.transform(upper).translation.y < height.translation.y);
}

#[test]
fn separated_parts_sleep_independently() {
    let mut world = weightless();
    let [still, mover] = [0.0, 0.5].map(|x| world.add_body(&sphere_body(0.1, Vec3::X * x)));
    let joint = ball(&world, still, mover, Vec3::X * 0.25);
    let joint = world.add_joint(&joint);
    world.set_velocity(mover, Velocity { angular: Vec3::X, ..Velocity::default() });
    run(&mut world, 2 * SECOND);
    assert!(world.is_awake(still) && world.is_awake(mover), "the moving body must keep the other awake");
    world.remove_joint(joint);
    run(&mut world, SECOND);
    assert!(!world.is_awake(still) && world.is_awake(mover));
    world.set_velocity(mover, Velocity::default());
    run(&mut world, SECOND);
    world.wake(mover);
    assert!(!world.is_awake(still), "separate bodies must fall asleep separately");
}

#[test]
fn static_bodies_do_not_connect_islands() {
    for kind in [BodyKind::Static, BodyKind::Kinematic] {
        let mut world = World::new(WorldDef::default());
        let carrier = world.add_body(&BodyDef { kind, ..slab(3.0, Vec3::ZERO) });
        let [left, right] =
            [-1.0, 1.0].map(|x| world.add_body(&box_body(Vec3::splat(0.1), Vec3::new(x, 0.15, 0.0))));
        let hanging = world.add_body(&sphere_body(0.1, Vec3::Y * -0.5));
        let joint = ball(&world, carrier, hanging, Vec3::ZERO);
        world.add_joint(&joint);
        steps_to_sleep(&mut world);
        world.wake(left);
        run(&mut world, 10);
        assert!(world.is_awake(left) && !world.is_awake(right) && !world.is_awake(hanging), "{kind:?}");
        assert!(world.is_awake(carrier), "kinematic bodies must never sleep");
    }
}
