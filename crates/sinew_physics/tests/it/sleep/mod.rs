//! Sleep: which bodies fall asleep, and what wakes them.

mod particles;
mod rest;
mod wake;

use crate::build::{box_body, floor};
use sinew_math::Vec3;
use sinew_physics::*;

/// Steps within which all bodies in these worlds come to rest.
const ENOUGH: usize = 300;

fn run(world: &mut World, steps: usize) {
    for _ in 0..steps {
        world.step();
    }
}

fn all_asleep(world: &World) -> bool {
    world.body_ids().filter(|&id| world.kind(id) == BodyKind::Dynamic).all(|id| !world.is_awake(id))
}

/// Returns the number of steps until all bodies sleep.
fn steps_to_sleep(world: &mut World) -> usize {
    for step in 0..ENOUGH {
        if all_asleep(world) {
            return step;
        }
        world.step();
    }
    panic!("the bodies must fall asleep within {ENOUGH} steps");
}

/// A world with a crate asleep on a floor.
struct Nap {
    world: World,
    floor: BodyId,
    sleeper: BodyId,
}

fn nap() -> Nap {
    let mut world = World::new(WorldDef::default());
    let floor = floor(&mut world);
    let sleeper = world.add_body(&box_body(Vec3::splat(0.2), Vec3::Y * 0.2));
    steps_to_sleep(&mut world);
    Nap { world, floor, sleeper }
}

/// Returns a kinematic slab, 0.1 m thick.
fn slab(half: f32, at: Vec3) -> BodyDef {
    BodyDef { kind: BodyKind::Kinematic, ..box_body(Vec3::new(half, 0.05, half), at) }
}

fn linear(linear: Vec3) -> Velocity {
    Velocity { linear, ..Velocity::default() }
}
