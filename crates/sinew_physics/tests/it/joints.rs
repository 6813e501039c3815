//! Every kind of joint, with springs, motors, limits and strength, compared with closed forms.

use crate::build::{ball, joint};
use sinew_math::{Random, Range, Rotation, SwingTwistLimit, Sym3, Transform, Vec3, trig};
use sinew_physics::particles::{AttachmentDef, AttachmentTarget, RopeDef};
use sinew_physics::*;

const G: f32 = 9.81;

fn world(gravity: f32) -> World {
    World::new(WorldDef { gravity: Vec3::NEG_Y * gravity, sleeping: Sleeping::Off, ..WorldDef::default() })
}

fn anchor(world: &mut World) -> BodyId {
    world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() })
}

/// Adds a body without a shape.
fn mass_without_shape(world: &mut World, position: Vec3, mass: f32, inertia: f32) -> BodyId {
    let inertia = Sym3::from_diagonal(Vec3::splat(inertia));
    let mass = Some(MassProperties { mass, center: Vec3::ZERO, inertia });
    world.add_body(&BodyDef { position, mass, ..BodyDef::default() })
}

/// Returns a frame at a point whose x axis is the world's z: hinges then swing in the x-y plane.
fn facing(at: Vec3) -> Transform {
    Transform::new(at, Rotation::from_arc(Vec3::X, Vec3::Z))
}

const HINGE: JointKind = JointKind::Hinge { limit: None };

/// Returns a world with an arm of 2 kg whose centre is at x = 0.5 m, and the definition of a hinge about z at the
/// origin. The arm's moment of inertia about the hinge is [`ARM_MOMENT`].
fn arm(gravity: f32) -> (World, BodyId, JointDef) {
    let mut world = world(gravity);
    let a = anchor(&mut world);
    let b = mass_without_shape(&mut world, Vec3::X * 0.5, 2.0, 0.08);
    let def = joint(&world, a, b, facing(Vec3::ZERO), HINGE);
    (world, b, def)
}

/// Moment of inertia of the arm about its hinge, kg·m².
const ARM_MOMENT: f32 = 0.58;

fn angle(world: &World, body: BodyId) -> f32 {
    let p = world.center_of_mass(body);
    trig::atan2(p.y, p.x)
}

fn run(world: &mut World, seconds: f32) {
    for _ in 0..(seconds * 60.0) as usize {
        world.step();
    }
}

fn spring(hertz: f32, damping_ratio: f32) -> Softness {
    Softness::Frequency { hertz, damping_ratio }
}

fn turned(angle: f32) -> Transform {
    Transform::new(Vec3::ZERO, Rotation::from_axis_angle(Vec3::X, angle))
}

fn assert_near(found: f32, expected: f32, share: f32, what: &str) {
    assert!((found - expected).abs() <= share * expected.abs(), "{what}: {found}, expected {expected}");
}

#[test]
fn a_motor_holds_an_arm_with_the_error_of_its_stiffness() {
    for (hertz, damping_ratio) in [(3.0, 0.3), (5.0, 1.0), (10.0, 0.7), (25.0, 1.0)] {
        let (mut world, b, mut def) = arm(G);
        def.motor = Some(Motor::toward(Transform::IDENTITY, spring(hertz, damping_ratio)));
        world.add_joint(&def);
        run(&mut world, 6.0);
        let sag = -angle(&world, b);
        let omega = core::f32::consts::TAU * hertz;
        // k φ = m g l cos φ
        let expected = 2.0 * G * 0.5 * trig::cos(sag) / (ARM_MOMENT * omega * omega);
        assert_near(sag, expected, 0.02, "sag");
    }
}

#[test]
fn a_motor_steps_as_a_second_order_system() {
    for (hertz, zeta) in [(0.5, 0.2), (1.0, 0.5), (2.0, 0.7), (2.0, 1.5), (4.0, 0.3)] {
        let (mut world, b, mut def) = arm(0.0);
        let goal = 0.5;
        def.motor = Some(Motor::toward(turned(goal), spring(hertz, zeta)));
        world.add_joint(&def);
        let omega = core::f32::consts::TAU * hertz;
        for step in 1..=120 {
            world.step();
            // Velocities are half a substep ahead of positions.
            let t = step as f32 / 60.0 + 0.5 / 240.0;
            let decay = trig::exp(-zeta * omega * t);
            let expected = if zeta < 1.0 {
                let root = (1.0 - zeta * zeta).sqrt();
                let phase = omega * root * t;
                1.0 - decay * (trig::cos(phase) + zeta / root * trig::sin(phase))
            } else {
                let root = (zeta * zeta - 1.0).sqrt();
                let phase = omega * root * t;
                let (up, down) = (trig::exp(phase), trig::exp(-phase));
                1.0 - decay * 0.5 * ((up + down) + zeta / root * (up - down))
            };
            let found = angle(&world, b) / goal;
            assert!(
                (found - expected).abs() < 0.02,
                "{hertz} Hz, ζ {zeta}, t {t} s: {found}, expected {expected}"
            );
        }
    }
}

