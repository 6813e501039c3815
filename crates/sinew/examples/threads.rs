//! Threads: `cargo run --release -p sinew --example threads`.
//!
//! Steps the same pile on one thread and on all threads: equal numbers of steps give equal bits.

use sinew::prelude::*;

fn pile() -> World {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    for i in 0..200_u32 {
        let place = Vec3::new((i % 5) as f32, (i / 25) as f32 + 0.5, (i / 5 % 5) as f32) * 0.5;
        let shape = match i % 3 {
            0 => Shape::cuboid(Vec3::splat(0.2)),
            1 => Shape::sphere(0.22),
            _ => Shape::capsule(0.12, 0.12),
        };
        world.add_body(&BodyDef::dynamic(shape).at(place));
    }
    world
}

/// Steps two worlds side by side.
pub fn main() {
    let (mut one, mut many) = (pile(), pile());
    let threads = sinew::all_threads();
    for step in 0..120 {
        one.step();
        many.step_with(&threads, &NoProfiler);
        assert_eq!(one.hash(), many.hash(), "step {step}");
    }
    println!("{} bodies, {} steps: {:016x} on one thread and on all", 201, one.step_count(), one.hash());
}
