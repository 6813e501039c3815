//! Every engine of this build, against closed forms: a scene that is mapped wrongly would be measured wrongly.

use sinew::math::{Range, Rotation, SwingTwistLimit, Transform, Vec3};
use sinew::physics::{BodyDef, BodyKind, Filter, JointKind, MassProperties, Shape, ShapeDef, Sleeping};
use sinew_peers::engine::{BodyState, Engine};
use sinew_peers::engines::ENGINES;
use sinew_peers::quality::{Quality, QualityMeter};
use sinew_scenes::blueprint::{Blueprint, BlueprintJoint};

fn engines() -> impl Iterator<Item = &'static dyn Engine> {
    ENGINES.iter().filter_map(|entry| entry.engine)
}

fn scene(bodies: Vec<BodyDef>, joints: Vec<BlueprintJoint>) -> Blueprint {
    let gravity = Vec3::new(0.0, -9.81, 0.0);
    Blueprint { name: "by hand", gravity, sleeping: Sleeping::Off, steps: 60, bodies, joints }
}

fn body(kind: BodyKind, shape: Shape, position: Vec3) -> BodyDef {
    BodyDef { kind, position, shapes: vec![ShapeDef::new(shape)], ..BodyDef::default() }
}

fn ghost(mut def: BodyDef) -> BodyDef {
    for shape in &mut def.shapes {
        shape.filter = Filter { mask: 0, ..Filter::default() };
    }
    def
}

fn floor() -> BodyDef {
    body(BodyKind::Static, Shape::Box { half_extents: Vec3::new(9.0, 1.0, 9.0) }, Vec3::NEG_Y)
}

fn brick() -> Shape {
    Shape::Box { half_extents: Vec3::new(0.2, 0.3, 0.4) }
}

fn after(engine: &dyn Engine, scene: &Blueprint, steps: usize) -> (Vec<BodyState>, Quality) {
    let mut simulation = engine.build(scene).expect("every engine has boxes, balls and hinges");
    let mut meter = QualityMeter::new(scene, 1);
    let mut states = Vec::new();
    for _ in 0..steps {
        simulation.step();
        simulation.states(&mut states);
        meter.observe(&states);
    }
    let quality = meter.finish(&states);
    (states, quality)
}

/// A second of free fall with spin; damped by 5 %/s where it says so.
#[test]
fn what_falls_falls_and_spins_on() {
    for engine in engines() {
        let name = engine.describe().name;
        let mut free = body(BodyKind::Dynamic, Shape::Sphere { radius: 0.5 }, Vec3::new(1.0, 50.0, 2.0));
        free.linear_velocity = Vec3::X * 2.0;
        free.angular_velocity = Vec3::Y * 1.5;
        let mut damped = free.clone();
        damped.position.z = 9.0;
        (damped.linear_damping, damped.angular_damping) = (0.05, 0.05);
        let (states, _) = after(engine, &scene(vec![floor(), free, damped], vec![]), 60);
        assert_eq!(states[0].world_from_body.translation, Vec3::NEG_Y, "{name}");
        let body = &states[1];
        assert!((body.linear_velocity - Vec3::new(2.0, -9.81, 0.0)).length() < 1e-2, "{name}: {body:?}");
        // Symplectic Euler with 1 to 4 substeps falls by up to g dt / 2 more.
        let fallen = body.world_from_body.translation - Vec3::new(3.0, 50.0 - 4.905, 2.0);
        assert!(fallen.length() < 0.1, "{name}: {fallen}");
        let turned = body.world_from_body.rotation.angle_to(Rotation::from_axis_angle(Vec3::Y, 1.5));
        assert!(turned < 1e-2, "{name}: {turned}");
        let speed = states[2].linear_velocity.x;
        assert!((speed - 2.0 * (-0.05f32).exp()).abs() < 5e-3, "{name}: {speed}");
        let spin = states[2].angular_velocity.y;
        assert!((spin - 1.5 * (-0.05f32).exp()).abs() < 5e-3, "{name}: {spin}");
    }
}

/// Boxes, balls and capsules come to rest on the floor at their own heights; a ghost falls through it.
#[test]
fn shapes_have_their_sizes() {
    for engine in engines() {
        let name = engine.describe().name;
        let capsule = Shape::Capsule { half_height: 0.3, radius: 0.1 };
        let mut tilted = body(BodyKind::Dynamic, capsule, Vec3::new(3.0, 0.12, 0.0));
        tilted.rotation = Rotation::from_axis_angle(Vec3::X, core::f32::consts::FRAC_PI_2);
        let bodies = vec![
            floor(),
            body(BodyKind::Dynamic, brick(), Vec3::new(0.0, 0.32, 0.0)),
            body(BodyKind::Dynamic, Shape::Sphere { radius: 0.25 }, Vec3::new(-2.0, 0.27, 0.0)),
            tilted,
            ghost(body(BodyKind::Dynamic, brick(), Vec3::new(-4.0, 0.32, 0.0))),
        ];
        let (states, quality) = after(engine, &scene(bodies, vec![]), 90);
        for (state, height) in states[1..4].iter().zip([0.3, 0.25, 0.1]) {
            let y = state.world_from_body.translation.y;
            // Jolt lets what rests sink by 20 mm.
            assert!((y - height).abs() < 0.025, "{name}: {y} for {height}");
        }
        assert!(states[4].world_from_body.translation.y < -5.0, "{name}: a ghost stands");
        assert_eq!(quality.place.lost, 1, "{name}");
    }
}

