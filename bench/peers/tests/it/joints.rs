//! Joints, masses and half-spaces act the same in every engine of this build.

use crate::engines::engines;
use sinew::math::limits::hinge_angle;
use sinew::math::{Range, Rotation, SwingTwistLimit, Sym3, Transform, Vec3};
use sinew::physics::{BodyDef, BodyKind, JointKind, MassProperties, Shape, ShapeDef, Sleeping};
use sinew_peers::engine::{BodyState, Engine, joint_frames};
use sinew_scenes::blueprint::{Blueprint, BlueprintJoint};

fn body(shape: Shape, position: Vec3) -> BodyDef {
    BodyDef { position, shapes: vec![ShapeDef::new(shape)], ..BodyDef::default() }
}

fn fixed(def: BodyDef) -> BodyDef {
    BodyDef { kind: BodyKind::Static, ..def }
}

fn cuboid(half_extents: Vec3, position: Vec3) -> BodyDef {
    body(Shape::Box { half_extents }, position)
}

fn scene(bodies: Vec<BodyDef>, joints: Vec<BlueprintJoint>) -> Blueprint {
    let gravity = Vec3::new(0.0, -9.81, 0.0);
    Blueprint { name: "test", gravity, sleeping: Sleeping::Off, steps: 0, bodies, joints, apart: Vec::new() }
}

/// Returns the states of all bodies after `steps` steps.
fn run(engine: &dyn Engine, scene: &Blueprint, steps: usize) -> Vec<BodyState> {
    let name = engine.describe().name;
    let mut simulation = engine.build(scene).unwrap_or_else(|why| panic!("{name}: {why}"));
    for _ in 0..steps {
        simulation.step();
    }
    let mut states = Vec::new();
    simulation.states(&mut states);
    assert_eq!(states.len(), scene.bodies.len(), "{name}");
    states
}

/// Returns the rotation of a joint's second frame in its first.
fn joint_rotation(scene: &Blueprint, states: &[BodyState]) -> Rotation {
    let joint = &scene.joints[0];
    let [frame_a, frame_b] = joint_frames(scene, joint);
    let [a, b] = [(joint.a, frame_a), (joint.b, frame_b)]
        .map(|(place, frame)| (states[place].world_from_body * frame).rotation);
    a.inverse() * b
}

/// Returns a box that hangs by a joint at the origin from a fixed body without shapes, its centre at `arm`.
fn hung(arm: Vec3, axes: Rotation, kind: JointKind) -> Blueprint {
    let hook = fixed(BodyDef::default());
    let world_from_joint = Transform::new(Vec3::ZERO, axes);
    scene(
        vec![hook, cuboid(Vec3::new(0.3, 0.1, 0.1), arm)],
        vec![BlueprintJoint { a: 0, b: 1, world_from_joint, kind, friction_torque: 0.0 }],
    )
}

#[test]
fn box_rests_at_its_half_height() {
    for floor in [cuboid(Vec3::new(10.0, 0.5, 10.0), Vec3::NEG_Y * 0.5), body(Shape::HalfSpace, Vec3::ZERO)] {
        let scene = scene(vec![fixed(floor), cuboid(Vec3::new(0.5, 0.25, 0.5), Vec3::Y * 0.5)], vec![]);
        for engine in engines() {
            let height = run(engine, &scene, 120)[1].world_from_body.translation.y;
            // Jolt leaves up to 20 mm of overlap.
            assert!((0.23..0.251).contains(&height), "{}: {height} m", engine.describe().name);
        }
    }
}

#[test]
fn a_hinge_stops_at_either_limit() {
    // The box falls toward −y: about +z from −x, about −z from +x.
    let axes = Rotation::from_arc(Vec3::X, Vec3::Z);
    for (arm, stop) in [(Vec3::X, -0.5), (Vec3::NEG_X, 0.3)] {
        let scene = hung(arm, axes, JointKind::Hinge { limit: Some(Range::new(-0.5, 0.3)) });
        for engine in engines() {
            let angle = hinge_angle(joint_rotation(&scene, &run(engine, &scene, 300)));
            assert!(
                (angle - stop).abs() < 0.03,
                "{}: the hinge is at {angle} rad, its stop at {stop} rad",
                engine.describe().name
            );
        }
    }
}

#[test]
fn a_ball_joint_stops_at_its_cone() {
    let cone = Range::symmetric(0.4);
    let limit = SwingTwistLimit { swing_y: cone, swing_z: cone, twist: Range::symmetric(0.2) };
    let scene = hung(Vec3::X, Rotation::IDENTITY, JointKind::Ball { limit: Some(limit) });
    for engine in engines() {
        let (swing, twist) = SwingTwistLimit::angles(joint_rotation(&scene, &run(engine, &scene, 300)));
        let name = engine.describe().name;
        assert!(
            (swing.length() - 0.4).abs() < 0.03 && twist.abs() < 0.23,
            "{name}: swing {swing} rad, twist {twist} rad"
        );
    }
}

