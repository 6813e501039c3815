//! Cylinders, cones and tapered capsules come to rest, and a lying cylinder rolls.

use crate::build::{box_body, floor};
use core::f32::consts::FRAC_PI_2;
use sinew_math::{Rotation, Vec3};
use sinew_physics::*;

const ROUND: [Shape; 5] = [
    Shape::Cylinder { half_height: 0.4, radius: 0.2 },
    Shape::Cylinder { half_height: 0.02, radius: 0.15 },
    Shape::Cone { half_height: 0.25, radius: 0.2 },
    Shape::TaperedCapsule { half_height: 0.3, radius_bottom: 0.2, radius_top: 0.1 },
    // Cylinder as thick as a finger.
    Shape::Cylinder { half_height: 0.02, radius: 0.01 },
];

fn body(shape: &Shape, position: Vec3, rotation: Rotation) -> BodyDef {
    let mut def = ShapeDef::new(shape.clone());
    def.material.rolling = 0.002;
    BodyDef { position, rotation, shapes: vec![def], ..BodyDef::default() }
}

/// Adds a half-space, or a box with its top at height 0.
fn ground(world: &mut World, boxed: bool) {
    if boxed {
        let slab = box_body(Vec3::new(5.0, 0.5, 5.0), Vec3::new(0.0, -0.5, 0.0));
        world.add_body(&BodyDef { kind: BodyKind::Static, ..slab });
    } else {
        floor(world);
    }
}

/// Round shapes dropped upright or tilted come to rest on the ground without sinking in, and fall asleep.
#[test]
fn round_shapes_settle_and_sleep() {
    for boxed in [false, true] {
        for shape in &ROUND {
            for tilt in [0.0, 0.6] {
                let mut world = World::new(WorldDef::default());
                ground(&mut world, boxed);
                let turn = Rotation::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), tilt);
                let high = shape.bounding_radius() * 1.5;
                let id = world.add_body(&body(shape, Vec3::Y * high, turn));
                let mut steps = 0;
                while world.is_awake(id) && steps < 900 {
                    world.step();
                    steps += 1;
                }
                let at = world.transform(id);
                let lowest = shape.aabb(&at).min.y;
                let slop = 0.02 * shape.smallest_extent();
                assert!(!world.is_awake(id), "{shape:?} tilted {tilt} on box {boxed}: awake at {at:?}");
                assert!(
                    lowest.abs() < slop,
                    "{shape:?} tilted {tilt} on box {boxed}: its bottom is at {lowest}"
                );
            }
        }
    }
}

/// A cylinder that stands on its end stays there.
#[test]
fn a_standing_cylinder_stands_still() {
    for boxed in [false, true] {
        let mut world = World::new(WorldDef::default());
        ground(&mut world, boxed);
        let id = world.add_body(&body(&ROUND[0], Vec3::Y * 0.4, Rotation::IDENTITY));
        let start = world.transform(id);
        for _ in 0..240 {
            world.step();
        }
        let end = world.transform(id);
        assert!(
            (end.translation - start.translation).length() < 0.001,
            "box {boxed}: the cylinder must stay upright; its pose is {end:?}"
        );
        assert!(
            end.rotation.angle_to(start.rotation) < 0.001,
            "box {boxed}: the cylinder must stay upright; its pose is {end:?}"
        );
        assert!(!world.is_awake(id));
    }
}

/// A cylinder that rolls without slipping loses at most a twentieth of its speed in 2 s.
#[test]
fn a_lying_cylinder_rolls() {
    for boxed in [false, true] {
        let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
        ground(&mut world, boxed);
        let lying = Rotation::from_axis_angle(Vec3::X, FRAC_PI_2);
        let shape = Shape::Cylinder { half_height: 0.3, radius: 0.2 };
        let mut def = body(&shape, Vec3::new(-1.0, 0.2, 0.0), lying);
        def.shapes[0].material.rolling = 0.0;
        def.linear_velocity = Vec3::X;
        def.angular_velocity = Vec3::NEG_Z / 0.2;
        let id = world.add_body(&def);
        let mut highest = f32::NEG_INFINITY;
        for _ in 0..120 {
            world.step();
            highest = highest.max((world.transform(id).translation.y - 0.2).abs());
        }
        let v = world.velocity(id);
        println!(
            "box {boxed}: velocity {v:?}, height off by {highest} m, at {}",
            world.transform(id).translation
        );
        assert!((v.linear.x - 1.0).abs() < 0.05, "box {boxed}: velocity {v:?}, expected 1 m/s and -5 rad/s");
        assert!((v.angular.z + 5.0).abs() < 0.25, "box {boxed}: velocity {v:?}, expected 1 m/s and -5 rad/s");
        assert!(highest < 0.002, "box {boxed}: the height is off by {highest} m");
    }
}
