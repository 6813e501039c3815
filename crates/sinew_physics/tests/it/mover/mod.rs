//! Movers, compared with closed forms and with queries of the world at their positions.

mod clutter;
mod ground;
mod push;
mod ride;
mod state;
mod walls;

use sinew_math::{Rotation, Transform, Vec3};
use sinew_physics::*;

/// Returns a world with a floor at height 0.
pub fn level() -> World {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    world
}

/// Adds a fixed box between two corners.
pub fn block(world: &mut World, min: Vec3, max: Vec3) -> BodyId {
    let half_extents = (max - min) * 0.5;
    world.add_body(&BodyDef::fixed(Shape::Box { half_extents }).at((min + max) * 0.5))
}

/// Adds a fixed box, rotated about z around its centre.
pub fn turned(world: &mut World, half_extents: Vec3, at: Vec3, angle: f32) -> BodyId {
    let mut def = BodyDef::fixed(Shape::Box { half_extents }).at(at);
    def.rotation = Rotation::from_axis_angle(Vec3::Z, angle);
    world.add_body(&def)
}

/// Runs two seconds and checks that the mover is then on the ground.
pub fn settle(world: &mut World, id: MoverId) {
    for _ in 0..120 {
        world.step();
    }
    assert!(
        world.mover(id).is_grounded(),
        "the mover must be on the ground; it is at {}",
        world.mover(id).position()
    );
}

/// Returns the largest penetration depth of a mover's capsule, metres. Uses queries of the world.
pub fn depth(world: &World, id: MoverId) -> f32 {
    let mover = world.mover(id);
    let shape = Shape::Capsule { half_height: mover.half_height(), radius: mover.def().radius };
    let world_from_shape = Transform::from_translation(mover.center());
    let mut found = Vec::new();
    world.query().all(&PenetrationOf(Probe { shape, world_from_shape }), &mut found);
    found.first().map_or(0.0, |deepest| deepest.depth)
}

/// Returns the number of random cases: `few`, or `all` with `SINEW_FULL` set.
pub fn cases(few: usize, all: usize) -> usize {
    if std::env::var_os("SINEW_FULL").is_some() { all } else { few }
}
