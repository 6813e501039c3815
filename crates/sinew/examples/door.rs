//! A door: `cargo run -p sinew --example door`.
//!
//! A hinge with limits, a spring that closes it, a latch that breaks, and a motor.

use sinew::prelude::*;

fn angle(world: &World, hinge: JointId) -> f32 {
    world.joint_transform(hinge).rotation.twist_angle(Vec3::X).to_degrees()
}

fn run(world: &mut World, seconds: f32) -> Vec<JointId> {
    let mut broken = Vec::new();
    for _ in 0..(seconds * 60.0) as usize {
        world.step();
        broken.extend_from_slice(&world.events().broken);
    }
    broken
}

/// Kicks a door open, then lets a motor open it.
pub fn main() {
    let mut world = World::new(WorldDef::default());
    let frame = world.add_body(&BodyDef::fixed(Shape::cuboid(Vec3::new(0.05, 1.0, 0.05))).at(Vec3::Y));
    let panel = ShapeDef { density: 300.0, ..ShapeDef::new(Shape::cuboid(Vec3::new(0.45, 1.0, 0.02))) };
    let door = world.add_body(&BodyDef::dynamic(panel).at(Vec3::new(0.5, 1.0, 0.0)));
    let closing = Softness::Frequency { hertz: 0.4, damping_ratio: 1.0 };
    let hinge = JointDef {
        spring: Some(Spring { softness: closing, rest: Transform::IDENTITY }),
        ..world.hinge(frame, door, Vec3::new(0.05, 1.0, 0.0), Vec3::Y).limited(Range { lo: -1.9, hi: 1.9 })
    };
    let hinge = world.add_joint(&hinge);
    let handle = Vec3::new(0.9, 1.0, 0.0);
    let latch = JointDef {
        strength: Strength { force: 500.0, torque: f32::INFINITY },
        ..world.ball(frame, door, handle)
    };
    let latch = world.add_joint(&latch);

    world.apply_impulse(door, Vec3::Z * -5.0, handle);
    assert!(run(&mut world, 1.0).is_empty() && angle(&world, hinge).abs() < 0.1, "the latch holds");
    let mut broken = Vec::new();
    for _ in 0..4 {
        world.apply_force(door, Vec3::Z * -900.0, handle); // acts in the next step only
        broken.extend(run(&mut world, 1.1 / 60.0));
    }
    assert_eq!(broken, [latch], "a kick breaks it");
    run(&mut world, 0.3);
    println!("kicked open: {:.0}°", angle(&world, hinge));
    assert!(angle(&world, hinge) > 30.0);
    run(&mut world, 5.0);
    println!("closed by its spring: {:.1}°", angle(&world, hinge));
    assert!(angle(&world, hinge).abs() < 2.0);

    world.set_motor(hinge, Some(Motor::spin(-0.5, 200.0)));
    run(&mut world, 2.0);
    println!("opened by a motor to the other side: {:.0}°", angle(&world, hinge));
    assert!((angle(&world, hinge) + 57.0).abs() < 3.0);
}
