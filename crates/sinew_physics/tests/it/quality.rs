//! Effects of the step quality: on substeps, sweeps and errors, but not on the stiffness of joints and contacts.

use core::sync::atomic::{AtomicU64, Ordering};
use sinew_math::{Reader, Transform, Vec3, Writer};
use sinew_physics::stage::{Counter, Profiler, Stage};
use sinew_physics::{
    BodyDef, BodyId, JointDef, JointKind, Quality, Serial, Shape, Sleeping, World, WorldDef,
};

const QUALITIES: [Quality; 3] = [Quality::Fast, Quality::Balanced, Quality::Exact];

fn world(quality: Quality) -> World {
    World::new(WorldDef { quality, sleeping: Sleeping::Off, ..WorldDef::default() })
}

/// Profiler that sums the substeps of all bodies.
#[derive(Default)]
struct Substeps(AtomicU64);

impl Profiler for Substeps {
    fn begin(&self, _: Stage) {}
    fn end(&self, _: Stage) {}
    fn is_counting(&self) -> bool {
        true
    }
    fn count(&self, counter: Counter, by: u64) {
        if counter == Counter::BodySubsteps {
            self.0.fetch_add(by, Ordering::Relaxed);
        }
    }
}

fn substeps(world: &mut World) -> u64 {
    let counter = Substeps::default();
    world.step_with(&Serial, &counter);
    counter.0.into_inner()
}

/// Adds a rod of 1 m that hangs on a fixed point at `hook` and starts horizontally.
fn rod(world: &mut World, hook: Vec3, quality: Option<Quality>) -> BodyId {
    let fixed = world.add_body(&BodyDef::fixed(Shape::Sphere { radius: 0.01 }).at(hook));
    let at = hook + 0.5 * Vec3::X;
    let shape = Shape::Box { half_extents: Vec3::new(0.5, 0.02, 0.02) };
    let rod = world.add_body(&BodyDef { quality, ..BodyDef::dynamic(shape).at(at) });
    let [hook, at] = [hook, at].map(Transform::from_translation);
    let kind = JointKind::Ball { limit: None };
    world.add_joint(&JointDef::new(fixed, rod, hook, at, hook, kind));
    rod
}

#[test]
fn substeps_follow_the_quality() {
    let taken = QUALITIES.map(|quality| {
        let mut world = world(quality);
        rod(&mut world, Vec3::Y, None);
        substeps(&mut world)
    });
    assert_eq!(taken, [2, 4, 8]);
}

#[test]
fn a_body_has_its_own_quality_and_an_island_the_highest() {
    let mut world = world(Quality::Balanced);
    let fast = rod(&mut world, Vec3::Y, Some(Quality::Fast));
    let exact = rod(&mut world, 3.0 * Vec3::Y, Some(Quality::Exact));
    assert_eq!(substeps(&mut world), 2 + 8);
    let [a, b] = [fast, exact].map(|body| world.transform(body));
    let middle = Transform::from_translation(0.5 * (a.translation + b.translation));
    world.add_joint(&JointDef::new(fast, exact, a, b, middle, JointKind::Ball { limit: None }));
    assert_eq!(substeps(&mut world), 2 * 8);
    world.set_quality(exact, None);
    assert_eq!(world.quality(exact), None);
    assert_eq!(substeps(&mut world), 2 * 4);
    world.set_world_quality(Quality::Exact);
    assert_eq!(substeps(&mut world), 2 * 8);
}

#[test]
fn a_lone_body_in_flight_has_the_substeps_of_its_quality() {
    let taken = QUALITIES.map(|quality| {
        let mut world = world(quality);
        world.add_body(&BodyDef::dynamic(Shape::Sphere { radius: 0.1 }));
        substeps(&mut world)
    });
    assert_eq!(taken, [4, 4, 8]); // Flight is cheap, so `Fast` uses no fewer substeps.
}

/// Returns the largest energy error of a swinging rod within ten seconds, as a share of its energy.
fn drift(quality: Quality) -> f64 {
    let mut world = world(quality);
    rod(&mut world, Vec3::ZERO, None);
    let start = world.energy().total();
    let swing = 0.5 * 9.81 * f64::from(8.0_f32 * 0.5 * 0.02 * 0.02 * 1000.0);
    let changes = (0..600).map(|_| {
        world.step();
        f64::from((world.energy().total() - start).abs()) / swing
    });
    changes.fold(0.0, f64::max)
}

#[test]
fn more_quality_keeps_more_of_the_energy() {
    let [fast, balanced, exact] = QUALITIES.map(drift);
    assert!(
        exact < 0.6 * balanced && balanced < 0.6 * fast,
        "energy errors: fast {fast}, balanced {balanced}, exact {exact}"
    );
    assert!(fast < 0.05, "relative energy error {fast} with fast quality");
}

#[test]
fn a_tower_stands_in_every_quality() {
    for quality in QUALITIES {
        let mut world = world(quality);
        world.add_body(&BodyDef::fixed(Shape::HalfSpace));
        let shape = Shape::Box { half_extents: Vec3::splat(0.25) };
        let boxes: Vec<_> = (0..10)
            .map(|i| {
                let at = Vec3::Y * (0.25 + 0.5 * i as f32);
                world.add_body(&BodyDef::dynamic(shape.clone()).at(at))
            })
            .collect();
        (0..300).for_each(|_| world.step());
        let top = world.transform(boxes[9]).translation;
        assert!(
            (top.y - 4.75).abs() < 2e-3 && top.x.abs() + top.z.abs() < 2e-3,
            "{quality:?}: the top of the tower is at {top}"
        );
    }
}

#[test]
fn quality_is_part_of_a_snapshot() {
    let mut saved = world(Quality::Fast);
    let exact = rod(&mut saved, Vec3::Y, Some(Quality::Exact));
    rod(&mut saved, 3.0 * Vec3::Y, None);
    let mut bytes = Writer::new();
    saved.save(&mut bytes);
    let mut other = world(Quality::Balanced);
    other.load(&mut Reader::new(bytes.as_bytes())).expect("the snapshot must load");
    assert_eq!(other.quality(exact), Some(Quality::Exact));
    assert_eq!(substeps(&mut other), 8 + 2);
    saved.step();
    assert_eq!(other.hash(), saved.hash());
}