#[test]
fn weak_motor_pushes_with_at_most_its_cap() {
    let (mut world, b, mut def) = arm(0.0);
    def.motor = Some(Motor::spin(1000.0, 3.0));
    let id = world.add_joint(&def);
    run(&mut world, 1.0);
    assert_near(world.velocity(b).angular.z, 3.0 / ARM_MOMENT, 0.01, "speed after a second at full torque");
    assert_near(world.reaction(id).torque.z, 3.0, 1e-3, "torque of the motor while its arm turns");
    let (mut world, b, mut def) = arm(0.0);
    def.motor = Some(Motor::spin(2.0, 3.0));
    let id = world.add_joint(&def);
    run(&mut world, 1.0);
    assert_near(world.velocity(b).angular.z, 2.0, 0.005, "target speed");
    world.set_motor(id, Some(Motor::spin(-2.0, 3.0)));
    run(&mut world, 0.3);
    assert_near(
        world.velocity(b).angular.z,
        2.0 - 0.3 * 3.0 / ARM_MOMENT,
        0.03,
        "speed after braking at full torque for 0.3 s",
    );
    run(&mut world, 1.5);
    assert_near(world.velocity(b).angular.z, -2.0, 0.005, "target speed in the other direction");
}

/// The impulse of the stop must not add to the motor's: with any cap the motor brings its load to the new target speed
/// and no faster.
#[test]
fn a_motor_reversed_at_its_stop_leaves_it_at_its_speed() {
    let mut random = Random::new(57);
    for case in 0..60 {
        let (cap, speed) = (10.0_f32 * decades(&mut random, 5.0), 0.05 * decades(&mut random, 2.0));
        let turned = if case % 2 == 0 { Change::Speed } else { [Change::Cap, Change::None][case / 2 % 2] };
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let base = world.add_body(&BodyDef::fixed(Shape::sphere(0.05)));
        let beam = Shape::cuboid(Vec3::new(0.5, 0.05, 0.05));
        let arm = world.add_body(&BodyDef::dynamic(beam).at(Vec3::X * 0.5));
        let slides = random.unit() < 0.5;
        let def = if slides {
            world.slider(base, arm, Vec3::ZERO, Vec3::X)
        } else {
            world.hinge(base, arm, Vec3::ZERO, Vec3::Z)
        };
        let motor =
            |speed: f32, cap: f32| if slides { Motor::push(speed, cap) } else { Motor::spin(speed, cap) };
        let mut def = def.limited(Range::new(-0.5, 0.5));
        def.motor = Some(motor(2.0, cap));
        let joint = world.add_joint(&def);
        (0..120).for_each(|_| world.step());
        let at = |world: &World| {
            let pose = world.joint_transform(joint);
            if slides { pose.translation.x } else { pose.rotation.twist_angle(Vec3::X) }
        };
        let stop = at(&world);
        let (motor, speed) = match turned {
            Change::Speed => (Some(motor(-speed, cap)), -speed),
            Change::Cap => (Some(motor(2.0, 1e-3 * cap)), 0.0),
            Change::None => (None, 0.0),
        };
        world.set_motor(joint, motor);
        let way = speed * world.def().dt();
        for step in 1..=20 {
            world.step();
            // A weak motor needs longer to reach the target speed; no motor exceeds it.
            let expected = sinew_math::max(stop + way * step as f32, -0.5);
            let gone = at(&world);
            let bar = 2e-4 + 0.01 * way.abs();
            assert!(
                gone > expected - bar,
                "case {case}, cap {cap}, {speed} m/s: at {gone}, expected {expected}"
            );
            if cap > 2e3 {
                assert!(
                    gone < expected + bar,
                    "case {case}, cap {cap}, {speed} m/s: at {gone}, expected {expected}"
                );
            }
        }
    }
}

/// Returns a random number from 1 to ten to the power of `most`.
fn decades(random: &mut Random, most: f32) -> f32 {
    trig::exp(random.range(0.0, most) * core::f32::consts::LN_10)
}

