//! Your own file: `cargo run --release -p sinew --example your_character -- hero.glb`; without a file, the mannequin.
//!
//! One call reads the file, builds the ragdoll and chooses walk, idle and get-ups among its clips. The notes list the
//! choices.

use sinew::prelude::*;
use std::sync::Arc;

/// Returns the mannequin, from the bytes of a file.
pub fn mannequin() -> sinew::LoadedCharacter {
    use sinew::formats::{ReadOptions, no_files, read_gltf, write_gltf};
    let own = sinew::mannequin::mannequin();
    let bytes = write_gltf(&own.rig, &own.clips).expect("the rig can be written as glTF");
    let file =
        read_gltf(&bytes, ReadOptions::default(), &mut no_files).expect("the written glTF can be read");
    sinew::character_of(file, "mannequin.glb", &Default::default()).expect("the file has a skin")
}

/// Runs the given file, or the mannequin.
pub fn main() {
    match std::env::args_os().nth(1) {
        Some(path) => run(sinew::load_character(path).unwrap_or_else(|error| panic!("{error}"))),
        None => run(mannequin()),
    }
}

/// Lets the character walk, hits it, and lets it get up and walk on.
pub fn run(hero: sinew::LoadedCharacter) {
    for note in &hero.notes {
        println!("{note}");
    }
    let def = Arc::new(hero.def);
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let mut hero = Character::spawn(&mut world, &def, Transform::IDENTITY);
    hero.set_move(Vec3::Z * 1.2); // m/s

    for step in 0..900 {
        if step == 120 {
            let chest = def.body_named("chest").or(def.body_named("spine")).unwrap_or(0);
            hero.hit(&mut world, chest, Vec3::new(0.8, 0.0, -0.8) * def.ragdoll.total_mass); // N·s
        }
        world.step();
        hero.update(&mut world);
        for event in hero.events() {
            match event {
                CharacterEvent::Clip(fired) => {
                    let step = def.set().event(fired);
                    println!("{:5.2} s: {} {}", world.time(), step.name, step.payload);
                }
                other => println!("{:5.2} s: {other:?}", world.time()),
            }
        }
    }
    println!("it ends {:?} at {}", hero.state(), hero.world_from_character().translation);
    let stays_down = hero.state() == State::Limp;
    assert!(stays_down || hero.state() == State::Animated, "it is up again, or has nothing to get up by");
}
