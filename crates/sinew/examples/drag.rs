//! A mouse drags a limp character by the hand; then another character takes its wrist and drags it away.
//!
//! `cargo run --release --example drag -p sinew`

use sinew::prelude::*;
use std::sync::Arc;

fn main() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let def = Arc::new(sinew::mannequin::character());
    let body = |name: &str| def.body_named(name).expect("the character has this body");
    let mut puppet = Character::spawn(&mut world, &def, Transform::IDENTITY);
    puppet.go_limp(&mut world);
    // The mouse takes the hand at its position and pulls with at most `Grab::speed` and `Grab::max_force`.
    let hand = puppet.bodies()[body("rightHand")];
    let at = world.center_of_mass(hand);
    let mut mouse = GrabPoint::take(&mut world, hand, at, &Grab::POINT).expect("the hand is there");
    for step in 0..360 {
        let side = if step < 180 { 1.0 } else { -1.0 };
        mouse.set_target(Vec3::new(side, 2.0, 0.0));
        mouse.update(&mut world);
        world.step();
        puppet.update(&mut world);
    }
    let away = (world.center_of_mass(hand) - mouse.target()).length();
    println!(
        "the hand hangs {:.0} mm from the mouse, with {:.0} N",
        1e3 * away,
        world.reaction(mouse.joint()).force.length()
    );
    assert!(away < 0.1 && puppet.state() == State::Limp, "a held character does not get up");
    // Another character takes the hand and walks away with it.
    let at = world.center_of_mass(hand) * Vec3::new(1.0, 0.0, 1.0);
    let mut hero =
        Character::spawn(&mut world, &def, Transform::from_translation(at + Vec3::new(-0.3, 0.0, 0.3)));
    let grab = Grab { reach: 1.5, ..Grab::HAND };
    let grip = hero.grab(&mut world, "leftHand", hand, &grab).expect("the body is within reach");
    mouse.release(&mut world);
    hero.set_move(Vec3::ZERO);
    for step in 0..480 {
        if step == 120 {
            hero.set_move(Vec3::Z * 1.2);
        }
        world.step();
        hero.update(&mut world);
        puppet.update(&mut world);
    }
    let way = world.transform(puppet.bodies()[0]).translation.z;
    println!("it was dragged {way:.1} m");
    assert!(world.contains_joint(grip) && way > 3.0);
    // After its release the character gets up.
    hero.release(&mut world, hand);
    for _ in 0..900 {
        world.step();
        hero.update(&mut world);
        puppet.update(&mut world);
    }
    assert_eq!(puppet.state(), State::Animated);
}
