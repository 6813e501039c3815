//! An active ragdoll: `cargo run -p sinew --example active_ragdoll`.
//!
//! Muscles follow the clips of a walking ragdoll. It recovers from light pushes by steps; a hard push makes it fall,
//! and it gets up.

use sinew::prelude::*;
use std::sync::Arc;

/// Lets the ragdoll walk for `seconds`; returns the largest horizontal distance of its chest from its feet, metres.
fn walk(world: &mut World, puppet: &mut Character, seconds: f32) -> f32 {
    let chest = puppet.def().body_named("chest").expect("the character has this body");
    let mut sway = 0.0;
    for _ in 0..(seconds * 60.0) as usize {
        world.step();
        puppet.update(world);
        let off =
            world.transform(puppet.bodies()[chest]).translation - puppet.world_from_character().translation;
        sway = f32::max(sway, off.x.abs());
    }
    sway
}

/// Pushes the ragdoll, first lightly, then hard.
pub fn main() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));

    // The complete setup.
    let def = Arc::new(sinew::mannequin::character());
    let mut puppet = Character::spawn(&mut world, &def, Transform::IDENTITY);
    puppet.set_preset(&mut world, Preset::Powered);

    let calm = walk(&mut world, &mut puppet, 2.0);
    let chest = def.body_named("chest").expect("the character has this body");
    puppet.hit(&mut world, chest, Vec3::X * 40.0);
    let pushed = walk(&mut world, &mut puppet, 2.0);
    let aside = puppet.world_from_character().translation.x;
    println!("the chest sways by {calm:.2} m, pushed by {pushed:.2} m; it steps {aside:.2} m aside");
    assert!(puppet.state() == State::Powered && pushed > calm && aside > 0.1);

    puppet.hit(&mut world, chest, Vec3::X * 300.0);
    walk(&mut world, &mut puppet, 1.5);
    assert_eq!(puppet.state(), State::Limp);
    walk(&mut world, &mut puppet, 10.0);
    assert_eq!(puppet.state(), State::Animated, "the ragdoll has got up");
    assert_eq!(puppet.bodies().len(), def.ragdoll.bodies.len());
}