/// Change of a motor at its stop.
#[derive(Clone, Copy)]
enum Change {
    Speed,
    Cap,
    None,
}

#[test]
fn a_saturated_motor_that_loses_its_cap_reaches_its_speed() {
    let (mut world, b, mut def) = arm(0.0);
    def.motor = Some(Motor::spin(50.0, 3.0));
    let id = world.add_joint(&def);
    run(&mut world, 0.5);
    world.set_motor(id, Some(Motor::spin(50.0, f32::INFINITY)));
    run(&mut world, 0.1);
    assert_near(world.velocity(b).angular.z, 50.0, 0.005, "target speed");
}

#[test]
fn a_motor_too_weak_for_the_load_sinks_and_one_strong_enough_holds() {
    for (torque, holds) in [(9.0, false), (11.0, true)] {
        let (mut world, b, mut def) = arm(G);
        // m g l = 9.81 N·m
        def.motor =
            Some(Motor { max_torque: torque, ..Motor::toward(Transform::IDENTITY, spring(20.0, 1.0)) });
        world.add_joint(&def);
        run(&mut world, 2.0);
        assert_eq!(angle(&world, b) > -0.05, holds, "{torque} N·m: angle {} rad", angle(&world, b));
    }
}

#[test]
fn motors_in_a_chain_saturate_only_where_they_are_weak() {
    // Three horizontal links: the motor at the root carries all of them, the motor at the tip only its own.
    let mut world = world(G);
    let mut last = anchor(&mut world);
    let mut joints = Vec::new();
    for i in 0..3 {
        let b = mass_without_shape(&mut world, Vec3::X * (i as f32 + 0.5), 1.0, 0.08);
        let mut def = joint(&world, last, b, facing(Vec3::X * i as f32), HINGE);
        // Loads: 44, 19.6 and 4.9 N·m.
        let max_torque = [60.0, 10.0, 20.0][i];
        def.motor = Some(Motor { max_torque, ..Motor::toward(Transform::IDENTITY, spring(15.0, 1.0)) });
        joints.push(world.add_joint(&def));
        last = b;
    }
    let mut most = [0.0f32; 3];
    for _ in 0..180 {
        world.step();
        for (most, &id) in most.iter_mut().zip(&joints) {
            *most = most.max(sinew_math::limits::hinge_angle(world.joint_transform(id).rotation).abs());
        }
    }
    assert!(most[0] < 0.1, "the root joint must not move: {most:?}");
    assert!(most[1] > 0.7, "the middle joint must yield: {most:?}");
    assert!(most[2] < 0.1, "the tip joint must not move: {most:?}");
}

#[test]
fn saturated_motors_add_only_their_work() {
    // A light piece between two heavy ones. Without a joint, the full torque of both motors would spin it a thousand
    // times as fast as it ever moves.
    let mut world = world(0.0);
    let kilograms = |half: Vec3, kg: f32| kg / (8.0 * half.x * half.y * half.z);
    let block = |world: &mut World, half_extents: Vec3, at: Vec3, kg: f32| {
        let mut shape = ShapeDef::new(Shape::Box { half_extents });
        shape.density = kilograms(half_extents, kg);
        world.add_body(&BodyDef { position: at, shapes: vec![shape], ..BodyDef::default() })
    };
    let heavy = Vec3::new(0.15, 0.1, 0.1);
    let a = block(&mut world, heavy, Vec3::ZERO, 10.0);
    let b = block(&mut world, Vec3::new(0.05, 0.03, 0.015), Vec3::X * 0.2, 0.2);
    let c = block(&mut world, heavy, Vec3::X * 0.4, 10.0);
    for (from, to, x, axis) in
        [(a, b, 0.15, Vec3::new(1.0, 2.0, -1.0)), (b, c, 0.25, Vec3::new(-1.5, 1.0, 2.0))]
    {
        let mut def = joint(&world, from, to, facing(Vec3::X * x), JointKind::Ball { limit: None });
        let target = Transform::new(Vec3::ZERO, Rotation::from_scaled_axis(axis));
        def.motor = Some(Motor { max_torque: 40.0, ..Motor::toward(target, spring(2.0, 1.0)) });
        world.add_joint(&def);
    }
    let mut most: f32 = 0.0;
    for step in 0..180 {
        let before = world.energy();
        world.step();
        let after = world.energy();
        let rise = after.kinetic - before.kinetic - world.work().total();
        assert!(
            rise <= 0.01 * before.kinetic.max(20.2),
            "step {step}: the energy rose by {rise} J from {} J",
            before.kinetic
        );
        most = most.max(after.kinetic);
    }
    assert!(most > 2.0, "the drives must move the chain; kinetic energy {most} J");
}

