//! Joint trees: gaps and energy of a chain with a heavy end and of a double pendulum.

use crate::build::{ball, capsule_body};
use sinew_math::{Sym3, Vec3};
use sinew_physics::*;

/// Returns a chain of ten links of 1 kg along x that is held at the origin, with a heavy ball at its end. The ball is
/// pushed to the side.
fn chain(length: f32, ratio: f32) -> (World, Vec<JointId>) {
    let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
    let mut last = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });
    let mut joints = Vec::new();
    for i in 0..=10 {
        let heavy = i == 10;
        let x = if heavy { 10.0 * length } else { (i as f32 + 0.5) * length };
        let (mass, inertia) = if heavy {
            (ratio, ratio * 0.4 * 0.0625 * length * length)
        } else {
            (1.0, 0.1 * length * length)
        };
        let side = x / (10.0 * length);
        let id = world.add_body(&BodyDef {
            position: Vec3::new(x, 0.0, 0.0),
            linear_velocity: Vec3::new(0.0, 0.0, side),
            angular_velocity: Vec3::new(0.0, -1.0 / (10.0 * length), 0.0),
            mass: Some(MassProperties {
                mass,
                center: Vec3::ZERO,
                inertia: Sym3::from_diagonal(Vec3::splat(inertia)),
            }),
            ..BodyDef::default()
        });
        joints.push(world.add_joint(&ball(&world, last, id, Vec3::new(i as f32 * length, 0.0, 0.0))));
        last = id;
    }
    (world, joints)
}

#[test]
fn a_chain_with_a_heavy_end_does_not_stretch() {
    for (length, ratio) in [(1.0, 1000.0), (0.25, 1000.0), (1.0, 100.0)] {
        let (mut world, joints) = chain(length, ratio);
        let start = world.energy().total();
        let mut gap = 0.0f32;
        for _ in 0..240 {
            world.step();
            gap = joints.iter().map(|&id| world.joint_gap(id)).fold(gap, f32::max);
        }
        let lost = (world.energy().total() - start) / (ratio * 98.1 * length);
        println!(
            "chain {ratio}:1 L={length}: gap {:.5} mm, energy {:.2} % of depth",
            gap * 1e3,
            lost * 100.0
        );
        assert!(gap < 1e-3, "mass ratio {ratio}:1, length {length}: gap {gap}");
        assert!(
            lost < 0.01 && lost > -0.12,
            "mass ratio {ratio}:1, length {length}: relative energy loss {lost}"
        );
    }
}

#[test]
fn a_double_pendulum_keeps_its_energy() {
    let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
    let mut last = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });
    for i in 0..2 {
        let mut def = capsule_body(0.47, 0.03, Vec3::new(i as f32 + 0.5, 0.0, 0.0));
        def.rotation = sinew_math::Rotation::from_axis_angle(Vec3::Z, core::f32::consts::FRAC_PI_2);
        def.shapes[0].filter.mask = 0;
        def.linear_velocity = Vec3::new(0.0, 0.0, i as f32 + 0.5);
        def.angular_velocity = -Vec3::Y;
        let id = world.add_body(&def);
        world.add_joint(&ball(&world, last, id, Vec3::new(i as f32, 0.0, 0.0)));
        last = id;
    }
    let mass: f32 = world.body_ids().map(|id| world.mass(id).mass).sum();
    let start = world.energy().total();
    for _ in 0..1200 {
        world.step();
    }
    let drift = (world.energy().total() - start) / (9.81 * mass);
    println!("double pendulum 20 s: {:.3} % of depth", drift * 100.0);
    assert!(drift.abs() < 0.01, "relative energy drift {drift}");
}
