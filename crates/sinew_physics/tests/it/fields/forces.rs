//! Forces, impulses and bullet impacts that the user applies.

use super::closed_forms::{point_mass, run, weightless};
use crate::build::{ball, box_body, sphere_body};
use sinew_math::{Rotation, Vec3};
use sinew_physics::*;

#[test]
fn a_lasting_force_equals_a_force_each_step() {
    let (mut lasting, mut stepwise) = (weightless(), weightless());
    let def = box_body(Vec3::new(0.1, 0.2, 0.3), Vec3::ZERO);
    let a = lasting.add_body(&def);
    let b = stepwise.add_body(&def);
    let force = Vec3::new(20.0, 3.0, -5.0);
    let id = lasting.add_force(a, &ForceDef { force, ..ForceDef::default() });
    for _ in 0..60 {
        lasting.step();
        stepwise.apply_force_at_center(b, force);
        stepwise.step();
    }
    assert_eq!(lasting.velocity(a), stepwise.velocity(b));
    let expected = force / lasting.mass(a).mass * (60.0 * lasting.def().dt());
    assert!((lasting.velocity(a).linear - expected).length() < 1e-5 * expected.length());
    assert_eq!(lasting.velocity(a).angular, Vec3::ZERO);
    lasting.set_force(id, &ForceDef { force: -force, ..ForceDef::default() });
    run(&mut lasting, 60);
    assert!(lasting.velocity(a).linear.length() < 1e-4, "the opposite force must stop the body");
    lasting.remove_force(id);
    let before = lasting.velocity(a);
    run(&mut lasting, 10);
    assert_eq!(lasting.velocity(a), before);
    assert_eq!(lasting.forces_of(a).count(), 0);
}

#[test]
fn off_centre_push_also_rotates_the_body() {
    let mut world = weightless();
    let id = world.add_body(&sphere_body(0.5, Vec3::ZERO));
    let (mass, moment) = (world.mass(id).mass, world.mass(id).inertia.diagonal.z);
    let at = Vec3::Y * 0.3;
    for _ in 0..30 {
        let point = world.center_of_mass(id) + at;
        world.apply_force(id, Vec3::X * 100.0, point);
        world.step();
    }
    let time = 30.0 * world.def().dt();
    let v = world.velocity(id);
    assert!((v.linear.x / (100.0 / mass * time) - 1.0).abs() < 1e-5, "a = F/m: {v:?}");
    assert!((v.angular.z / (-30.0 / moment * time) - 1.0).abs() < 1e-5, "α = r × F / I: {v:?}");
}

#[test]
fn a_thruster_turns_with_its_body() {
    let mut world = weightless();
    let id = world.add_body(&BodyDef { angular_velocity: Vec3::Z * 2.0, ..sphere_body(0.5, Vec3::ZERO) });
    let mass = world.mass(id).mass;
    let thrust = ForceDef { force: Vec3::X * mass, frame: ForceFrame::Body, ..ForceDef::default() };
    world.add_force(id, &thrust);
    run(&mut world, 120);
    // v = ∫ (cos ωt, sin ωt) dt
    let angle = 2.0 * 120.0 * world.def().dt();
    let (sin, cos) = sinew_math::trig::sin_cos(angle);
    let expected = Vec3::new(0.5 * sin, 0.5 * (1.0 - cos), 0.0);
    assert!((world.velocity(id).linear - expected).length() < 5e-3, "{:?}", world.velocity(id));
}

#[test]
fn a_lasting_force_acts_at_its_point() {
    // A pendulum pulled along x by a force on its bob, without gravity, hangs along x.
    let mut world = weightless();
    let hook = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });
    let mut def = box_body(Vec3::new(0.05, 0.5, 0.05), Vec3::Y * -0.5);
    def.linear_damping = 2.0;
    let rod = world.add_body(&def);
    world.add_joint(&ball(&world, hook, rod, Vec3::ZERO));
    let pull = ForceDef { force: Vec3::X * 50.0, point: Some(Vec3::Y * -0.5), ..ForceDef::default() };
    world.add_force(rod, &pull);
    run(&mut world, 900);
    let turned = world.transform(rod).rotation * Vec3::NEG_Y;
    assert!((turned - Vec3::X).length() < 1e-2, "the pendulum hangs along {turned}, expected x");
}

#[test]
fn bullet_that_stays_in_a_body_gives_it_its_momentum() {
    let mut world = weightless();
    let block = world.add_body(&point_mass(2.0, Vec3::ZERO, Vec3::Y));
    let velocity = Vec3::new(400.0, 0.0, 0.0);
    let impulse = world.apply_bullet_impact(block, 0.01, velocity, Vec3::ZERO);
    // (M V + m v)/(M + m), bullet and block together.
    let expected = (Vec3::Y * 2.0 + velocity * 0.01) / 2.01;
    let after = world.velocity(block);
    assert!(
        (after.linear - expected).length() < 1e-5,
        "velocity after the impact {after:?}, expected {expected}"
    );
    assert_eq!(after.angular, Vec3::ZERO);
    let total = after.linear * 2.01;
    assert!(
        (total - (Vec3::Y * 2.0 + velocity * 0.01)).length() < 1e-4,
        "body and bullet must keep their total momentum"
    );
    assert!((impulse - (expected - Vec3::Y) * 2.0).length() < 1e-4);
}

#[test]
fn off_centre_bullet_gets_the_velocity_of_the_struck_point() {
    let mut world = weightless();
    let rotation = Rotation::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 0.7);
    let block = world.add_body(&BodyDef {
        rotation,
        angular_velocity: Vec3::new(0.2, 1.0, -0.4),
        ..box_body(Vec3::new(0.1, 0.2, 0.3), Vec3::ZERO)
    });
    let (mass, velocity, point) = (0.5, Vec3::new(90.0, -20.0, 10.0), Vec3::new(-0.05, 0.15, 0.1));
    let before = world.momentum();
    let impulse = world.apply_bullet_impact(block, mass, velocity, point);
    let struck = world.velocity(block).at(point);
    // Remaining momentum of the bullet.
    assert!((struck - (velocity - impulse / mass)).length() < 1e-3, "velocity of the struck point {struck}");
    let after = world.momentum();
    let linear = after.linear + struck * mass - (before.linear + velocity * mass);
    let angular =
        after.angular + point.cross(struck * mass) - (before.angular + point.cross(velocity * mass));
    assert!(
        linear.length() < 1e-3 && angular.length() < 1e-3,
        "the momentum differs by {linear}, the angular momentum by {angular}"
    );
}

#[test]
fn static_wall_takes_the_bullets_whole_momentum() {
    let mut world = weightless();
    let wall = box_body(Vec3::ONE, Vec3::ZERO);
    let wall = world.add_body(&BodyDef { kind: BodyKind::Static, ..wall });
    let impulse = world.apply_bullet_impact(wall, 0.01, Vec3::X * 300.0, Vec3::NEG_X);
    assert!((impulse - Vec3::X * 3.0).length() < 1e-5);
    assert!(world.velocity(wall).is_zero());
}
