//! A character: `cargo run -p sinew --example character_get_up`.
//!
//! The character walks, is struck, falls, lies, gets up and walks on. The drawn pose never jumps.

use sinew::prelude::*;
use std::sync::Arc;

/// Knocks a walking character down.
pub fn main() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let def = Arc::new(sinew::mannequin::character());
    let mut hero = Character::spawn(&mut world, &def, Transform::IDENTITY);
    hero.set_move(Vec3::Z * 1.2);

    let chest = def.body_named("chest").expect("the mannequin has one");
    let (mut seen, mut farthest, mut last) = (vec![hero.state()], 0.0_f32, None);
    for step in 0..900 {
        if step == 90 {
            hero.hit(&mut world, chest, Vec3::new(60.0, 0.0, -60.0)); // N·s
        }
        world.step();
        hero.update(&mut world); // after each step
        if hero.state() != *seen.last().expect("the list is not empty") {
            println!("{:5.2} s: {:?}", world.time(), hero.state());
            seen.push(hero.state());
        }
        // Footsteps are events as well.
        for event in hero.events().iter().filter(|event| !matches!(event, CharacterEvent::Clip(_))) {
            println!("{:5.2} s: {event:?}", world.time());
        }
        // The pose for a renderer, in the file's own joints.
        let head = world.center_of_mass(hero.bodies()[def.body_named("head").expect("and a head")]);
        farthest = farthest.max(last.map_or(0.0, |last: Vec3| (head - last).length()));
        last = Some(head);
    }
    let due = [State::Animated, State::Limp, State::GettingUp, State::Animated];
    let mut rest = seen.iter();
    assert!(due.iter().all(|state| rest.any(|one| one == state)), "{seen:?}");
    println!("its head moved by at most {farthest:.2} m in a step");
    assert!(farthest < 0.2, "the head moves at less than 12 m/s, so the pose does not jump");
    assert!(hero.world_from_character().translation.z > 3.0, "the character walked on");
}
