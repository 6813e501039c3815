//! Code that is run once before it counts: browsers compile it when it is first called.

use sinew::math::{Transform, Vec3};
use sinew::physics::{BodyDef, Shape, World, WorldDef};
use sinew::ragdoll::Character;
use std::sync::Arc;
use wasm_bindgen::prelude::*;

/// Steps of the falls that warm the code up: enough for a browser's optimising compiler to take it on.
const STEPS: u32 = 90;

/// Lets two mannequins fall on each other in a world of its own, so that the first fall of a program is no slower than the next.
/// `init` calls it unless it is told not to.
#[wasm_bindgen(js_name = warmUp)]
pub fn warm_up() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let def = Arc::new(sinew::mannequin::character());
    let place = |x: f32| Transform::from_translation(Vec3::new(x, 0.0, 0.0));
    let mut both = [0.0, 0.4].map(|x| Character::spawn(&mut world, &def, place(x)));
    both.iter_mut().for_each(|one| one.go_limp(&mut world));
    for _ in 0..STEPS {
        world.step();
        both.iter_mut().for_each(|one| one.update(&mut world));
    }
}