#[test]
fn a_slider_slides_along_its_axis_alone_and_stops_at_its_end() {
    let mut world = world(G);
    let a = anchor(&mut world);
    let b = mass_without_shape(&mut world, Vec3::ZERO, 2.0, 0.1);
    let down = Rotation::from_axis_angle(Vec3::Z, -0.5);
    let limit = Some(Range::new(-1.0, 2.0));
    let def = joint(&world, a, b, Transform::new(Vec3::ZERO, down), JointKind::Slider { limit });
    let id = world.add_joint(&def);
    run(&mut world, 0.5);
    let slid = world.joint_transform(id);
    // Symplectic Euler falls as if half a substep longer.
    let expected = 0.5 * G * trig::sin(0.5) * 0.5 * (0.5 + 1.0 / 240.0);
    assert_near(slid.translation.x, expected, 0.005, "travel");
    assert!(slid.translation.y.abs() < 1e-4 && slid.rotation.angle_to(Rotation::IDENTITY) < 1e-3);
    run(&mut world, 2.0);
    assert!((world.joint_transform(id).translation.x - 2.0).abs() < 1e-3, "the slider must stop at its end");
    assert!(world.velocity(b).linear.length() < 1e-3);
    world.set_motor(id, Some(Motor::push(-1.0, 100.0)));
    run(&mut world, 1.0);
    assert_near(
        world.joint_transform(id).translation.x,
        1.0,
        0.02,
        "position after the motor drives the slider back",
    );
}

#[test]
fn distance_joints_act_as_rods_ropes_and_springs() {
    // A rod swings at its length.
    let mut rod = world(G);
    let a = anchor(&mut rod);
    let b = mass_without_shape(&mut rod, Vec3::X, 1.0, 0.01);
    let kind = JointKind::Distance { range: Range::new(1.0, 1.0) };
    let id = rod.add_joint(&JointDef::between(a, b, Transform::IDENTITY, Transform::IDENTITY, kind));
    for _ in 0..300 {
        rod.step();
        assert!(rod.joint_gap(id) < 1e-4, "the rod must keep its length; gap {} m", rod.joint_gap(id));
    }
    // A rope lets its end fall freely, then stops it.
    let mut rope = world(G);
    let a = anchor(&mut rope);
    let b = mass_without_shape(&mut rope, Vec3::X * 0.1, 1.0, 0.01);
    let kind = JointKind::Distance { range: Range::new(0.0, 1.5) };
    let id = rope.add_joint(&JointDef::between(a, b, Transform::IDENTITY, Transform::IDENTITY, kind));
    run(&mut rope, 0.3);
    assert_near(-rope.center_of_mass(b).y, 0.5 * G * 0.3 * (0.3 + 1.0 / 240.0), 0.01, "slack");
    for _ in 0..600 {
        rope.step();
        assert!(rope.joint_gap(id) < 5e-3, "the rope must stop its end; gap {} m", rope.joint_gap(id));
    }
    // A spring stretches by mg/k.
    let mut elastic = world(G);
    let a = anchor(&mut elastic);
    let b = mass_without_shape(&mut elastic, Vec3::NEG_Y, 3.0, 0.01);
    let kind = JointKind::Distance { range: Range::new(0.0, 100.0) };
    let mut def = JointDef::between(a, b, Transform::IDENTITY, Transform::IDENTITY, kind);
    def.spring = Some(Spring {
        softness: Softness::Stiffness { stiffness: 500.0, damping: 30.0 },
        rest: Transform::from_translation(Vec3::X),
    });
    elastic.add_joint(&def);
    run(&mut elastic, 10.0);
    assert_near(-elastic.center_of_mass(b).y - 1.0, 3.0 * G / 500.0, 0.005, "mg/k");
}

#[test]
fn an_undamped_spring_keeps_its_period_and_energy() {
    let mut world = world(0.0);
    let a = anchor(&mut world);
    let b = mass_without_shape(&mut world, Vec3::X * 0.2, 2.0, 0.1);
    let kind = JointKind::Slider { limit: None };
    let mut def = JointDef::between(a, b, Transform::IDENTITY, Transform::IDENTITY, kind);
    def.spring = Some(Spring { softness: spring(1.5, 0.0), rest: Transform::IDENTITY });
    world.add_joint(&def);
    for step in 1..=600 {
        world.step();
        let expected = 0.2 * trig::cos(core::f32::consts::TAU * 1.5 * step as f32 / 60.0);
        let found = world.center_of_mass(b).x;
        assert!((found - expected).abs() < 0.008, "step {step}: position {found} m, expected {expected} m");
    }
}

