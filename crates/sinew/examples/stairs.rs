//! Stairs: `cargo run -p sinew --example stairs`.
//!
//! A character climbs a flight of stairs, crosses a landing and walks down a ramp. Foot placement keeps its feet on the
//! ground (`InWorld::foot_planting`); the example measures the distance of its lower foot from the ground at heel and
//! toes.

use sinew::prelude::*;
use std::sync::Arc;

/// Builds steps of 17 by 30 cm that rise toward +Z, a landing, and a ramp that falls by 15°.
fn build(world: &mut World) {
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    for step in 0..8 {
        let (top, half) = (0.17 * (step + 1) as f32, if step == 7 { 1.0 } else { 0.15 });
        let block = Shape::cuboid(Vec3::new(1.0, 0.5 * top, half));
        world.add_body(&BodyDef::fixed(block).at(Vec3::new(0.0, 0.5 * top, 1.0 + 0.3 * step as f32 + half)));
    }
    let turn = Rotation::from_axis_angle(Vec3::X, 15.0_f32.to_radians());
    let ramp = BodyDef::fixed(Shape::cuboid(Vec3::new(1.0, 0.1, 3.0)));
    let middle = Vec3::new(0.0, 1.36, 5.1) + turn * Vec3::new(0.0, -0.1, 3.0);
    world.add_body(&BodyDef { rotation: turn, ..ramp.at(middle) });
}

/// Returns the height of the ground at `z`, metres.
fn ground(z: f32) -> f32 {
    let stairs = 0.17 * (((z - 1.0) / 0.3).floor() + 1.0).clamp(0.0, 8.0);
    let ramp = 1.36 - (z - 5.1) * 0.268; // tan 15°
    if z < 5.1 { stairs } else { ramp.max(0.0) }
}

/// Lets a character walk up and down.
pub fn main() {
    let mut world = World::new(WorldDef::default());
    build(&mut world);
    let def = Arc::new(sinew::mannequin::character());
    let mut hero = Character::spawn(&mut world, &def, Transform::IDENTITY);
    hero.set_move(Vec3::Z * 1.1);
    hero.face(Vec3::Z);
    let feet = ["leftFoot", "rightFoot"].map(|foot| def.body_named(foot).expect("the body exists"));
    let (mut on_floor, mut highest) = (0.0_f32, 0.0_f32);
    for step in 0..600 {
        world.step();
        hero.update(&mut world);
        let over = feet.map(|foot| {
            let at = world.transform(hero.bodies()[foot]).translation;
            at.y - ground(at.z - 0.12).max(ground(at.z + 0.12))
        });
        let lower = over[0].min(over[1]);
        match step {
            0..60 => on_floor = on_floor.max(lower),
            _ => highest = highest.max(lower),
        }
    }
    let end = hero.world_from_character().translation;
    println!(
        "at {end}; its lower foot was at most {highest:.2} m over the ground, on the floor {on_floor:.2}"
    );
    assert!(end.z > 8.0 && hero.state() == State::Animated, "the walker arrives: {end}");
    assert!(highest < on_floor + 0.12, "one foot is always down: {highest}");
}
