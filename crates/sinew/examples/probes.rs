//! Queries of a game: `cargo run -p sinew --example probes`.
//!
//! A laser finds the first body in its way, a grenade finds the people in sight, a foot finds the ground below it, and
//! a door checks whether it may close.

use sinew::prelude::*;

/// Collision layers of this game.
const LEVEL: u32 = 1;
const PEOPLE: u32 = 2;

fn on(layers: u32, shape: Shape) -> ShapeDef {
    ShapeDef { filter: Filter { layers, ..Filter::default() }, ..ShapeDef::new(shape) }
}

/// Returns a floor, a wall, stairs, and three people, one of them behind the wall.
fn level() -> (World, [BodyId; 3]) {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(on(LEVEL, Shape::HalfSpace)));
    let wall = Shape::Box { half_extents: Vec3::new(0.1, 1.5, 2.0) };
    world.add_body(&BodyDef::fixed(on(LEVEL, wall)).at(Vec3::new(3.0, 1.5, 0.0)));
    for step in 0..3 {
        let tread = Shape::Box { half_extents: Vec3::new(0.5, 0.1, 0.15) };
        let at = Vec3::new(0.0, 0.1 + 0.2 * step as f32, -2.0 - 0.3 * step as f32);
        world.add_body(&BodyDef::fixed(on(LEVEL, tread)).at(at));
    }
    let person = Shape::Capsule { half_height: 0.6, radius: 0.3 };
    let stand = |x: f32, z: f32| BodyDef::dynamic(on(PEOPLE, person.clone())).at(Vec3::new(x, 0.9, z));
    let people = [stand(0.0, 0.0), stand(2.0, 1.0), stand(5.0, 0.0)].map(|def| world.add_body(&def));
    (world, people)
}

/// Returns the first body that a ray hits.
fn laser(world: &World, from: Vec3, to: Vec3) -> Option<BodyHit> {
    world.query().first(&Ray::between(from, to))
}

/// Returns the people within `radius` of a blast who are not hidden by the level.
fn hurt_by_grenade(world: &World, blast: Vec3, radius: f32) -> Vec<BodyId> {
    let people = QueryFilter {
        meets: Filter { mask: PEOPLE, ..QueryFilter::default().meets },
        ..QueryFilter::default()
    };
    let level = QueryFilter::of(BodyKinds::STATIC);
    let mut hurt = Vec::new();
    world.query().filter(people).bodies(&NearestTo { point: blast, within: radius }, &mut hurt);
    hurt.retain(|&id| !world.query().filter(level).any(&Ray::between(blast, world.center_of_mass(id))));
    hurt
}

/// Returns the height of the ground under a foot and its slope, radians. Casts a ball, because cracks do not catch it.
fn ground_below(world: &World, owner: BodyId, foot: Vec3) -> Option<(f32, f32)> {
    let sole = Probe::at(Shape::Sphere { radius: 0.08 }, foot + Vec3::Y * 0.5);
    let step = ShapeCast { probe: sole, translation: Vec3::Y * -1.5 };
    let hit = world.query().filter(QueryFilter::without(&[owner])).first(&step)?;
    // A cast that starts inside a shape gives no information about the ground.
    hit.start.is_none().then(|| (hit.point.y, sinew::math::trig::acos(hit.normal.y)))
}

/// True if the doorway is free.
fn may_close(world: &World, doorway: Aabb) -> bool {
    !world.query().filter(QueryFilter::of(BodyKinds::DYNAMIC)).any(&OverlapWith(doorway.into()))
}

/// Runs each query once, and checks the answers.
pub fn main() {
    let (world, [first, second, hidden]) = level();

    let eye = Vec3::new(0.0, 1.5, 0.0);
    let lit = laser(&world, eye + Vec3::X * 0.4, eye + Vec3::X * 9.0).expect("the wall is in the way");
    println!("the laser ends at {} after {:.0} % of its way", lit.point, 100.0 * lit.fraction);
    assert!((lit.point.x - 2.9).abs() < 1e-5 && lit.normal == Vec3::NEG_X);

    let hurt = hurt_by_grenade(&world, Vec3::new(1.5, 0.5, 0.0), 4.0);
    println!("the grenade hurts {} of 3", hurt.len());
    assert_eq!(hurt, [first, second], "the wall hides {hidden:?}");

    let (height, slope) = ground_below(&world, first, Vec3::new(0.1, 0.3, -2.3)).expect("the stairs");
    println!("a foot stands at {height:.3} m, where the ground slopes by {slope:.3}");
    assert!((height - 0.4).abs() < 1e-4 && slope < 1e-3);

    assert!(may_close(&world, Aabb::around(Vec3::new(-3.0, 1.0, 0.0), Vec3::new(0.5, 1.0, 0.1))));
    assert!(!may_close(&world, Aabb::around(Vec3::new(2.0, 1.0, 1.2), Vec3::new(0.5, 1.0, 0.1))));
}
