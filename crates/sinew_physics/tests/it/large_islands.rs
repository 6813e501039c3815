//! Islands that are large enough for several threads have the same bits as on one thread.

use sinew_math::{Random, Vec3};
use sinew_physics::stage::{Counter, NoProfiler, Profiler, Stage};
use sinew_physics::{
    BodyDef, BodyKind, Serial, Shape, ShapeDef, Sleeping, TaskRunner, Threads, World, WorldDef,
};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Returns a world with boxes, capsules and balls that fall on each other in a pit; some bounce, some resist rolling.
fn pit(side: usize, layers: usize) -> World {
    let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
    let half = 0.55 * side as f32;
    let mut wall = |position: Vec3, half_extents: Vec3| {
        world.add_body(&BodyDef {
            kind: BodyKind::Static,
            position,
            shapes: vec![ShapeDef::new(Shape::Box { half_extents })],
            ..BodyDef::default()
        });
    };
    wall(Vec3::new(0.0, -1.0, 0.0), Vec3::new(half + 2.0, 1.0, half + 2.0));
    for sign in [-1.0, 1.0] {
        wall(Vec3::new(sign * (half + 1.0), 5.0, 0.0), Vec3::new(1.0, 5.0, half + 2.0));
        wall(Vec3::new(0.0, 5.0, sign * (half + 1.0)), Vec3::new(half + 2.0, 5.0, 1.0));
    }
    let mut random = Random::new(7);
    for i in 0..side * side * layers {
        let place = [i % side, i / (side * side), i / side % side].map(|at| at as f32);
        let shape = match i % 11 {
            0 => Shape::Sphere { radius: 0.45 },
            1 => Shape::Capsule { half_height: 0.2, radius: 0.25 },
            _ => Shape::Box { half_extents: Vec3::new(0.48, 0.45, 0.48) },
        };
        let mut shape = ShapeDef::new(shape);
        shape.material.restitution = if i.is_multiple_of(17) { 0.5 } else { 0.0 };
        shape.material.rolling = if i.is_multiple_of(5) { 0.02 } else { 0.0 };
        world.add_body(&BodyDef {
            position: Vec3::new(place[0] * 1.05 - half + 0.5, 0.5 + place[1], place[2] * 1.05 - half + 0.5)
                + random.in_cube() * 0.02,
            angular_velocity: random.in_cube() * 2.0,
            shapes: vec![shape],
            ..BodyDef::default()
        });
    }
    world
}

/// Profiler that stores the largest number of manifolds of one island.
#[derive(Default)]
struct Most(AtomicUsize);

impl Profiler for Most {
    fn begin(&self, _: Stage) {}
    fn end(&self, _: Stage) {}
    fn is_counting(&self) -> bool {
        true
    }
    fn count(&self, counter: Counter, by: u64) {
        if counter == Counter::Manifolds {
            self.0.fetch_max(by as usize, Ordering::Relaxed);
        }
    }
}

/// Runner that makes fewer or more calls than requested.
struct Careless(usize);

impl TaskRunner for Careless {
    fn run(&self, _: usize, task: &(dyn Fn() + Sync)) {
        (0..self.0).for_each(|_| task());
    }
}

/// Returns the hash after each step.
fn hashes(runner: &dyn TaskRunner, steps: usize) -> Vec<u64> {
    let mut world = pit(15, 6);
    let step = |_| {
        world.step_with(runner, &NoProfiler);
        world.hash()
    };
    (0..steps).map(step).collect()
}

#[test]
fn several_threads_give_the_bits_of_one() {
    let steps = 40;
    let alone = hashes(&Serial, steps);
    for runner in
        [&Threads::new(2) as &dyn TaskRunner, &Threads::new(3), &Threads::new(5), &Careless(0), &Careless(99)]
    {
        assert_eq!(hashes(runner, steps), alone);
    }
}

#[test]
fn the_heap_of_these_tests_is_one_large_island() {
    let (mut world, most) = (pit(15, 6), Most::default());
    for _ in 0..40 {
        world.step_with(&Serial, &most);
    }
    let most = most.0.load(Ordering::Relaxed);
    // Colours of this heap have more than 36 blocks of eight contacts, so they are divided.
    assert!(most > 2_500, "{most} contacts");
}
