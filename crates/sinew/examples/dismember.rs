//! A knight loses an arm and walks on, then loses a leg and falls. Each limb has its own bodies and its part of the skin.
//!
//! `cargo run --release --example dismember -p sinew`

use sinew::prelude::*;
use std::sync::Arc;

/// Steps the world with the knight, and prints its events.
fn play(world: &mut World, knight: &mut Character, seconds: f32) {
    for _ in 0..(seconds * 60.0) as usize {
        world.step();
        knight.update(world);
        for event in knight.events() {
            match event {
                CharacterEvent::Detached { body } => {
                    println!("{:5.2} s: loses its {}", world.time(), knight.def().ragdoll.bodies[*body].role);
                }
                CharacterEvent::WentLimp => println!("{:5.2} s: falls", world.time()),
                CharacterEvent::Settled { .. } => println!("{:5.2} s: lies still", world.time()),
                _ => {}
            }
        }
    }
}

fn main() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let def = Arc::new(sinew::mannequin::character());
    let mut knight = Character::spawn(&mut world, &def, Transform::IDENTITY);
    play(&mut world, &mut knight, 1.0);
    // Without an arm the knight walks on. The limb falls, and has its joints of the skin.
    let mut arm = knight.detach(&mut world, "leftUpperArm").expect("the knight has this arm");
    println!(
        "the arm has {} bodies and {} joints of the skin",
        arm.bodies().len(),
        arm.skin_joints().count()
    );
    play(&mut world, &mut knight, 1.0);
    assert_eq!(knight.state(), State::Animated);
    // Without a leg the knight falls, and stays down.
    let leg = knight.detach(&mut world, "rightLowerLeg").expect("the knight has this leg");
    play(&mut world, &mut knight, 8.0);
    assert_eq!(knight.state(), State::Limp);
    // A detached limb can be cut again.
    let hand = arm.detach(&mut world, "leftHand").expect("the arm has a hand");
    assert!(knight.detach(&mut world, "leftHand").is_none(), "the hand went with the arm");

    // For a renderer: one mesh per part, with the other vertices shrunk to the cut.
    let (mut body, mut limb) = (Vec::new(), Vec::new());
    knight.skin_palette(0, 1.0, &mut body);
    arm.skin_palette(&world, 0, 1.0, &mut limb);
    assert_eq!(body.len(), limb.len());

    for limb in [arm, hand, leg] {
        limb.despawn(&mut world);
    }
    knight.despawn(&mut world);
    assert_eq!(world.body_ids().count(), 1, "the ground is left");
}
