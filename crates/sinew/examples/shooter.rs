//! A shooter: `cargo run -p sinew --example shooter`.
//!
//! A ray finds the bone. A weak hit makes the walker flinch, a strong one makes it fall, and it gets up again; a thrown
//! ball bounces off it.

use sinew::prelude::*;
use std::sync::Arc;

/// Shoots at a bone from in front; returns the bone that was hit.
fn shoot(world: &mut World, target: &mut Character, bone: &str, impulse: f32) -> Option<String> {
    let def = target.def().clone();
    let aim = world.center_of_mass(target.bodies()[def.body_named(bone)?]);
    let shot = Ray { origin: aim + Vec3::Z * 20.0, direction: Vec3::Z * -40.0 };
    let hit = world.query().first(&shot)?;
    target.hit_at(world, &hit, Vec3::Z * -impulse)?;
    target.body_index(hit.body).map(|body| def.ragdoll.bodies[body].role.clone())
}

fn run(world: &mut World, target: &mut Character, seconds: f32) -> Vec<CharacterEvent> {
    let mut told = Vec::new();
    for _ in 0..(seconds * 60.0) as usize {
        world.step();
        target.update(world);
        told.extend_from_slice(target.events());
    }
    told
}

/// Shoots twice, and throws a ball.
pub fn main() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let def = Arc::new(sinew::mannequin::character());
    let mut target = Character::spawn(&mut world, &def, Transform::IDENTITY);
    run(&mut world, &mut target, 1.0);

    let bone = shoot(&mut world, &mut target, "head", 5.0);
    println!("a graze at the {}: {:?}", bone.as_deref().unwrap_or("air"), target.state());
    assert_eq!((bone.as_deref(), target.state()), (Some("head"), State::Flinching));
    run(&mut world, &mut target, 1.0);
    assert_eq!(target.state(), State::Animated, "it walks on");

    let ahead = target.world_from_character().translation + Vec3::new(0.0, 1.3, 3.0);
    let mut ball =
        BodyDef::dynamic(ShapeDef { density: 80.0, ..ShapeDef::new(Shape::Sphere { radius: 0.11 }) });
    (ball.linear_velocity, ball.shapes[0].material.restitution) = (Vec3::new(0.0, 0.5, -15.0), 0.7);
    let ball = world.add_body(&ball.at(ahead));
    let told = run(&mut world, &mut target, 0.4);
    println!("a ball comes back at {:.1} m/s: {told:?}", world.velocity(ball).linear.z);
    assert!(world.velocity(ball).linear.z > 5.0, "it bounced off");
    assert!(told.iter().any(|event| matches!(event, CharacterEvent::Struck { .. })), "and was felt");

    run(&mut world, &mut target, 1.0);
    let bone = shoot(&mut world, &mut target, "chest", 90.0);
    assert_eq!((bone.is_some(), target.state()), (true, State::Limp), "that fells it");
    let told = run(&mut world, &mut target, 12.0);
    assert!(told.contains(&CharacterEvent::Up), "the walker gets up again: {told:?}");
    println!("events of the fall: {told:?}");
}
