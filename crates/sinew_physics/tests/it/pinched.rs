//! Particles between a body and what is fixed: they bear it, neither is pushed into the other, and nobody pays for nothing.

use crate::build::floor;
use sinew_math::{Rotation, Vec3};
use sinew_physics::particles::{ClothDef, RopeDef};
use sinew_physics::*;

/// Radius of the roller, metres.
const ROLLER: f32 = 0.15;
/// Radius of the particles, metres.
const RADIUS: f32 = 0.03;

/// A roller on the floor along Z, 40 kg, that comes along X.
fn roller(world: &mut World, height: f32, speed: f32) -> BodyId {
    let shape = Shape::Capsule { half_height: 0.18, radius: ROLLER };
    let mut def = BodyDef {
        position: Vec3::new(0.0, ROLLER + height, 0.0),
        rotation: Rotation::from_axis_angle(Vec3::X, core::f32::consts::FRAC_PI_2),
        linear_velocity: Vec3::X * speed,
        angular_velocity: Vec3::Z * (-speed / ROLLER),
        shapes: vec![ShapeDef::new(shape)],
        ..BodyDef::default()
    };
    def.shapes[0].density *= 40.0 / world_mass(&def);
    world.add_body(&def)
}

fn world_mass(def: &BodyDef) -> f32 {
    let mut world = World::new(WorldDef::default());
    let id = world.add_body(def);
    world.mass(id).mass
}

/// Depth of the deepest particle in the floor, metres.
fn sunk(world: &World, id: GroupId) -> f32 {
    let group = world.particles(id);
    let depths = group.positions().iter().zip(group.radii()).map(|(at, radius)| radius - at.y);
    depths.fold(0.0, f32::max)
}

/// A heavy roller that goes over a rope on the ground squeezes it: that takes from the roller's energy and gives none to the rope, whose knots stay on the ground.
#[test]
fn a_roller_goes_over_a_rope() {
    for (stiffness, turn) in [(1e3, 0.0), (5e4, 0.0), (5e4, 0.7), (5e4, 1.5)] {
        let mut world = World::new(WorldDef::default());
        floor(&mut world);
        roller(&mut world, 0.0, 1.0);
        let half = Rotation::from_axis_angle(Vec3::Y, turn) * (Vec3::Z * 0.45);
        let middle = Vec3::new(0.75, RADIUS, 0.0);
        let def = RopeDef {
            from: middle - half,
            to: middle + half,
            links: 14,
            mass: 0.5,
            stiffness,
            radius: RADIUS,
        };
        let rope = world.add_particles(&def.build().group);
        let begin = world.energy().total();
        for step in 0..180 {
            world.step();
            let what = format!("{stiffness} N at {turn} rad, step {step}");
            let gain = world.energy().total() - begin;
            assert!(gain < 0.1, "{what}: gained {gain} J");
            assert!(sunk(&world, rope) < 1e-4, "{what}: {} m in the floor", sunk(&world, rope));
        }
    }
}

/// A roller set down on cloth on the ground lies on it, and does not sink through it.
#[test]
fn cloth_on_the_ground_bears_a_roller() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let roller = roller(&mut world, 2.0 * RADIUS + 0.01, 0.0);
    let cloth = ClothDef {
        corner: Vec3::new(-0.3, RADIUS, -0.3),
        across: Vec3::X * 0.6,
        down: Vec3::Z * 0.6,
        columns: 12,
        rows: 12,
        mass: 0.5,
        stretching: 2000.0,
        shearing: 200.0,
        bending: 1e-5,
        damping_ratio: 0.2,
        radius: RADIUS,
    };
    let cloth = world.add_particles(&cloth.build().group);
    let begin = world.energy().total();
    for step in 0..240 {
        world.step();
        let gain = world.energy().total() - begin;
        assert!(gain < 0.1, "step {step}: gained {gain} J");
        assert!(sunk(&world, cloth) < 1e-4, "step {step}: {} m in the floor", sunk(&world, cloth));
    }
    let height = world.center_of_mass(roller).y - ROLLER;
    assert!(height > 1.8 * RADIUS, "{height} m above the ground");
}

/// The end of a rope that is made in the crease between two limbs, where there is no room for it, comes out of it, and nobody pays for that.
#[test]
fn what_is_made_in_a_crease_comes_out_of_it() {
    for bend in [0.2_f32, 0.8, 1.6] {
        let mut world = World::new(WorldDef::default());
        let limb = |turn: f32| {
            let along = Rotation::from_axis_angle(Vec3::X, turn);
            BodyDef {
                kind: BodyKind::Static,
                // Their ends are 5 mm apart.
                position: Vec3::Y + along * (Vec3::Y * 0.1825),
                rotation: along,
                shapes: vec![ShapeDef::new(Shape::Capsule { half_height: 0.15, radius: 0.03 })],
                ..BodyDef::default()
            }
        };
        world.add_body(&limb(bend * 0.5));
        world.add_body(&limb(core::f32::consts::PI - bend * 0.5));
        let mut rope = RopeDef {
            from: Vec3::new(0.6, 1.005, 0.002),
            to: Vec3::new(0.0, 1.005, 0.002),
            links: 12,
            mass: 0.1,
            stiffness: 500.0,
            radius: 0.015,
        }
        .build();
        rope.group.hold_in_world(&[rope.first]);
        rope.group.linear_damping = 1.0;
        let id = world.add_particles(&rope.group);
        let most = world.energy().total() + 1e-3;
        for step in 0..240 {
            world.step();
            let energy = world.energy().total();
            assert!(energy < most, "bent by {bend}, step {step}: {energy} J of {most}");
        }
        let end = world.particles(id).positions()[rope.last as usize];
        assert!(end.x > 0.05, "bent by {bend}: it is still at {end:?}");
    }
}
