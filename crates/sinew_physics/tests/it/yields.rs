//! Yielding shapes: kinematic bodies that push with at most a given force and stop pushing beyond it.

use crate::build::{ball as ball_joint, box_body, capsule_body, floor, sphere_body};
use sinew_math::{Reader, Rotation, Vec3, Writer, max};
use sinew_physics::*;
use std::f32::consts::FRAC_PI_2;

/// Adds a kinematic arm, an upright capsule of radius 0.1 m, with a velocity.
fn arm(world: &mut World, at: Vec3, velocity: Vec3) -> BodyId {
    let shape = Shape::Capsule { half_height: 0.4, radius: 0.1 };
    let rule = ContactRule::Yields(Yields::default());
    let def = BodyDef {
        kind: BodyKind::Kinematic,
        position: at,
        linear_velocity: velocity,
        shapes: vec![ShapeDef { rule, ..ShapeDef::new(shape) }],
        ..BodyDef::default()
    };
    world.add_body(&def)
}

fn level() -> World {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    world
}

/// Adds a ball of 0.43 kg that bounces.
fn ball(world: &mut World, at: Vec3, velocity: Vec3) -> BodyId {
    let mut def = sphere_body(0.11, at);
    (def.linear_velocity, def.mass) = (velocity, Some(Shape::Sphere { radius: 0.11 }.mass_properties(77.0)));
    def.shapes[0].material.restitution = 0.8;
    world.add_body(&def)
}

#[test]
fn yielding_arm_reflects_and_kicks_a_ball() {
    let mut world = level();
    arm(&mut world, Vec3::Y * 0.5, Vec3::ZERO);
    let thrown = ball(&mut world, Vec3::new(-1.0, 0.5, 0.0), Vec3::X * 20.0);
    for _ in 0..8 {
        world.step();
    }
    let back = -world.velocity(thrown).linear.x;
    assert!((back - 16.0).abs() < 0.3, "the ball leaves the arm at {back} m/s, expected 16 m/s");

    let mut world = level();
    arm(&mut world, Vec3::new(-0.5, 0.5, 0.0), Vec3::X * 4.0);
    let kicked = ball(&mut world, Vec3::Y * 0.11, Vec3::ZERO);
    for _ in 0..20 {
        world.step();
    }
    assert!(
        world.velocity(kicked).linear.x > 3.9,
        "the kicked ball moves at {} m/s",
        world.velocity(kicked).linear.x
    );
}

#[test]
fn a_yielding_contact_with_a_crate_is_reported() {
    let mut world = level();
    let arm = arm(&mut world, Vec3::new(-0.8, 0.5, 0.0), Vec3::X * 3.0);
    let mut def = box_body(Vec3::splat(0.25), Vec3::Y * 0.25);
    def.mass = Some(Shape::Box { half_extents: Vec3::splat(0.25) }.mass_properties(320.0));
    let load = world.add_body(&def);
    let (mut told, mut fastest) = (0, 0.0);
    for _ in 0..40 {
        world.step();
        let met = |pair: &&(BodyId, BodyId)| **pair == (arm, load) || **pair == (load, arm);
        told += world.events().begin.iter().filter(met).count();
        fastest = max(fastest, world.velocity(load).linear.length());
    }
    assert!(world.transform(arm).translation.x > 1.0, "the arm must pass through");
    assert_eq!(told, 1, "the contact must be reported once");
    let way = world.transform(load).translation.x;
    assert!(way.abs() < 0.01 && fastest < 0.1, "the crate must stay; moved {way} m, fastest {fastest} m/s");
}

#[test]
fn yielding_arm_stops_at_a_body_against_a_wall() {
    let mut world = level();
    let wall = Shape::Box { half_extents: Vec3::new(0.2, 1.0, 1.0) };
    world.add_body(&BodyDef::fixed(wall).at(Vec3::new(0.45, 1.0, 0.0)));
    // The motion is so slow that the force suffices.
    arm(&mut world, Vec3::new(-0.4, 0.5, 0.0), Vec3::X * 0.05);
    let mut def = box_body(Vec3::splat(0.25), Vec3::Y * 0.25);
    def.mass = Some(Shape::Box { half_extents: Vec3::splat(0.25) }.mass_properties(80.0));
    let load = world.add_body(&def);
    for _ in 0..900 {
        world.step();
        let sunk = world.penetration(load);
        assert!(sunk < 0.01, "the arm is {sunk} m inside the wall");
    }
    assert!(
        (world.transform(load).translation.x).abs() < 0.02,
        "the load must stay at the wall; it is at {}",
        world.transform(load).translation
    );
}

