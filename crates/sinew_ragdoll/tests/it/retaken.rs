//! Islands that step with fewer, longer substeps and repeat a step with the world's substeps if it fails.

use crate::actor::{floor, walker};
use core::sync::atomic::{AtomicUsize, Ordering};
use sinew_math::{Random, ReadError, Reader, Transform, Vec3, Writer, min};
use sinew_physics::stage::{Counter, Profiler, Stage};
use sinew_physics::{PhysicsObject, Serial, Velocity, World, WorldDef};
use sinew_ragdoll::quality::random_pose;
use sinew_ragdoll::{BodySettings, BodyState, Ragdoll, RagdollDef};

/// Numbers of preparations of islands, and of islands.
#[derive(Default)]
struct Prepared {
    times: AtomicUsize,
    islands: AtomicUsize,
}

impl Profiler for Prepared {
    fn begin(&self, stage: Stage) {
        self.times.fetch_add(usize::from(stage == Stage::Prepare), Ordering::Relaxed);
    }
    fn end(&self, _: Stage) {}
    fn is_counting(&self) -> bool {
        true
    }
    fn count(&self, counter: Counter, _: u64) {
        self.islands.fetch_add(usize::from(counter == Counter::Bodies), Ordering::Relaxed);
    }
}

/// Steps the world and returns true if an island was solved twice.
fn step_is_retaken(world: &mut World) -> bool {
    let prepared = Prepared::default();
    world.step_with(&Serial, &prepared);
    prepared.times.into_inner() > prepared.islands.into_inner()
}

/// An object without effect: islands that touch one use the world's substeps.
struct Idle;

impl PhysicsObject for Idle {
    fn kind(&self) -> &'static str {
        "idle"
    }
    fn save(&self, _: &mut Writer) {}
    fn load(&mut self, _: &mut Reader<'_>) -> Result<(), ReadError> {
        Ok(())
    }
}

/// Spawns a ragdoll thrown down at 9 m/s from just above the floor, with random pose and spin.
fn thrown(world: &mut World, def: &RagdollDef, seed: u64) -> Ragdoll {
    let mut random = Random::new(seed);
    let (turn, spin) = (random.rotation(), random.in_cube() * 10.0);
    let pose = random_pose(def, &mut random);
    let turned = Transform::new(Vec3::ZERO, turn);
    let bottoms = pose.iter().zip(&def.bodies).map(|(&at, body)| body.shape.aabb(&(turned * at)).min.y);
    let world_from_character = Transform::new(Vec3::Y * (0.1 - bottoms.fold(f32::INFINITY, min)), turn);
    let pivot = world_from_character.point(pose[0].translation);
    let state = |(&at, body): (&Transform, &sinew_ragdoll::RagdollBodyDef)| {
        let world_from_body = world_from_character * at;
        let arm = world_from_body.point(body.mass.center) - pivot;
        let velocity = Velocity { linear: Vec3::Y * -9.0 + spin.cross(arm), angular: spin };
        BodyState { world_from_body, velocity }
    };
    let states: Vec<BodyState> = pose.iter().zip(&def.bodies).map(state).collect();
    Ragdoll::spawn(world, def, &states, &BodySettings::default())
}

#[test]
fn repeated_step_equals_a_step_with_short_substeps() {
    let def = walker().ragdoll;
    let mut retaken = 0;
    for seed in 0..500 {
        let mut world = World::new(WorldDef::default());
        world.add_body(&floor());
        let ragdoll = thrown(&mut world, &def, seed);
        for step in 0..15 {
            let mut before = Writer::default();
            world.save(&mut before);
            if !step_is_retaken(&mut world) {
                continue;
            }
            retaken += 1;
            let mut short = World::new(WorldDef::default());
            short.load(&mut Reader::new(before.as_bytes())).expect("it was saved just now");
            short.add_object(Box::new(Idle));
            short.step();
            for &body in &ragdoll.bodies {
                assert_eq!(
                    world.transform(body),
                    short.transform(body),
                    "other transform: fall {seed}, step {step}"
                );
                assert_eq!(
                    world.velocity(body),
                    short.velocity(body),
                    "other velocity: fall {seed}, step {step}"
                );
            }
        }
    }
    assert!(retaken >= 3, "only {retaken} steps were repeated");
}
