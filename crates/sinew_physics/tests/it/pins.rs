//! Pins (springs and motors from bodies to the world), bodies that become kinematic, and the work of both.

use crate::build::ball;
use sinew_math::{Reader, Sym3, Transform, Vec3, Writer};
use sinew_physics::particles::{AttachmentDef, AttachmentTarget, RopeDef};
use sinew_physics::*;

const G: f32 = 9.81;

fn world() -> World {
    World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() })
}

fn lump(world: &mut World, position: Vec3, mass: f32) -> BodyId {
    let inertia = Sym3::from_diagonal(Vec3::new(0.01, 0.02, 0.03) * mass);
    let mass = Some(MassProperties { mass, center: Vec3::ZERO, inertia });
    world.add_body(&BodyDef { position, mass, ..BodyDef::default() })
}

fn ground(world: &mut World) -> BodyId {
    world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() })
}

fn pin(world: &mut World, ground: BodyId, body: BodyId, softness: Softness) -> JointId {
    let here = world.transform(body);
    let kind = JointKind::SixDof(SixDof::FREE);
    world.add_joint(&JointDef {
        motor: Some(Motor::toward(here, softness)),
        collision: JointCollision::Enabled,
        ..JointDef::between(ground, body, Transform::IDENTITY, Transform::IDENTITY, kind)
    })
}

fn run(world: &mut World, seconds: f32) {
    for _ in 0..(seconds * 60.0) as usize {
        world.step();
    }
}

fn frequency(hertz: f32, damping_ratio: f32) -> Softness {
    Softness::Frequency { hertz, damping_ratio }
}

fn omega2(hertz: f32) -> f32 {
    (core::f32::consts::TAU * hertz) * (core::f32::consts::TAU * hertz)
}

/// Adds `count` links of different masses in a row along x, half a metre apart, with joints between neighbours.
fn chain(world: &mut World, count: usize) -> (Vec<BodyId>, Vec<JointId>) {
    let bodies: Vec<BodyId> =
        (0..count).map(|i| lump(world, Vec3::new(0.5 * i as f32, 1.0, 0.0), 1.0 + (i % 3) as f32)).collect();
    let joints = bodies
        .windows(2)
        .enumerate()
        .map(|(i, pair)| {
            let def = ball(world, pair[0], pair[1], Vec3::new(0.5 * i as f32 + 0.25, 1.0, 0.0));
            world.add_joint(&def)
        })
        .collect();
    (bodies, joints)
}

fn weight(world: &World, bodies: &[BodyId]) -> f32 {
    bodies.iter().map(|&body| world.mass(body).mass).sum::<f32>() * G
}

#[test]
fn a_pinned_body_sags_by_weight_over_stiffness() {
    for stiffness in [500.0, 5e4, 1e6] {
        let mut world = world();
        let ground = ground(&mut world);
        let body = lump(&mut world, Vec3::Y, 3.0);
        let damping = 2.0 * (stiffness * 3.0f32).sqrt();
        let id = pin(&mut world, ground, body, Softness::Stiffness { stiffness, damping });
        run(&mut world, 2.0);
        let sag = 1.0 - world.center_of_mass(body).y;
        let expected = 3.0 * G / stiffness;
        assert!((sag - expected).abs() < 0.005 * expected + 2e-7, "sag {sag} m, expected {expected} m");
        let force = world.reaction(id).force;
        assert!((force - Vec3::Y * 3.0 * G).length() < 0.002 * 3.0 * G, "reaction of the pin {force} N");
    }
}

#[test]
fn chain_with_every_link_pinned_keeps_its_joints_closed() {
    let mut world = world();
    let ground = ground(&mut world);
    let (bodies, joints) = chain(&mut world, 12);
    let pins: Vec<_> =
        bodies.iter().map(|&body| pin(&mut world, ground, body, frequency(20.0, 2.0))).collect();
    for i in 0..240 {
        if i == 60 {
            world.apply_impulse_at_center(bodies[5], Vec3::new(3.0, 20.0, 10.0));
        }
        world.step();
        for &joint in &joints {
            assert!(world.joint_gap(joint) < 5e-6, "step {i}: joint gap {} m", world.joint_gap(joint));
        }
    }
    for (&body, &pin) in bodies.iter().zip(&pins) {
        let mass = world.mass(body).mass;
        let sag = 1.0 - world.center_of_mass(body).y;
        let expected = G / omega2(20.0);
        assert!((sag - expected).abs() < 0.01 * expected, "sag {sag} m, expected {expected} m");
        let force = world.reaction(pin).force;
        assert!((force - Vec3::Y * mass * G).length() < 0.01 * mass * G, "reaction of the pin {force} N");
    }
}