#[test]
fn a_soft_weld_bends_under_load_by_its_stiffness() {
    let mut world = world(G);
    let a = anchor(&mut world);
    let b = mass_without_shape(&mut world, Vec3::X * 0.5, 1.0, 0.05);
    let mut def = joint(&world, a, b, Transform::IDENTITY, JointKind::Fixed);
    def.weld = Some(Softness::Stiffness { stiffness: 400.0, damping: 40.0 });
    let id = world.add_joint(&def);
    run(&mut world, 8.0);
    let bent = world.joint_transform(id);
    let moment = G * world.center_of_mass(b).x;
    assert_near(-bent.rotation.to_scaled_axis().z, moment / 400.0, 0.02, "bend");
    assert_near(-bent.translation.y, G / 400.0, 0.02, "sag");
    let exact = joint(&world, a, b, Transform::IDENTITY, JointKind::Fixed);
    let exact = JointDef { frame_a: exact.frame_a, frame_b: def.frame_b, ..exact };
    world.set_joint(id, &exact);
    run(&mut world, 1.0);
    assert!(
        world.joint_gap(id) < 1e-4 && world.joint_transform(id).rotation.angle_to(Rotation::IDENTITY) < 1e-3
    );
}

#[test]
fn six_dof_directions_are_free_or_locked_as_defined() {
    use AxisMotion::{Free, Limited, Locked};
    // The joint is free along x and about z only.
    let six = SixDof {
        linear: [Free, Locked, Limited(Range::new(-0.1, 0.1))],
        twist: Locked,
        swing_y: Locked,
        swing_z: Free,
    };
    let mut world = world(0.0);
    let a = anchor(&mut world);
    let b = mass_without_shape(&mut world, Vec3::ZERO, 1.0, 0.1);
    let kind = JointKind::SixDof(six);
    let id = world.add_joint(&joint(&world, a, b, Transform::IDENTITY, kind));
    world.set_velocity(b, Velocity { linear: Vec3::new(1.0, 1.0, 1.0), angular: Vec3::new(1.0, 1.0, 1.0) });
    for _ in 0..60 {
        world.step();
        assert!(world.joint_gap(id) < 1e-3);
    }
    let seen = world.joint_transform(id);
    assert_near(seen.translation.x, 1.0, 0.01, "translation along the free axis");
    assert!(seen.translation.y.abs() < 1e-4 && (seen.translation.z - 0.1).abs() < 2e-3, "{seen:?}");
    let v = seen.rotation.to_scaled_axis();
    assert!(v.x.abs() < 5e-3 && v.y.abs() < 5e-3, "{v}");
    assert_near(v.z, 1.0, 0.02, "rotation rate about the free axis");
}

#[test]
fn drag_joint_pulls_with_at_most_its_force() {
    let mut world = world(G);
    let hand = anchor(&mut world);
    let b = mass_without_shape(&mut world, Vec3::new(2.0, 0.0, 0.0), 3.0, 0.1);
    let id = world.add_joint(&JointDef::drag(hand, b, Vec3::ZERO, spring(3.0, 1.0), 200.0));
    run(&mut world, 4.0);
    let omega = core::f32::consts::TAU * 3.0;
    let sag = G / (omega * omega);
    assert!(
        (world.center_of_mass(b) - Vec3::NEG_Y * sag).length() < 0.02 * sag + 1e-4,
        "{}",
        world.center_of_mass(b)
    );
    let weak =
        Motor { max_force: 20.0, max_torque: 0.0, ..world.joint(id).motor.expect("the joint has a motor") };
    world.set_motor(id, Some(weak));
    let before = world.center_of_mass(b).y;
    run(&mut world, 1.0);
    // Pull of 20 N against a weight of 29.43 N.
    assert_near(
        before - world.center_of_mass(b).y,
        0.5 * (G - 20.0 / 3.0),
        0.02,
        "fall while the joint pulls with 20 N",
    );
}

#[test]
fn friction_slows_a_hinge_by_its_torque() {
    let (mut world, b, mut def) = arm(0.0);
    def.friction_torque = 0.5;
    world.add_joint(&def);
    world.set_velocity(b, Velocity { linear: Vec3::Y * 2.5, angular: Vec3::Z * 5.0 });
    run(&mut world, 2.0);
    assert_near(world.velocity(b).angular.z, 5.0 - 2.0 * 0.5 / ARM_MOMENT, 0.02, "slowed");
    run(&mut world, 6.0);
    assert!(world.velocity(b).angular.length() < 1e-3, "friction must stop the hinge");
}

