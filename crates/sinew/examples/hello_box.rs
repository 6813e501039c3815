//! The first program: `cargo run -p sinew --example hello_box`.
//!
//! A box falls on the ground and comes to rest.

use sinew::prelude::*;

/// Drops a box from 2 m.
pub fn main() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let crate_ = world.add_body(&BodyDef::dynamic(Shape::cuboid(Vec3::splat(0.5))).at(Vec3::Y * 2.5));
    for step in 0..180 {
        world.step(); // 1/60 s
        if step % 20 == 0 {
            let height = world.transform(crate_).translation.y;
            println!("{:.2} s: {height:.3} m, {:.2} m/s", world.time(), world.velocity(crate_).linear.y);
        }
    }
    assert!((world.transform(crate_).translation.y - 0.5).abs() < 0.01, "the box lies on the ground");
    assert!(!world.is_awake(crate_), "the box sleeps");
}