#[test]
fn a_twist_stops_at_either_limit() {
    // The box hangs beside its level axis, so it rotates about x until it reaches the stop.
    let swing = Range::symmetric(0.01);
    let limit = SwingTwistLimit { swing_y: swing, swing_z: swing, twist: Range::new(-0.3, 0.5) };
    for (arm, stop) in [(Vec3::NEG_Z, -0.3), (Vec3::Z, 0.5)] {
        let scene = hung(arm, Rotation::IDENTITY, JointKind::Ball { limit: Some(limit) });
        for engine in engines() {
            let (_, twist) = SwingTwistLimit::angles(joint_rotation(&scene, &run(engine, &scene, 300)));
            assert!(
                (twist - stop).abs() < 0.04,
                "{}: the twist is {twist} rad, its stop {stop} rad",
                engine.describe().name
            );
        }
    }
}

#[test]
fn jointed_bodies_overlap_and_others_do_not() {
    let half = Vec3::splat(0.5);
    let joint = BlueprintJoint {
        a: 1,
        b: 2,
        world_from_joint: Transform::from_translation(Vec3::new(0.25, 0.5, 0.0)),
        kind: JointKind::Fixed,
        friction_torque: 0.0,
    };
    let floor = fixed(cuboid(Vec3::new(10.0, 0.5, 10.0), Vec3::NEG_Y * 0.5));
    let boxes = [Vec3::new(0.0, 0.5, 0.0), Vec3::new(0.5, 0.5, 0.0), Vec3::new(0.25, 1.6, 0.0)];
    let bodies = core::iter::once(floor).chain(boxes.map(|at| cuboid(half, at))).collect();
    let scene = scene(bodies, vec![joint]);
    for engine in engines() {
        let states = run(engine, &scene, 120);
        let at = |place: usize| states[place].world_from_body.translation;
        let name = engine.describe().name;
        assert!((at(2) - at(1) - Vec3::X * 0.5).length() < 0.01, "{name}: pushed apart");
        assert!((1.45..1.51).contains(&at(3).y), "{name}: third box at {}", at(3));
    }
}

#[test]
fn mass_and_inertia_equal_the_given_ones() {
    // A fixed joint between a light and a heavy rotating body: their common centre moves straight.
    let spinning = |mass: f32, x: f32| BodyDef {
        linear_velocity: Vec3::Y * x,
        angular_velocity: Vec3::Z,
        gravity_scale: 0.0,
        mass: Some(MassProperties { mass, center: Vec3::ZERO, inertia: Sym3::IDENTITY }),
        ..cuboid(Vec3::splat(0.1), Vec3::X * x)
    };
    let world_from_joint = Transform::from_translation(Vec3::X);
    let joint = BlueprintJoint { a: 0, b: 1, world_from_joint, kind: JointKind::Fixed, friction_torque: 0.0 };
    let scene = scene(vec![spinning(9.0, 0.0), spinning(1.0, 1.0)], vec![joint]);
    for engine in engines() {
        let states = run(engine, &scene, 60);
        let [heavy, light] = [0, 1].map(|place: usize| states[place].world_from_body.translation);
        let center = heavy * 0.9 + light * 0.1;
        let name = engine.describe().name;
        assert!(
            (center - Vec3::new(0.1, 0.1, 0.0)).length() < 0.01,
            "{name}: the common centre of mass is at {center}"
        );
        let spin = states[0].angular_velocity.z;
        assert!((spin - 1.0).abs() < 0.02, "{name}: {spin} rad/s");
    }
}

#[test]
fn off_axis_centre_of_mass_matches_its_definition() {
    let center = Vec3::new(0.2, 0.1, 0.0);
    let inertia = Sym3 { diagonal: Vec3::new(1.0, 2.0, 2.5), off: Vec3::new(0.0, 0.0, -0.3) };
    let def = BodyDef {
        angular_velocity: Vec3::Z * 2.0,
        gravity_scale: 0.0,
        mass: Some(MassProperties { mass: 3.0, center, inertia }),
        ..cuboid(Vec3::splat(0.3), Vec3::ZERO)
    };
    let scene = scene(vec![def], vec![]);
    for engine in engines() {
        let pose = run(engine, &scene, 30)[0].world_from_body;
        let moved = (pose.point(center) - center).length();
        let name = engine.describe().name;
        assert!(moved < 1e-3, "{name}: the centre of mass moved {moved} m");
        let turned = pose.rotation.to_scaled_axis().z;
        assert!((turned - 1.0).abs() < 0.02, "{name}: {turned} rad");
    }
}
