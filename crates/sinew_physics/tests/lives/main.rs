//! Random lives: worlds made and changed by sequences of all calls that there are, looked at from step to step.
//!
//! A seed draws a life (`life.rs`): a sequence of deeds (`deeds/`), each of which calls the world with numbers that are
//! round, equal, at their bounds, zero, huge or arbitrary (`numbers.rs`). Several worlds run the same life (`run.rs`): on one thread,
//! on two, loaded from a snapshot into a new world, and cloned. All of them must return the same answers and events, bit for bit.
//! Each must pass the checks of `watch.rs`: no panic, finite numbers, one end for every begin, touching shapes near each other, nothing
//! below the floor, no energy from nothing. A failing life is shrunk (`shrink.rs`) and printed as Rust (`code.rs`).
//!
//! 60 lives, or ten minutes of them when `SINEW_FULL` is set. `SINEW_LIVES=17..1000` runs the seeds of the range:
//! `SINEW_LIVES=0..1000 cargo test -p sinew_physics --test lives -- --nocapture lives_hold`.

#[macro_use]
mod actor;
mod code;
mod deeds;
mod deltas;
mod functions;
mod interface;
mod lies;
mod life;
mod numbers;
mod planted;
mod printed;
mod run;
mod shrink;
mod watch;

use life::Life;
use run::{Outcome, run};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Lives of a plain run of the tests.
const SOME: u64 = 60;
/// Time of a full one.
const LONG: Duration = Duration::from_secs(600);
/// Time after which a life is told to be slow.
const SLOW: Duration = Duration::from_secs(2);
/// Lives after which those who wait are told how far it is.
const PROGRESS: u64 = 500;

/// Seeds that `SINEW_LIVES` asks for, if it is set.
fn asked_seeds() -> Option<core::ops::Range<u64>> {
    let range = std::env::var("SINEW_LIVES").ok()?;
    let (lo, hi) = range.split_once("..").expect("SINEW_LIVES is lo..hi");
    Some(lo.parse().expect("a seed")..hi.parse().expect("a seed"))
}

/// A failure made short, as text.
fn told(seed: u64, outcome: &Outcome) -> String {
    let failure = outcome.result.as_ref().expect_err("a failure");
    let (least, failure) = shrink::shrunk(&Life::of(seed), failure);
    let lines = run(&least, None, true).program.unwrap_or_default();
    let acts = least.acts.len();
    let program = run::program(&least, &lines);
    format!("life {seed} ({acts} deeds left): {failure:?}\n{program}")
}

/// Figures of many lives.
#[derive(Default)]
struct Sum {
    lives: u64,
    deeds: u64,
    calls: BTreeMap<&'static str, u64>,
    rise: f32,
    failed: Vec<(u64, String)>,
}

/// Runs lives until their seeds or their time are over.
fn all(seeds: core::ops::Range<u64>, time: Duration, workers: usize) -> Sum {
    let (next, start) = (AtomicU64::new(seeds.start), Instant::now());
    let worker = || {
        let mut sum = Sum::default();
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= seeds.end || start.elapsed() > time {
                return sum;
            }
            let began = Instant::now();
            let outcome = run(&Life::of(seed), None, false);
            if began.elapsed() > SLOW {
                eprintln!("life {seed} takes {:.1} s", began.elapsed().as_secs_f32());
            }
            sum.lives += 1;
            sum.deeds += outcome.deeds;
            sum.rise = sinew_math::max(sum.rise, outcome.rise);
            for (name, count) in &outcome.calls {
                *sum.calls.entry(name).or_insert(0) += count;
            }
            if let Err(failure) = &outcome.result {
                eprintln!("life {seed} fails: {failure:?}");
                sum.failed.push((seed, format!("{failure:?}")));
            }
            if (seed + 1).is_multiple_of(PROGRESS) {
                eprintln!("lives: at {} of {}, {:.0} s", seed + 1, seeds.end, start.elapsed().as_secs_f32());
            }
        }
    };
    let mut total = Sum::default();
    let sums: Vec<Sum> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..workers).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().map(|worker| worker.join().expect("a worker ends")).collect()
    });
    for sum in sums {
        total.lives += sum.lives;
        total.deeds += sum.deeds;
        total.rise = sinew_math::max(total.rise, sum.rise);
        sum.calls.into_iter().for_each(|(name, count)| *total.calls.entry(name).or_insert(0) += count);
        total.failed.extend(sum.failed);
    }
    total.failed.sort();
    total
}

fn workers() -> usize {
    std::env::var("SINEW_WORKERS")
        .ok()
        .and_then(|count| count.parse().ok())
        .unwrap_or_else(|| std::thread::available_parallelism().map_or(1, core::num::NonZero::get))
}

#[test]
fn lives_hold_and_make_every_call() {
    let full = std::env::var_os("SINEW_FULL").is_some();
    let (seeds, time) = match (asked_seeds(), full) {
        (Some(seeds), _) => (seeds, Duration::MAX),
        (None, true) => (0..u64::MAX, LONG),
        (None, false) => (0..SOME, Duration::MAX),
    };
    let (enough, seeds_end) = (seeds.end - seeds.start >= SOME, seeds.start.saturating_add(SOME));
    let mut sum = all(seeds, time, workers());
    let calls: u64 = sum.calls.values().sum();
    let Sum { lives, deeds, rise, failed, .. } = &sum;
    eprintln!(
        "{lives} lives, {deeds} deeds, {calls} calls, {} fail; energy rose by {rise} of what may be",
        failed.len()
    );
    if let Some((seed, _)) = sum.failed.first() {
        let outcome = run(&Life::of(*seed), None, false);
        panic!(
            "{} of {} lives fail: {:?}\n{}",
            sum.failed.len(),
            sum.lives,
            sum.failed,
            told(*seed, &outcome)
        );
    }
    if enough {
        // Rare calls are in few lives: some more are run for them.
        let mut seed = seeds_end;
        while !interface::has_all(&sum.calls) && seed < seeds_end + SOME {
            for (name, count) in run(&Life::of(seed), None, false).calls {
                *sum.calls.entry(name).or_insert(0) += count;
            }
            seed += 1;
        }
        interface::expect_all(&sum.calls);
    }
}

/// Makes the failures among the lives of `SINEW_LIVES` short and prints them.
#[test]
#[ignore = "for people: prints, asserts nothing"]
fn shorten() {
    for seed in asked_seeds().unwrap_or(0..SOME) {
        let outcome = run(&Life::of(seed), None, false);
        if outcome.result.is_err() {
            println!("{}", told(seed, &outcome));
        }
    }
}
