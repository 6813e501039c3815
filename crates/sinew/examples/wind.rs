//! Fields: `cargo run -p sinew --example wind`.
//!
//! Wind blows leaves away, light things float on water, and a bomb explodes.

use sinew::prelude::*;

fn run(world: &mut World, seconds: f32) {
    (0..(seconds * 60.0) as usize).for_each(|_| world.step());
}

/// Adds three fields.
pub fn main() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace).at(Vec3::Y * -3.0));
    let of = |density, shape| ShapeDef { density, ..ShapeDef::new(shape) };
    let leaf = world
        .add_body(&BodyDef::dynamic(of(30.0, Shape::cuboid(Vec3::new(0.1, 0.002, 0.1)))).at(Vec3::Y * 5.0));
    let stone =
        world.add_body(&BodyDef::dynamic(of(2500.0, Shape::sphere(0.1))).at(Vec3::new(1.0, 5.0, 0.0)));
    let cork = world
        .add_body(&BodyDef::dynamic(of(200.0, Shape::cuboid(Vec3::splat(0.2)))).at(Vec3::new(2.0, 1.0, 0.0)));

    let wind = Wind { velocity: Vec3::Z * 8.0, ..Wind::default() };
    let wind = world.add_field(&FieldDef::new(FieldKind::Wind(wind)));
    run(&mut world, 0.8);
    let blown = |id| world.transform(id).translation.z;
    println!("after 0.8 s the leaf is {:.2} m off, the stone {:.2} m", blown(leaf), blown(stone));
    assert!(blown(leaf) > 2.0 && blown(stone) < 0.2);
    world.remove_field(wind);

    world.add_field(&FieldDef::new(FieldKind::Buoyancy(Buoyancy::default()))); // water below y = 0
    run(&mut world, 12.0);
    let height = |id| world.transform(id).translation.y;
    println!("the cork floats at {:.2} m, the stone lies at {:.2} m", height(cork), height(stone));
    assert!((height(cork) - 0.12).abs() < 0.03, "a fifth of the cork is under water");
    assert!(height(stone) < -2.85, "the stone sank");

    let center = world.transform(cork).translation - Vec3::Y * 0.5;
    world.explode(&Explosion::new(center, 3.0, 200.0));
    println!("the bomb throws the cork at {:.1} m/s", world.velocity(cork).linear.y);
    assert!(world.velocity(cork).linear.y > 1.0);
}