/// A mass that is given replaces that of the shape: two bodies that spin about each other's joint share momentum by it.
#[test]
fn masses_are_what_is_given() {
    for engine in engines() {
        let name = engine.describe().name;
        let sphere = Shape::Sphere { radius: 0.3 };
        let mut light = ghost(body(BodyKind::Dynamic, sphere, Vec3::ZERO));
        let unit = sinew::math::Sym3::from_diagonal(Vec3::splat(0.036));
        light.mass = Some(MassProperties { mass: 1.0, center: Vec3::ZERO, inertia: unit });
        let mut heavy = ghost(body(BodyKind::Dynamic, sphere, Vec3::X));
        let inertia = sinew::math::Sym3::from_diagonal(Vec3::splat(0.108));
        heavy.mass = Some(MassProperties { mass: 3.0, center: Vec3::ZERO, inertia });
        heavy.linear_velocity = Vec3::X * 4.0;
        let mut scene = scene(
            vec![light, heavy],
            vec![BlueprintJoint {
                a: 0,
                b: 1,
                world_from_joint: Transform::from_translation(Vec3::X * 0.5),
                kind: JointKind::Ball { limit: None },
            }],
        );
        scene.gravity = Vec3::ZERO;
        let (states, _) = after(engine, &scene, 60);
        // 3 kg at 4 m/s and 1 kg at rest go on together at 3 m/s.
        for state in &states {
            assert!((state.linear_velocity - Vec3::X * 3.0).length() < 0.05, "{name}: {state:?}");
        }
    }
}

fn pendulum(kind: JointKind, turn: Rotation) -> Blueprint {
    let hook = BodyDef { kind: BodyKind::Static, position: Vec3::Y * 3.0, ..BodyDef::default() };
    let rod = ghost(body(
        BodyKind::Dynamic,
        Shape::Box { half_extents: Vec3::new(0.5, 0.05, 0.05) },
        Vec3::new(0.5, 3.0, 0.0),
    ));
    let world_from_joint = Transform::new(Vec3::Y * 3.0, turn);
    let rod = BodyDef { linear_damping: 1.0, angular_damping: 1.0, ..rod };
    scene(vec![hook, rod], vec![BlueprintJoint { a: 0, b: 1, world_from_joint, kind }])
}

/// A rod along x, held at one end, hangs at its stop 0.5 rad below level: a hinge about z turns by −0.5.
#[test]
fn a_hinge_stops_where_its_range_ends() {
    for engine in engines() {
        let name = engine.describe().name;
        // The hinge's own x axis is the world's z, or its opposite.
        for (turn, range) in [(-1.0, Range::new(-0.5, 2.0)), (1.0, Range::new(-2.0, 0.5))] {
            let turn = Rotation::from_axis_angle(Vec3::Y, turn * core::f32::consts::FRAC_PI_2);
            let scene = pendulum(JointKind::Hinge { limit: Some(range) }, turn);
            let (states, quality) = after(engine, &scene, 240);
            let direction = states[1].world_from_body.rotation * Vec3::X;
            assert!((direction.y + 0.479).abs() < 0.03, "{name}: {direction} for {range:?}");
            assert!(quality.limits.expect("a limit").hinge.worst_end < 0.03, "{name}");
            assert!(quality.joints.expect("a joint").gap_end_max < 5e-3, "{name}");
        }
    }
}

/// The same rod on a ball whose cone of 0.5 rad is about the rod: it hangs at the cone.
#[test]
fn a_cone_stops_at_its_half_angle() {
    for engine in engines() {
        let name = engine.describe().name;
        let limit = SwingTwistLimit {
            swing_y: Range::symmetric(0.5),
            swing_z: Range::symmetric(0.5),
            twist: Range::symmetric(0.2),
        };
        let scene = pendulum(JointKind::Ball { limit: Some(limit) }, Rotation::IDENTITY);
        let (states, quality) = after(engine, &scene, 240);
        let direction = states[1].world_from_body.rotation * Vec3::X;
        assert!((direction.y + 0.479).abs() < 0.03, "{name}: {direction}");
        let limits = quality.limits.expect("a limit");
        assert!(limits.cone.worst_end < 0.03 && limits.twist.worst_end < 0.03, "{name}: {limits:?}");
    }
}
