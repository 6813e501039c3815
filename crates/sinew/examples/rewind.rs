//! Time travel: `cargo run -p sinew --example rewind`.
//!
//! A snapshot restores the state bit for bit; a clone predicts the future.

use sinew::prelude::*;

/// Rewinds a world, and lets it take the same steps again.
pub fn main() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let dice: Vec<BodyId> = (0..5)
        .map(|i| {
            let spin = Vec3::new(3.0, 7.0, 5.0 * i as f32);
            let die = BodyDef::dynamic(Shape::cuboid(Vec3::splat(0.1))).at(Vec3::new(
                0.1 * i as f32,
                1.0 + i as f32,
                0.0,
            ));
            world.add_body(&BodyDef { angular_velocity: spin, ..die })
        })
        .collect();
    (0..60).for_each(|_| world.step());
    let mut bytes = Writer::new();
    world.save(&mut bytes);
    println!("a snapshot of {} bodies has {} bytes", dice.len() + 1, bytes.as_bytes().len());

    let mut prophet = world.clone();
    (0..120).for_each(|_| prophet.step());
    let foreseen = dice.iter().map(|&die| prophet.transform(die)).collect::<Vec<_>>();

    (0..120).for_each(|_| world.step());
    let rolled = dice.iter().map(|&die| world.transform(die)).collect::<Vec<_>>();
    assert_eq!(foreseen, rolled, "to the last bit");
    let hash = world.hash();

    world.load(&mut Reader::new(bytes.as_bytes())).expect("the saved state can be loaded");
    assert_ne!(world.hash(), hash, "two seconds younger");
    (0..120).for_each(|_| world.step());
    assert_eq!(world.hash(), hash, "and the same again");

    world.load(&mut Reader::new(bytes.as_bytes())).expect("the saved state can be loaded");
    world.apply_impulse_at_center(dice[0], Vec3::X * 0.5);
    (0..120).for_each(|_| world.step());
    assert_ne!(world.transform(dice[0]), rolled[0], "a pushed die moves differently");
}
