//! A rope: `cargo run -p sinew --example rope`.
//!
//! Particles between a hook and a load: the load swings, and the hook moves away.

use sinew::prelude::*;

/// Lets a load swing on a rope of 2 m.
pub fn main() {
    let mut world = World::new(WorldDef::default());
    let hook = world.add_body(&BodyDef::kinematic(Shape::sphere(0.05)).at(Vec3::Y * 4.0));
    let load = world.add_body(&BodyDef::dynamic(Shape::sphere(0.15)).at(Vec3::new(2.15, 4.0, 0.0)));
    let def = RopeDef::between(Vec3::Y * 4.0, Vec3::new(2.0, 4.0, 0.0));
    let mut rope = def.build();
    let (first, last) = (rope.first, rope.last);
    rope.group.attachments = vec![
        AttachmentDef::to_body(first, hook, Vec3::ZERO),
        AttachmentDef::to_body(last, load, Vec3::X * -0.15),
    ];
    let rope = world.add_particles(&rope.group);

    let mut lowest = f32::INFINITY;
    for _ in 0..120 {
        world.step();
        lowest = lowest.min(world.transform(load).translation.y);
    }
    println!("it swung through {lowest:.2} m");
    assert!((lowest - 1.85).abs() < 0.05, "a rope and half a load below the hook");

    // The hook moves at walking pace.
    let dt = world.def().dt();
    for step in 1..=240 {
        let to = Vec3::new(1.2 * dt * step as f32, 4.0, 0.0);
        world.move_to(hook, Transform::from_translation(to), dt);
        world.step();
    }
    let (hook, load) = (world.transform(hook).translation, world.transform(load).translation);
    let end = world.particles(rope).positions()[last as usize];
    println!("the hook is at {hook:.2}, the load at {load:.2}, the rope ends at {end:.2}");
    assert!((hook.x - 4.8).abs() < 0.01 && (load - hook).length() < 2.25, "the load follows the hook");
    assert!((end - load).length() < 0.16, "the load stays on its rope");
}
