//! Runs code in advance, because browsers compile it at the first call.

use sinew::math::Transform;
use sinew::physics::{BodyDef, Shape, World, WorldDef};
use sinew::ragdoll::Character;
use std::sync::Arc;
use wasm_bindgen::prelude::*;

/// Number of steps of the warm-up fall. With 90 steps the first fall is 1.4 times as slow as the second, with 40 2.2
/// times, without a warm-up 8 times (Node 20).
const STEPS: u32 = 90;

/// Simulates the fall of a mannequin in a separate world, so that the first fall of a program is hardly slower than
/// the next. `init` calls this function by default.
#[wasm_bindgen(js_name = warmUp)]
pub fn warm_up() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let def = Arc::new(sinew::mannequin::character());
    let mut one = Character::spawn(&mut world, &def, Transform::IDENTITY);
    one.go_limp(&mut world);
    for _ in 0..STEPS {
        world.step();
        one.update(&mut world);
    }
}
