//! Runs code once in advance, because browsers compile it at the first call.

use sinew::math::Transform;
use sinew::physics::{BodyDef, Shape, World, WorldDef};
use sinew::ragdoll::Character;
use std::sync::Arc;
use wasm_bindgen::prelude::*;

/// Steps of the warm-up fall. With 90 the first fall is 1.4 times as slow as the second, with 40 2.2 times, without 8
/// times (Node 20).
const STEPS: u32 = 90;

/// Lets a mannequin fall in a separate world, so that the first fall of a program is hardly slower than the next.
/// `init` calls it by default.
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
