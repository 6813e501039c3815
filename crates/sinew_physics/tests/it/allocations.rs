//! A warm step allocates nothing (specification §5) if it needs no more memory than an earlier step.
//!
//! The crate `allocation_counter` has a global allocator that counts per thread, so tests on other threads do not
//! count.

use crate::build::{ball, box_body, capsule_body, floor, joint, sphere_body};
use crate::humanoid::figure;
use crate::objects::inhabited;
use sinew_math::trig::{cos, sin};
use sinew_math::{Transform, Vec3};
use sinew_physics::particles::{AttachmentDef, AttachmentTarget, RopeDef};
use sinew_physics::ray::Ray;
use sinew_physics::*;

/// Steps after which the boxes are moved back to their start.
const CYCLE: usize = 150;

/// Boxes that fall in every cycle, and additional boxes that fall only in the first one: they reserve memory for later
/// cycles, because the heap differs from fall to fall.
const BOXES: usize = 40;
const MORE_BOXES: usize = 20;

/// Number of measured falls.
const CYCLES: usize = 6;

/// Steps until bodies on joints and springs are almost at rest.
const SETTLE: usize = 400;

/// Returns a world with loose boxes, a ragdoll, a chain, a ring of joints and a rope with a weight; and the boxes with
/// their initial poses.
fn crowded() -> (World, Vec<(BodyId, Transform)>) {
    let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
    floor(&mut world);
    let mut world = figure(world, Transform::from_translation(Vec3::new(0.0, 0.6, 0.0)), Vec3::ZERO).world;
    let boxes = pile(&mut world, (BOXES + MORE_BOXES) as u32);
    gate(&mut world);
    chain(&mut world, 10);
    ring(&mut world, 6);
    rope(&mut world);
    assert_eq!(world.joint_ids().count(), 14 + 10 + 6);
    (world, boxes)
}

/// Adds boxes in layers of four, each layer slightly farther to the side than the one below, so that they tumble.
fn pile(world: &mut World, count: u32) -> Vec<(BodyId, Transform)> {
    let mut place = |i: u32| {
        let (layer, corner) = ((i / 4) as f32, i % 4);
        let side = |bit| if corner & bit == 0 { -0.14 } else { 0.14 };
        let at = Vec3::new(3.0 + side(1) + 0.02 * layer, 0.2 + 0.3 * layer, side(2));
        let id = world.add_body(&box_body(Vec3::splat(0.12), at));
        (id, world.transform(id))
    };
    (0..count).map(&mut place).collect()
}

/// Adds a sensor that the pile falls through.
fn gate(world: &mut World) {
    let mut gate = box_body(Vec3::new(0.5, 0.5, 0.5), Vec3::new(3.0, 0.5, 0.0));
    gate.kind = BodyKind::Static;
    gate.shapes[0].sensing = Sensing::Sensor;
    world.add_body(&gate);
}

/// Adds a chain of capsules that hangs from the world and starts stretched to the side.
fn chain(world: &mut World, links: u32) {
    let mut last = world.add_body(&BodyDef {
        kind: BodyKind::Static,
        position: Vec3::new(-3.0, 2.0, 0.0),
        ..BodyDef::default()
    });
    for i in 0..links {
        let at = Vec3::new(-3.0, 2.0, 0.15 + 0.3 * i as f32);
        let link = world.add_body(&capsule_body(0.1, 0.03, at));
        world.add_joint(&ball(world, last, link, at - Vec3::Z * 0.15));
        last = link;
    }
}

/// Adds a ring of spheres that falls flat.
fn ring(world: &mut World, count: u32) {
    let place = |i: u32| {
        let angle = i as f32 * core::f32::consts::TAU / count as f32;
        Vec3::new(0.4 * cos(angle), 1.0 + 0.4 * sin(angle), -2.0)
    };
    let spheres: Vec<BodyId> = (0..count).map(|i| world.add_body(&sphere_body(0.1, place(i)))).collect();
    for i in 0..count {
        let next = (i + 1) % count;
        let middle = (place(i) + place(next)) * 0.5;
        world.add_joint(&ball(world, spheres[i as usize], spheres[next as usize], middle));
    }
}

/// Adds a rope from the world to a weight, which swings out of the boxes' reach: a different number of boxes near it in
/// each cycle would need more memory.
fn rope(world: &mut World) {
    let (from, to) = (Vec3::new(0.0, 2.5, 20.0), Vec3::new(0.0, 1.5, 21.0));
    let weight = world.add_body(&sphere_body(0.15, to));
    let mut rope = RopeDef { from, to, links: 16, mass: 0.2, stiffness: 1e4, radius: 0.01 }.build().group;
    rope.attachments = vec![
        AttachmentDef { particle: 0, target: AttachmentTarget::World(from) },
        AttachmentDef { particle: 16, target: AttachmentTarget::Body { body: weight, point: Vec3::ZERO } },
    ];
    world.add_particles(&rope);
}