#[test]
fn friction_set_later_acts_immediately() {
    let (mut world, b, def) = arm(0.0);
    let id = world.add_joint(&def);
    world.set_velocity(b, Velocity { linear: Vec3::Y * 2.5, angular: Vec3::Z * 5.0 });
    run(&mut world, 1.0);
    assert_near(world.velocity(b).angular.z, 5.0, 0.001, "speed without friction");
    world.set_joint_friction(id, 0.5);
    assert_eq!(world.joint(id).friction_torque, 0.5);
    run(&mut world, 2.0);
    assert_near(world.velocity(b).angular.z, 5.0 - 2.0 * 0.5 / ARM_MOMENT, 0.02, "slowed");
}

#[test]
fn reactions_equal_the_hanging_weights() {
    let mut world = world(G);
    let mut last = anchor(&mut world);
    let mut joints = Vec::new();
    for i in 0..5 {
        let b = mass_without_shape(&mut world, Vec3::NEG_Y * (i as f32 + 0.5), 1.0 + i as f32, 0.1);
        joints.push(world.add_joint(&ball(&world, last, b, Vec3::NEG_Y * i as f32)));
        last = b;
    }
    run(&mut world, 1.0);
    for (i, &id) in joints.iter().enumerate() {
        let below: f32 = (i..5).map(|k| 1.0 + k as f32).sum();
        assert_near(
            world.reaction(id).force.y,
            below * G,
            0.001,
            "force of the joint, which carries the weight below it",
        );
    }
    // Beam fixed at one end: the moment is that of its weight.
    let mut beam = self::world(G);
    let a = anchor(&mut beam);
    let b = mass_without_shape(&mut beam, Vec3::X * 0.5, 4.0, 0.3);
    let id = beam.add_joint(&joint(&beam, a, b, Transform::IDENTITY, JointKind::Fixed));
    run(&mut beam, 0.5);
    assert_near(beam.reaction(id).torque.z, 4.0 * G * 0.5, 0.001, "moment of the beam");
}

#[test]
fn reactions_include_weights_on_springs() {
    let mut world = world(G);
    let a = anchor(&mut world);
    let b = mass_without_shape(&mut world, Vec3::NEG_Y * 0.5, 1.0, 0.1);
    let id = world.add_joint(&ball(&world, a, b, Vec3::ZERO));
    let (from, to) = (Vec3::NEG_Y * 0.5, Vec3::NEG_Y * 1.5);
    let mut rope = RopeDef { from, to, links: 8, mass: 0.2, stiffness: 1e4, radius: 0.01 }.build().group;
    let target = AttachmentTarget::Body { body: b, point: Vec3::ZERO };
    rope.attachments = vec![AttachmentDef { particle: 0, target }];
    world.add_particles(&rope);
    run(&mut world, 3.0);
    assert_near(world.reaction(id).force.y, 1.2 * G, 0.0005, "weight of the body and its rope");
}

#[test]
fn joints_break_above_their_strength_and_report() {
    for (strength, breaks) in [(18.0, true), (21.0, false)] {
        let mut world = world(G);
        let a = anchor(&mut world);
        let b = mass_without_shape(&mut world, Vec3::NEG_Y, 2.0, 0.1); // 19.62 N
        let mut def = ball(&world, a, b, Vec3::ZERO);
        def.strength = Strength { force: strength, ..Strength::UNBREAKABLE };
        let id = world.add_joint(&def);
        let mut told = 0;
        for _ in 0..60 {
            world.step();
            told += world.events().broken.len();
        }
        assert_eq!(told, usize::from(breaks), "strength {strength}");
        assert_eq!(world.joint(id).state == JointState::Disabled, breaks);
        assert_eq!(
            world.center_of_mass(b).y < -1.5,
            breaks,
            "the body must fall exactly if the joint breaks"
        );
        if breaks {
            world.set_joint(
                id,
                &JointDef { state: JointState::Enabled, ..ball(&world, a, b, world.center_of_mass(b)) },
            );
            let y = world.center_of_mass(b).y;
            world.set_velocity(b, Velocity::default());
            run(&mut world, 1.0);
            assert!(
                (world.center_of_mass(b).y - y).abs() < 1e-3,
                "the joint must attach the body where it is"
            );
        }
    }
    // Breaks by torque.
    let mut world = world(G);
    let a = anchor(&mut world);
    let b = mass_without_shape(&mut world, Vec3::X, 1.0, 0.1);
    let mut def = joint(&world, a, b, Transform::IDENTITY, JointKind::Fixed);
    def.strength = Strength { torque: 9.0, ..Strength::UNBREAKABLE };
    world.add_joint(&def);
    world.step();
    assert_eq!(world.events().broken.len(), 1);
}