#[test]
fn limb_driven_into_a_standing_arm_passes_it() {
    let mut world = level();
    arm(&mut world, Vec3::Y * 0.5, Vec3::ZERO);
    let hip = Vec3::new(-0.7, 0.5, 0.0);
    let mut driver = sphere_body(0.05, hip);
    (driver.kind, driver.linear_velocity) = (BodyKind::Kinematic, Vec3::X * 2.0);
    driver.shapes[0].rule = ContactRule::Ghost;
    let driver = world.add_body(&driver);
    let mut limb = capsule_body(0.15, 0.05, hip + Vec3::X * 0.2);
    (limb.rotation, limb.linear_velocity) = (Rotation::from_axis_angle(Vec3::Z, FRAC_PI_2), Vec3::X * 2.0);
    let limb = world.add_body(&limb);
    let joint = world.add_joint(&ball_joint(&world, driver, limb, hip));
    let (mut fastest, mut gap) = (0.0, 0.0);
    for _ in 0..50 {
        world.step();
        fastest = max(fastest, world.velocity(limb).linear.length());
        gap = max(gap, world.joint_gap(joint));
    }
    assert!(world.transform(limb).translation.x > 0.5, "the limb must pass the arm");
    assert!(fastest < 15.0 && gap < 1e-5, "fastest {fastest} m/s, gap {gap} m");
}

#[test]
fn heavy_fast_bodies_pass_and_dynamic_shapes_push() {
    let fly = |kind: BodyKind| {
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let mut def = box_body(Vec3::splat(0.25), Vec3::X * -1.5);
        def.mass = Some(Shape::Box { half_extents: Vec3::splat(0.25) }.mass_properties(320.0));
        def.linear_velocity = Vec3::X * 6.0;
        let load = world.add_body(&def);
        let mut post = box_body(Vec3::splat(0.25), Vec3::ZERO);
        (post.kind, post.shapes[0].rule) = (kind, ContactRule::Yields(Yields::default()));
        post.rotation = Rotation::IDENTITY;
        let post = world.add_body(&post);
        for _ in 0..40 {
            world.step();
        }
        (world.velocity(load).linear.x, world.velocity(post).linear.x)
    };
    assert_eq!(
        fly(BodyKind::Kinematic),
        (6.0, 0.0),
        "the load must pass a kinematic post: its impulse of 240 N·s exceeds the strength"
    );
    let (load, post) = fly(BodyKind::Dynamic);
    assert!(load < 4.0 && post > 1.0, "a dynamic post must be pushed; load {load} m/s, post {post} m/s");
}

#[test]
fn movers_pass_yielding_shapes_and_restored_worlds_continue_equally() {
    let mut world = level();
    arm(&mut world, Vec3::new(1.0, 0.6, 0.0), Vec3::X * -0.5);
    let mover = world.add_mover(&MoverDef::at(Vec3::ZERO));
    world.set_mover_walk(mover, Vec3::X * 2.0);
    // The load is low enough for the mover to step over it.
    let load = world.add_body(&box_body(Vec3::splat(0.15), Vec3::new(0.6, 0.15, 0.1)));
    for _ in 0..30 {
        world.step();
    }
    let mut w = Writer::new();
    world.save(&mut w);
    let mut other = World::new(WorldDef::default());
    other.load(&mut Reader::new(w.as_bytes())).expect("the snapshot must load");
    for _ in 0..60 {
        world.step();
        other.step();
        assert_eq!(world.hash(), other.hash());
    }
    assert!(world.contains(load) && world.mover(mover).position().x > 1.5);
}

#[test]
#[should_panic(expected = "must not be negative")]
fn a_nan_bound_is_refused() {
    let mut world = level();
    let mut def = sphere_body(0.1, Vec3::Y);
    def.shapes[0].rule = ContactRule::Yields(Yields { max_force: f32::NAN, ..Yields::default() });
    world.add_body(&def);
}