/// Joins all moving bodies into one island by joints whose axes are all free, and returns these joints.
fn tie(world: &mut World) -> Vec<JointId> {
    let free = AxisMotion::Free;
    let six = SixDof { linear: [free; 3], twist: free, swing_y: free, swing_z: free };
    let moving: Vec<BodyId> = world.body_ids().filter(|&id| world.kind(id) == BodyKind::Dynamic).collect();
    let tie = |pair: &[BodyId]| {
        let def = joint(world, pair[0], pair[1], Transform::IDENTITY, JointKind::SixDof(six));
        world.add_joint(&JointDef { collision: JointCollision::Enabled, ..def })
    };
    moving.windows(2).map(tie).collect()
}

/// Counts over the steps of one cycle.
#[derive(Debug, Default)]
struct Seen {
    allocations: u64,
    touches_begun: usize,
    touches_ended: usize,
    sensed: usize,
    hits: usize,
}

fn run(world: &mut World, steps: usize, seen: &mut Seen) {
    for _ in 0..steps {
        seen.allocations += allocation_counter::measure(|| world.step()).count_total;
        seen.touches_begun += world.events().begin.len();
        seen.touches_ended += world.events().end.len();
        seen.sensed += world.events().sensor_begin.len();
        seen.hits += world.events().hits.len();
    }
}

/// Separates the boxes for a step, so that their contacts are dropped, and lets them fall as before: each cycle needs
/// as much memory as the first.
fn cycle(world: &mut World, boxes: &[(BodyId, Transform)]) -> Seen {
    let mut seen = Seen::default();
    for apart in [true, false] {
        for (i, &(id, mut pose)) in boxes.iter().enumerate() {
            if apart {
                pose.translation += Vec3::new(0.0, 50.0, i as f32);
            }
            world.set_transform(id, pose);
            world.set_velocity(id, Velocity::default());
        }
        run(world, if apart { 1 } else { CYCLE }, &mut seen);
    }
    seen
}

#[test]
fn a_warm_step_allocates_nothing() {
    let (mut world, boxes) = crowded();
    let mut cold = Seen::default();
    run(&mut world, SETTLE, &mut cold);
    assert!(cold.allocations > 0, "the first steps must allocate, so that the counter is known to work");
    let ties = tie(&mut world);
    cycle(&mut world, &boxes);
    for id in ties {
        world.remove_joint(id);
    }
    let (boxes, more) = boxes.split_at(BOXES);
    for &(id, _) in more {
        world.remove_body(id);
    }
    // Contacts of an island without joints are in blocks; the tied world has none.
    cycle(&mut world, boxes);
    for _ in 0..CYCLES {
        let warm = cycle(&mut world, boxes);
        assert!(
            warm.touches_begun >= BOXES && warm.touches_ended >= BOXES,
            "contacts must begin and end: {warm:?}"
        );
        assert!(warm.sensed > 10 && warm.hits > 20, "sensor overlaps and hits must be reported: {warm:?}");
        assert_eq!(warm.allocations, 0, "a warm cycle must allocate nothing: {warm:?}");
    }
}

#[test]
fn a_warm_step_with_objects_allocates_nothing() {
    let mut world = inhabited();
    let mut seen = Seen::default();
    // Each island has its own workspace here, by its index; after some steps each workspace has grown to its largest
    // size.
    run(&mut world, SETTLE + CYCLE, &mut seen);
    let before = seen.allocations;
    run(&mut world, CYCLE, &mut seen);
    assert_eq!(seen.allocations, before, "{seen:?}");
}

#[test]
fn allocation_counter_counts_one_allocation() {
    let mut list: Vec<u32> = Vec::new();
    assert_eq!(allocation_counter::measure(|| list.push(1)).count_total, 1);
    list.clear();
    assert_eq!(
        allocation_counter::measure(|| list.push(1)).count_total,
        0,
        "a list with spare capacity must not allocate"
    );
}

#[test]
fn falling_asleep_and_waking_allocate_nothing() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let boxes = pile(&mut world, 20);
    let mut last = Seen::default();
    for cycle in 0..8 {
        last = Seen::default();
        for &(id, pose) in &boxes {
            world.set_transform(id, pose);
            world.set_velocity(id, Velocity::default());
        }
        run(&mut world, 600, &mut last);
        assert!(boxes.iter().all(|&(id, _)| !world.is_awake(id)), "all boxes must sleep in cycle {cycle}");
        for &(id, _) in &boxes {
            world.apply_impulse_at_center(id, Vec3::Y);
            run(&mut world, 5, &mut last);
        }
    }
    assert_eq!(last.allocations, 0, "the last cycle must allocate nothing: {last:?}");
}

#[test]
fn a_batch_of_rays_allocates_nothing() {
    let (world, _) = crowded();
    let rays: Vec<Ray> = (0..100)
        .map(|k| Ray { origin: Vec3::new(0.03 * k as f32, 4.0, 0.0), direction: Vec3::Y * -5.0 })
        .collect();
    let mut hits = vec![None; rays.len()];
    let seen = allocation_counter::measure(|| world.query().first_each(&rays, &mut hits));
    assert_eq!(seen.count_total, 0);
    assert!(hits.iter().all(Option::is_some), "every ray must hit the floor");
}
