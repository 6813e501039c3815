//! Every engine of this build as the quality tool sees it, against closed forms.

use sinew::math::{Rotation, Vec3, trig};
use sinew::physics::{BodyDef, BodyKind, Filter, Shape, ShapeDef, Sleeping};
use sinew_peers::engine::{BodyState, Engine};
use sinew_peers::engines::ENGINES;
use sinew_peers::quality::{Quality, QualityMeter};
use sinew_scenes::blueprint::Blueprint;

/// All of this build.
pub fn engines() -> impl Iterator<Item = &'static dyn Engine> {
    ENGINES.iter().filter_map(|entry| entry.engine)
}

fn scene(bodies: Vec<BodyDef>) -> Blueprint {
    let gravity = Vec3::new(0.0, -9.81, 0.0);
    Blueprint { name: "by hand", gravity, sleeping: Sleeping::Off, steps: 60, bodies, joints: Vec::new() }
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
            // Jolt lets what rests sink by 20 mm.
            assert!((y - height).abs() < 0.025, "{name}: {y} for {height}");
        }
        assert!(states[4].world_from_body.translation.y < -5.0, "{name}: a ghost stands");
        assert_eq!(quality.place.lost, 0, "{name}: a ghost may fall");
    }
}