#[test]
fn pins_at_the_ends_carry_a_chain() {
    let mut world = world();
    let ground = ground(&mut world);
    let (bodies, joints) = chain(&mut world, 9);
    let pins = [0, 8].map(|end| pin(&mut world, ground, bodies[end], frequency(5.0, 1.0)));
    run(&mut world, 20.0);
    let carried: Vec3 = pins.iter().map(|&pin| world.reaction(pin).force).sum();
    let weight = weight(&world, &bodies);
    assert!(
        (carried - Vec3::Y * weight).length() < 0.01 * weight,
        "pin force {carried} N, weight {weight} N"
    );
    assert!(joints.iter().all(|&joint| world.joint_gap(joint) < 1e-5));
}

#[test]
fn a_weak_pin_pulls_with_its_cap() {
    let mut world = world();
    let ground = ground(&mut world);
    let body = lump(&mut world, Vec3::Y, 4.0);
    let id = pin(&mut world, ground, body, frequency(10.0, 1.0));
    let motor = world.joint(id).motor.expect("the pin has a motor");
    world.set_motor(id, Some(Motor { max_force: 30.0, ..motor }));
    run(&mut world, 1.0);
    assert!(
        (world.reaction(id).force.y - 30.0).abs() < 0.01,
        "the pin pulls with {}, expected its cap of 30 N",
        world.reaction(id).force
    );
    let fall = 1.0 - world.center_of_mass(body).y;
    let expected = 0.5 * (G - 30.0 / 4.0);
    assert!((fall - expected).abs() < 0.03 * expected, "fell {fall} m, expected {expected} m");
}

#[test]
fn an_underdamped_pin_on_a_light_end_does_not_shake() {
    let mut world = world();
    let ground = ground(&mut world);
    let (bodies, _) = chain(&mut world, 6);
    let end = lump(&mut world, Vec3::new(2.75, 1.0, 0.0), 0.01);
    let def = ball(&world, bodies[5], end, Vec3::new(2.7, 1.0, 0.0));
    world.add_joint(&def);
    // The pin carries the weight of 12 kg, but the moment of inertia at the pin is only a ten-thousandth of theirs.
    pin(&mut world, ground, end, frequency(15.0, 0.3));
    run(&mut world, 0.2);
    for _ in 0..120 {
        world.step();
        let spin = world.velocity(end).angular.length();
        assert!(spin < 5.0, "the light end spins at {spin} rad/s");
    }
}

#[test]
fn pins_allocate_nothing_once_warm() {
    let mut world = world();
    let ground = ground(&mut world);
    let (bodies, _) = chain(&mut world, 8);
    let pins: Vec<_> =
        bodies.iter().map(|&body| pin(&mut world, ground, body, frequency(6.0, 0.5))).collect();
    world.set_kind(bodies[3], BodyKind::Kinematic);
    run(&mut world, 0.5);
    let motor = world.joint(pins[0]).motor.expect("the pin has a motor");
    let mut cycle = || {
        for i in 0..60 {
            let target = Transform::from_translation(Vec3::Y * (1.0 + 0.01 * i as f32));
            world.set_motor(pins[0], Some(Motor { target, ..motor }));
            let kind = if i % 20 < 10 { BodyKind::Kinematic } else { BodyKind::Dynamic };
            world.set_kind(bodies[3], kind);
            world.step();
        }
    };
    cycle();
    assert_eq!(allocation_counter::measure(cycle).count_total, 0);
}

#[test]
fn energy_rises_by_at_most_the_work_of_pins() {
    let mut world = world();
    let ground = ground(&mut world);
    let (bodies, _) = chain(&mut world, 8);
    let pins: Vec<_> =
        bodies.iter().map(|&body| pin(&mut world, ground, body, frequency(6.0, 0.5))).collect();
    let starts: Vec<Transform> = bodies.iter().map(|&body| world.transform(body)).collect();
    let (mut rise, mut work) = (0.0, 0.0);
    for step in 0..300 {
        let time = step as f32 / 60.0;
        for (&pin, start) in pins.iter().zip(&starts) {
            let up = Vec3::Y * 0.3 * sinew_math::trig::sin(4.0 * time);
            let motor = world.joint(pin).motor.expect("the pin has a motor");
            let target = Transform::new(start.translation + up, start.rotation);
            world.set_motor(pin, Some(Motor { target, ..motor }));
        }
        let before = world.energy();
        world.step();
        let after = world.energy();
        let gain = (after.kinetic - before.kinetic) + (after.potential - before.potential);
        let done = world.work().drives;
        assert!(
            gain <= done + 1e-3 * before.kinetic + 1e-3,
            "step {step}: the energy rose by {gain} J, work {done} J"
        );
        rise += gain;
        work += done.abs();
    }
    assert!(work > 100.0 && rise < 0.5 * work, "the pins did {work} J of work, the energy rose by {rise} J");
}