#[test]
fn soft_limits_yield_by_their_stiffness() {
    let (mut world, b, mut def) = arm(G);
    def.kind = JointKind::Hinge { limit: Some(Range::new(-0.2, 1.0)) };
    def.limit_softness = Some(Softness::Stiffness { stiffness: 100.0, damping: 10.0 });
    world.add_joint(&def);
    run(&mut world, 5.0);
    let at = -angle(&world, b);
    assert_near(at - 0.2, G * trig::cos(at) / 100.0, 0.02, "beyond the soft stop");
}

#[test]
fn a_soft_zone_brakes_before_the_stop() {
    let hardest = |zone: Option<SoftZone>| {
        let (mut world, b, mut def) = arm(0.0);
        def.kind = JointKind::Hinge { limit: Some(Range::new(-1.0, 1.0)) };
        def.soft_zone = zone;
        let id = world.add_joint(&def);
        world.set_velocity(b, Velocity { linear: Vec3::Y * 2.0, angular: Vec3::Z * 4.0 });
        let mut hardest = 0.0f32;
        for _ in 0..120 {
            world.step();
            hardest = hardest.max(world.reaction(id).torque.length());
            assert!(world.joint_overshoot(id) < 0.01);
        }
        hardest
    };
    let hard = hardest(None);
    let soft = hardest(Some(SoftZone { width: 0.2, softness: spring(5.0, 0.7) }));
    assert!(soft < 0.5 * hard, "peak torque {soft} N·m with the spring, {hard} N·m without");
}

#[test]
fn limits_hold_against_load_for_every_kind() {
    let cone = SwingTwistLimit {
        swing_y: Range::degrees(-30.0, 40.0),
        swing_z: Range::degrees(-20.0, 25.0),
        twist: Range::degrees(-10.0, 15.0),
    };
    let six = SixDof {
        linear: [AxisMotion::Limited(Range::new(-0.2, 0.3)); 3],
        twist: AxisMotion::Limited(Range::degrees(-10.0, 10.0)),
        swing_y: AxisMotion::Limited(Range::degrees(-20.0, 20.0)),
        swing_z: AxisMotion::Locked,
    };
    let kinds = [
        JointKind::Ball { limit: Some(cone) },
        JointKind::Universal { limit: Some(cone) },
        JointKind::Hinge { limit: Some(Range::degrees(-30.0, 45.0)) },
        JointKind::Slider { limit: Some(Range::new(-0.3, 0.5)) },
        JointKind::SixDof(six),
        JointKind::Distance { range: Range::new(0.2, 0.9) },
    ];
    for kind in kinds {
        for pull in [Vec3::new(3.0, -9.0, 4.0), Vec3::new(-9.0, 2.0, -5.0), Vec3::new(0.5, 9.0, 9.0)] {
            let mut world =
                World::new(WorldDef { gravity: pull, sleeping: Sleeping::Off, ..WorldDef::default() });
            let a = anchor(&mut world);
            let b = mass_without_shape(&mut world, Vec3::X * 0.5, 2.0, 0.08);
            let mut def = joint(&world, a, b, Transform::IDENTITY, kind);
            if matches!(kind, JointKind::Distance { .. }) {
                def.frame_b = Transform::IDENTITY;
            }
            def.friction_torque = 0.2;
            let id = world.add_joint(&def);
            world.set_velocity(b, Velocity { linear: Vec3::ZERO, angular: Vec3::new(4.0, -2.0, 3.0) });
            let (mut gap, mut over) = (0.0f32, 0.0f32);
            for _ in 0..600 {
                world.step();
                gap = gap.max(world.joint_gap(id));
                over = over.max(world.joint_overshoot(id));
            }
            assert!(gap < 5e-3 && over < 0.02, "{kind:?} under {pull}: gap {gap} m, overshoot {over} rad");
        }
    }
}

