//! A new world that loads a snapshot continues like the original, also with another number of threads, for any contents
//! of the world and any calls.
//!
//! Worlds of 10 to 300 bodies (500 in a long run) rest, sleep, and are pushed, joined, sensed and changed. Each is
//! saved at random steps and continues next to the worlds that loaded its snapshots, which get the same calls.
//! Snapshots and events are equal after each step.
//!
//! A few worlds, or 300 with `SINEW_FULL` set.
//! `SINEW_WORLDS=17..18 cargo test --release -p sinew_physics --test it -- --nocapture strangers` runs the seeds of the
//! range and prints progress. `cargo xtask lives --of strangers` continues from seed to seed, 600 steps each.

mod deeds;
mod populate;

use crate::random_worlds::asked_seeds;
use sinew_math::{Random, Reader, Writer};
use sinew_physics::stage::NoProfiler;
use sinew_physics::{Events, Serial, Threads, World, WorldDef};
use std::io::Write;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Number of steps of each world in a test run and in a long run.
const STEPS: usize = 300;
const MORE_STEPS: usize = 600;
/// Largest number of bodies of each world in a test run and in a long run.
const MOST: usize = 300;
const MORE: usize = 500;
/// Number of snapshots that are taken of each world.
const MOMENTS: usize = 5;

/// A world that continues from a snapshot of another world.
struct Stranger {
    world: World,
    born: usize,
    threads: Threads,
}

impl Stranger {
    /// Loads a snapshot into a new world.
    fn of(original: &World, born: usize, threads: usize) -> Self {
        let mut world = World::new(WorldDef::default());
        deeds::register(&mut world);
        let (mut shapes, mut state) = (Writer::new(), Writer::new());
        original.save_shapes(&mut shapes);
        original.save(&mut state);
        world.load_shapes(&mut Reader::new(shapes.as_bytes())).expect("the saved shape library must load");
        world.load(&mut Reader::new(state.as_bytes())).expect("the snapshot must load");
        Self { world, born, threads: Threads::new(threads) }
    }
}

/// Returns the random numbers for the calls before a step.
fn deeds_of(seed: u64, step: usize) -> Random {
    Random::new(seed.wrapping_mul(1_000_003).wrapping_add(step as u64))
}

fn step_with_calls(world: &mut World, seed: u64, step: usize, threads: Option<&Threads>) -> Events {
    deeds::act(world, &mut deeds_of(seed, step));
    match threads {
        Some(threads) => world.step_with(threads, &NoProfiler),
        None => world.step_with(&Serial, &NoProfiler),
    }
    world.events().clone()
}

/// Runs the world of a seed next to the worlds that load its snapshots.
fn compare_with_loaded_worlds(seed: u64, steps: usize, most: usize) {
    let mut random = Random::new(seed);
    let mut world = populate::world(&mut random, most);
    let moments: Vec<usize> = (0..MOMENTS).map(|_| random.index(steps - 20)).collect();
    let mut strangers: Vec<Stranger> = Vec::new();
    for step in 0..steps {
        for _ in moments.iter().filter(|&&moment| moment == step) {
            strangers.push(Stranger::of(&world, step, 1 + strangers.len() % 2));
        }
        let events = step_with_calls(&mut world, seed, step, None);
        let hash = world.hash();
        for Stranger { world: other, born, threads } in &mut strangers {
            let others = step_with_calls(other, seed, step, Some(threads));
            let who = format!("world {seed}, saved before step {born}, {} threads", threads.count());
            assert_eq!(others, events, "{who}: the events differ in step {step}");
            assert_eq!(other.hash(), hash, "{who}: the state differs after step {step}");
        }
    }
}

fn seeds() -> core::ops::Range<u64> {
    let count = if std::env::var_os("SINEW_FULL").is_some() { 300 } else { 2 };
    asked_seeds().unwrap_or(0..count)
}

#[test]
fn unrelated_worlds_have_the_same_future() {
    if let Ok(minutes) = std::env::var("SINEW_MINUTES") {
        return for_minutes(minutes.parse().expect("SINEW_MINUTES is a number"));
    }
    let told = asked_seeds().is_some();
    for seed in seeds() {
        compare_with_loaded_worlds(seed, STEPS, MOST);
        if told && (seed + 1).is_multiple_of(20) {
            eprintln!("strangers: {} worlds passed", seed + 1);
        }
    }
}

/// Runs worlds for some time on all cores, starting at the first seed of `SINEW_LIVES`, and adds a line to the file
/// `SINEW_LOG`.
fn for_minutes(minutes: f32) {
    let first = std::env::var("SINEW_LIVES").ok().and_then(|seeds| seeds.split_once("..")?.0.parse().ok());
    let first: u64 = first.expect("SINEW_LIVES begins with a seed");
    let (next, start) = (AtomicU64::new(first), Instant::now());
    let failed = Mutex::new(Vec::new());
    let worker = || {
        while start.elapsed().as_secs_f32() < 60.0 * minutes {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if std::panic::catch_unwind(|| compare_with_loaded_worlds(seed, MORE_STEPS, MORE)).is_err() {
                failed.lock().expect("no thread panics while it holds the lock").push(seed);
            }
        }
    };
    let workers = std::thread::available_parallelism().map_or(1, core::num::NonZero::get);
    std::thread::scope(|scope| (0..workers).for_each(|_| _ = scope.spawn(worker)));
    let (end, failed) =
        (next.into_inner(), failed.into_inner().expect("no thread panics while it holds the lock"));
    if let Some(path) = std::env::var_os("SINEW_LOG") {
        let file = std::fs::OpenOptions::new().create(true).append(true).open(path);
        let mut file = file.expect("the log can be opened");
        writeln!(file, "seeds {first}..{end}, {MORE_STEPS} steps, failed: {failed:?}")
            .expect("the log can be written");
    }
    assert!(failed.is_empty(), "worlds {failed:?} differ from their copies");
}
