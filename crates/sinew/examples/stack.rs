//! A stack: `cargo run -p sinew --example stack`.
//!
//! Ten boxes stand on each other until a ball knocks them over. `bodies_moved` lists only the poses that changed.

use sinew::prelude::*;

/// Steps the world for this many seconds; returns the number of changed poses.
fn run(world: &mut World, seconds: f32) -> usize {
    (0..(seconds * 60.0) as usize).fold(0, |moved, _| {
        world.step();
        moved + world.bodies_moved().count()
    })
}

/// Builds a tower and throws a ball at it.
pub fn main() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let shape = Shape::cuboid(Vec3::splat(0.25));
    let place = |floor: usize| Vec3::Y * (0.25 + 0.5 * floor as f32);
    let tower: Vec<BodyId> =
        (0..10).map(|floor| world.add_body(&BodyDef::dynamic(shape.clone()).at(place(floor)))).collect();
    run(&mut world, 3.0);
    let top = world.transform(tower[9]).translation;
    println!("the top is at {top:.3}");
    assert!((top - place(9)).length() < 0.02, "it stands where it was built: {top}");
    assert_eq!(run(&mut world, 1.0), 0, "the sleeping tower has no changed pose");

    let heavy = ShapeDef { density: 5000.0, ..ShapeDef::new(Shape::sphere(0.3)) };
    let throw = BodyDef { linear_velocity: Vec3::X * 12.0, ..BodyDef::dynamic(heavy) };
    world.add_body(&throw.at(Vec3::new(-4.0, 2.5, 0.0)));
    let moved = run(&mut world, 4.0);
    let fallen = tower.iter().filter(|&&id| world.transform(id).translation.x.abs() > 0.3).count();
    println!("{fallen} of 10 fell, {moved} poses were fetched");
    assert!(fallen >= 4 && moved > 100);
}