/// A parallelogram of four bars hinged about z, hung by the ends of its upper bar: three moving bars, four hinges, and
/// one loop with redundant rows.
#[test]
fn a_four_bar_linkage_of_hinges_stays_closed() {
    let mut world = world(G);
    let a = anchor(&mut world);
    let bar = |world: &mut World, at: Vec3| mass_without_shape(world, at, 1.0, 0.1);
    let left = bar(&mut world, Vec3::new(0.0, -0.5, 0.0));
    let right = bar(&mut world, Vec3::new(1.0, -0.5, 0.0));
    let low = bar(&mut world, Vec3::new(0.5, -1.0, 0.0));
    let mut joints = Vec::new();
    for (p, q, at) in [
        (a, left, Vec3::ZERO),
        (a, right, Vec3::X),
        (left, low, Vec3::NEG_Y),
        (right, low, Vec3::new(1.0, -1.0, 0.0)),
    ] {
        joints.push(world.add_joint(&joint(&world, p, q, facing(at), HINGE)));
    }
    world.apply_impulse(low, Vec3::X * 6.0, world.center_of_mass(low));
    world.step(); // the blow reaches the other bars
    let start = world.energy().total();
    let (mut gap, mut swing) = (0.0f32, 0.0f32);
    for _ in 0..1200 {
        world.step();
        gap = joints.iter().map(|&id| world.joint_gap(id)).fold(gap, f32::max);
        swing = swing.max(world.center_of_mass(low).x - 0.5);
        let level = world.transform(low).rotation.angle_to(Rotation::IDENTITY);
        assert!(level < 5e-3, "the lower bar must stay level; angle {level}");
    }
    let drift = (world.energy().total() - start) / (3.0 * G);
    assert!(gap < 1e-4, "the loop must stay closed; gap {gap} m");
    assert!(drift.abs() < 0.01, "energy drift {drift}");
    assert!(swing > 0.2, "the linkage must swing; amplitude {swing}");
}

#[test]
fn a_ring_of_links_hangs_from_two_points_without_a_gap() {
    let mut world = world(G);
    let a = anchor(&mut world);
    let n = 8;
    let at = |i: usize| {
        let angle = core::f32::consts::TAU * i as f32 / n as f32;
        Vec3::new(trig::cos(angle), trig::sin(angle), 0.0)
    };
    let links: Vec<BodyId> = (0..n)
        .map(|i| mass_without_shape(&mut world, (at(i) + at(i + 1)) * 0.5, 1.0 + 20.0 * (i % 2) as f32, 0.02))
        .collect();
    let mut joints = Vec::new();
    for i in 0..n {
        joints.push(world.add_joint(&ball(&world, links[i], links[(i + 1) % n], at(i + 1))));
    }
    joints.push(world.add_joint(&ball(&world, a, links[0], at(0))));
    joints.push(world.add_joint(&ball(&world, a, links[2], at(3))));
    let mut gap = 0.0f32;
    for _ in 0..900 {
        world.step();
        gap = joints.iter().map(|&id| world.joint_gap(id)).fold(gap, f32::max);
    }
    assert!(gap < 1e-3, "the loop must stay closed; gap {gap} m");
}

#[test]
fn a_stiff_spring_that_pulls_beyond_a_stop_rests_at_it() {
    let (mut world, b, mut def) = arm(0.0);
    def.kind = JointKind::Hinge { limit: Some(Range::new(-0.3, 1.0)) };
    let softness = Softness::Stiffness { stiffness: 4e5, damping: 4e3 };
    def.spring = Some(Spring { softness, rest: turned(-0.9) });
    world.add_joint(&def);
    for step in 0..240 {
        world.step();
        let (at, speed) = (angle(&world, b), world.velocity(b).angular.length());
        assert!(at > -0.32, "step {step}: angle {at} rad is beyond the stop");
        assert!(step < 60 || speed < 0.01, "step {step}: spins at {speed} rad/s");
    }
}

#[test]
fn a_damped_weld_holds_a_body_that_turns() {
    // The load m ω² r stretches the weld by 1.5 µm; rows along the initial direction would lose 0.1 mm per substep.
    let mut world = world(0.0);
    let anchor = anchor(&mut world);
    let b = mass_without_shape(&mut world, Vec3::X * 0.3, 0.05, 1e-4);
    let at = Transform::IDENTITY;
    let softness = Softness::Stiffness { stiffness: 1e6, damping: 1e5 };
    let id = world.add_joint(&JointDef {
        weld: Some(softness),
        ..JointDef::new(
            anchor,
            b,
            Transform::IDENTITY,
            world.transform(b),
            at,
            JointKind::Ball { limit: None },
        )
    });
    world.set_velocity(b, Velocity { linear: Vec3::Y * 3.0, angular: Vec3::Z * 10.0 });
    run(&mut world, 5.0);
    assert!(world.joint_gap(id) < 1e-5, "joint gap {} m", world.joint_gap(id));
}
