//! A player: `cargo run -p sinew --example player`.
//!
//! A character walks over a floor, pushes a crate, climbs a step, rides a lift and jumps off. A game needs three calls
//! per frame: set the velocity, step the world, update the character.

use sinew::prelude::*;
use std::sync::Arc;

/// Walks with a velocity for `seconds`.
fn go(world: &mut World, player: &mut Character, velocity: Vec3, seconds: f32) {
    player.set_move(velocity);
    player.face(velocity);
    for _ in 0..(seconds * 60.0) as usize {
        world.step();
        player.update(world);
    }
}

fn feet(player: &Character) -> Vec3 {
    player.world_from_character().translation
}

/// Walks, pushes a crate, climbs a step, rides a lift, jumps.
pub fn main() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let kerb = Shape::cuboid(Vec3::new(2.0, 0.1, 0.5));
    world.add_body(&BodyDef::fixed(kerb).at(Vec3::new(0.0, 0.1, -2.0)));
    let light = ShapeDef { density: 139.0, ..ShapeDef::new(Shape::cuboid(Vec3::splat(0.3))) }; // 30 kg
    let load = world.add_body(&BodyDef::dynamic(light).at(Vec3::new(0.0, 0.3, 1.5)));
    let lift = Shape::cuboid(Vec3::new(1.0, 0.1, 1.0));
    let platform = world.add_body(&BodyDef::kinematic(lift).at(Vec3::new(3.0, -0.05, 0.0)));

    let mut player =
        Character::spawn(&mut world, &Arc::new(sinew::mannequin::character()), Transform::IDENTITY);
    go(&mut world, &mut player, Vec3::Z * 1.2, 2.0);
    let pushed = world.transform(load).translation.z - 1.5;
    println!("the crate was pushed by {pushed:.2} m");
    assert!(pushed > 0.5);

    go(&mut world, &mut player, Vec3::Z * -1.5, 2.6);
    assert!((feet(&player).y - 0.2).abs() < 0.01, "it stands on the kerb, at {}", feet(&player));
    go(&mut world, &mut player, Vec3::new(1.2, 0.0, 0.8), 2.4);

    go(&mut world, &mut player, Vec3::ZERO, 0.5);
    world.set_velocity(platform, Velocity { linear: Vec3::Y, ..Velocity::default() });
    go(&mut world, &mut player, Vec3::ZERO, 1.0);
    world.set_velocity(platform, Velocity::default());
    println!("the lift has taken it to {:.2}", feet(&player));
    assert!(feet(&player).y > 0.9, "it rode the lift: {}", feet(&player));

    player.jump(&mut world);
    go(&mut world, &mut player, Vec3::X * 3.0, 1.5);
    assert!(feet(&player).y.abs() < 0.01 && feet(&player).x > 4.0, "it jumped off: {}", feet(&player));
    player.despawn(&mut world);
    assert_eq!(world.body_ids().count(), 4, "the player's bodies are removed");
}