#[test]
fn a_body_made_kinematic_and_back_keeps_its_properties() {
    let mut world = world();
    let (bodies, joints) = chain(&mut world, 6);
    let before = world.mass(bodies[2]);
    world.set_kind(bodies[2], BodyKind::Kinematic);
    assert_eq!(world.mass(bodies[2]).mass, 0.0);
    let velocity = Velocity { linear: Vec3::new(0.5, 0.2, 0.0), angular: Vec3::Y * 0.7 };
    world.set_velocity(bodies[2], velocity);
    let start = world.transform(bodies[2]);
    let mut saved = Writer::new();
    for i in 0..120 {
        if i == 60 {
            world.save(&mut saved);
        }
        world.step();
    }
    let moved = world.transform(bodies[2]).translation - start.translation;
    assert!((moved - velocity.linear * 2.0).length() < 1e-4, "the kinematic body moved by {moved}");
    assert!(
        joints.iter().all(|&joint| world.joint_gap(joint) < 1e-5),
        "a joint of the chain that hangs on the kinematic body is open"
    );
    let hash = world.hash();
    world.load(&mut Reader::new(saved.as_bytes())).expect("the snapshot must load");
    run(&mut world, 1.0);
    assert_eq!(world.hash(), hash);
    world.set_kind(bodies[2], BodyKind::Dynamic);
    assert_eq!(world.mass(bodies[2]), before);
    let momentum = world.momentum().linear;
    world.step();
    let lost = momentum - world.momentum().linear;
    assert!(
        (lost - Vec3::Y * weight(&world, &bodies) / 60.0).length() < 1e-3,
        "the ragdoll must fall freely; lost momentum {lost}"
    );
}

#[test]
fn kinematic_bodies_report_work_on_joints_and_contacts() {
    let mut world = world();
    let (bodies, _) = chain(&mut world, 4);
    world.set_kind(bodies[0], BodyKind::Kinematic);
    let plate = world.add_body(
        &BodyDef::kinematic(Shape::Box { half_extents: Vec3::new(1.0, 0.1, 1.0) })
            .at(Vec3::new(-5.0, 0.0, 0.0)),
    );
    world.add_body(&BodyDef::dynamic(Shape::Sphere { radius: 0.2 }).at(Vec3::new(-5.0, 0.3, 0.0)));
    run(&mut world, 5.0);
    for (id, speed) in [(bodies[0], 0.4), (plate, 0.6)] {
        world.set_velocity(id, Velocity { linear: Vec3::Y * speed, ..Velocity::default() });
    }
    let before = world.energy();
    let mut work = 0.0;
    for _ in 0..120 {
        world.step();
        work += world.work().kinematic;
    }
    let after = world.energy();
    let rise = (after.kinetic - before.kinetic) + (after.potential - before.potential);
    assert!(
        rise > 50.0 && (rise - work).abs() < 0.03 * rise,
        "the energy rose by {rise} J, work of the kinematic body {work} J"
    );
}

#[test]
fn kinematic_bodies_report_work_on_particles() {
    let lift = |held: bool| {
        let mut world = world();
        let half_extents = Vec3::new(1.0, 0.1, 1.0);
        let plate = world.add_body(&BodyDef::kinematic(Shape::Box { half_extents }));
        let place = Vec3::Y * if held { -1.0 } else { 0.15 };
        let rope = RopeDef {
            from: place,
            to: place + Vec3::X * 0.5,
            links: 5,
            mass: 2.0,
            stiffness: 1e4,
            radius: 0.05,
        };
        let mut group = rope.build().group;
        if held {
            let target = AttachmentTarget::Body { body: plate, point: place };
            group.attachments.push(AttachmentDef { particle: 0, target });
        }
        group.linear_damping = 2.0;
        world.add_particles(&group);
        run(&mut world, 5.0);
        world.set_velocity(plate, Velocity { linear: Vec3::Y * 0.5, ..Velocity::default() });
        // The body has reached the speed, and the oscillation of the start has decayed.
        run(&mut world, 3.0);
        let (before, mut work) = (world.energy().total(), 0.0);
        for _ in 0..120 {
            world.step();
            work += world.work().kinematic;
        }
        (world.energy().total() - before, work)
    };
    // m g v t; the loss to air damping is added below.
    let expected = 2.0 * 9.81 * 0.5 * 2.0;
    for held in [true, false] {
        let (rise, work) = lift(held);
        println!("held: {held}, the energy rose by {rise} J, work {work} J");
        assert!((rise - expected).abs() < 0.01 * expected, "held: {held}, energy rise {rise} J");
        // A body of 2 kg loses 2 v per second to the air.
        let drag = 2.0 * 2.0 * 0.5 * 0.5 * 2.0;
        assert!(
            (work - rise - drag).abs() < 0.03 * expected,
            "held: {held}, energy rise {rise} J, work {work} J"
        );
    }
}
