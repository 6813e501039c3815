//! Every engine of this build against closed forms, by the quality tool.

use sinew::math::{Rotation, Transform, Vec3, trig};
use sinew::physics::{BodyDef, BodyKind, Filter, Hull, MassProperties, Shape, ShapeDef, Sleeping};
use sinew_peers::engine::{BodyState, Engine};
use sinew_peers::engines::ENGINES;
use sinew_peers::quality::{Quality, QualityMeter};
use sinew_peers::scenes::Field;
use sinew_scenes::blueprint::Blueprint;

/// Returns all engines of this build with bodies.
pub fn engines() -> impl Iterator<Item = &'static dyn Engine> {
    engines_of(Field::Physics)
}

/// Returns all engines of this build for a field.
pub fn engines_of(field: Field) -> impl Iterator<Item = &'static dyn Engine> {
    ENGINES.iter().filter_map(|entry| entry.engine).filter(move |engine| engine.fields().contains(&field))
}

fn scene(bodies: Vec<BodyDef>) -> Blueprint {
    let gravity = Vec3::new(0.0, -9.81, 0.0);
    Blueprint {
        name: "by hand",
        gravity,
        sleeping: Sleeping::Off,
        steps: 60,
        bodies,
        joints: Vec::new(),
        apart: Vec::new(),
    }
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
    let mut simulation = engine.build(scene).expect("every engine supports boxes, balls and hinges");
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

/// A second of free fall with spin; damped by 5 %/s in the second case.
#[test]
fn falling_bodies_match_free_fall_and_keep_spin() {
    for engine in engines() {
        let name = engine.describe().name;
        let mut free = body(BodyKind::Dynamic, Shape::Sphere { radius: 0.5 }, Vec3::new(1.0, 50.0, 2.0));
        free.linear_velocity = Vec3::X * 2.0;
        free.angular_velocity = Vec3::Y * 1.5;
        let mut damped = free.clone();
        damped.position.z = 9.0;
        (damped.linear_damping, damped.angular_damping) = (0.05, 0.05);
        let (states, _) = after(engine, &scene(vec![floor(), free, damped]), 60);
        assert_eq!(states[0].world_from_body.translation, Vec3::NEG_Y, "{name}");
        let body = &states[1];
        assert!((body.linear_velocity - Vec3::new(2.0, -9.81, 0.0)).length() < 1e-2, "{name}: {body:?}");
        // Symplectic Euler with 1 to 4 substeps falls by up to g dt / 2 more.
        let fallen = body.world_from_body.translation - Vec3::new(3.0, 50.0 - 4.905, 2.0);
        assert!(fallen.length() < 0.1, "{name}: {fallen}");
        let turned = body.world_from_body.rotation.angle_to(Rotation::from_axis_angle(Vec3::Y, 1.5));
        assert!(turned < 1e-2, "{name}: {turned}");
        let speed = states[2].linear_velocity.x;
        assert!((speed - 2.0 * trig::exp(-0.05)).abs() < 5e-3, "{name}: {speed}");
        let spin = states[2].angular_velocity.y;
        assert!((spin - 1.5 * trig::exp(-0.05)).abs() < 5e-3, "{name}: {spin}");
    }
}

/// Shapes that only some engines have rest at their own height, too, or are refused.
#[test]
fn round_shapes_and_hulls_have_their_sizes_or_are_unsupported() {
    let corners = [Vec3::new(0.3, -0.2, 0.3), Vec3::new(-0.3, -0.2, 0.3), Vec3::new(0.0, -0.2, -0.3)];
    let top = corners.map(|corner| corner + Vec3::Y * 0.5);
    let wedge = Hull::new(&[corners, top].concat()).expect("a prism is convex");
    let kinds = [
        (
            "cylinder",
            Shape::Cylinder { half_height: 0.3, radius: 0.2 },
            0.3,
            &["sinew", "rapier", "box3d", "jolt"][..],
        ),
        ("cone", Shape::Cone { half_height: 0.3, radius: 0.3 }, 0.3, &["sinew", "rapier", "box3d"]),
        ("hull", Shape::Hull(wedge.into()), 0.2, &["sinew", "rapier", "box3d", "jolt"]),
        (
            "tapered capsule",
            Shape::TaperedCapsule { half_height: 0.2, radius_bottom: 0.3, radius_top: 0.1 },
            0.5,
            &["sinew", "jolt"],
        ),
    ];
    for engine in engines() {
        let name = engine.describe().name;
        for (kind, shape, height, have) in &kinds {
            let scene =
                scene(vec![floor(), body(BodyKind::Dynamic, shape.clone(), Vec3::Y * (height + 0.02))]);
            assert_eq!(engine.build(&scene).is_ok(), have.contains(&name), "{name}: {kind}");
            if have.contains(&name) {
                let (states, _) = after(engine, &scene, 60);
                let y = states[1].world_from_body.translation.y;
                assert!((y - height).abs() < 0.025, "{name}: {kind} rests at {y} m, expected {height} m");
            }
        }
    }
}

/// A body of two shapes spins about its centre of mass; half a turn moves its origin to the other side.
#[test]
fn bodies_spin_about_their_centres_of_mass() {
    let capsule = Shape::TaperedCapsule { half_height: 0.2, radius_bottom: 0.1, radius_top: 0.2 };
    for other in [Shape::Sphere { radius: 0.2 }, Shape::Cylinder { half_height: 0.1, radius: 0.3 }, capsule] {
        let mut def = body(BodyKind::Dynamic, brick(), Vec3::ZERO);
        let aside = Transform::new(Vec3::X, Rotation::from_axis_angle(Vec3::Z, 1.0));
        def.shapes.push(ShapeDef { body_from_shape: aside, ..ShapeDef::new(other) });
        let center = def.shapes.iter().fold(MassProperties::default(), |sum, part| {
            sum.combine(&part.shape.mass_properties(part.density).transformed(&part.body_from_shape))
        });
        def.angular_velocity = Vec3::Z * core::f32::consts::PI;
        let scene = Blueprint { gravity: Vec3::ZERO, ..scene(vec![def]) };
        for engine in engines().filter(|engine| engine.build(&scene).is_ok()) {
            let (states, _) = after(engine, &scene, 60);
            let origin = states[0].world_from_body.translation;
            let off = origin - 2.0 * center.center;
            assert!(off.length() < 0.05, "{}: {origin} for {}", engine.describe().name, 2.0 * center.center);
        }
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
        let (states, quality) = after(engine, &scene(bodies), 90);
        for (state, height) in states[1..4].iter().zip([0.3, 0.25, 0.1]) {
            let y = state.world_from_body.translation.y;
            // Jolt lets resting bodies sink by 20 mm.
            assert!((y - height).abs() < 0.025, "{name}: the body rests at {y} m, expected {height} m");
        }
        assert!(
            states[4].world_from_body.translation.y < -5.0,
            "{name}: a body without collisions did not fall"
        );
        assert_eq!(quality.place.lost, 0, "{name}: a fallen body without collisions counts as lost");
    }
}
