//! Random worlds: trees, nets and loops of all kinds of joints, which are broken, changed and added while the world
//! runs. Numbers stay finite, energy rises only by work, and a restored world continues like the saved one.
//!
//! 100 worlds, or 10,000 with `SINEW_FULL` set, as `cargo xtask ci --full` does. To examine one:
//! `SINEW_WORLDS=17..18 cargo test --release -p sinew_physics --test it -- --ignored --nocapture survey` runs the seeds
//! of the range, shrinks failing worlds and prints them.
//!
//! Energy is checked in worlds without motors, moving kinematic bodies, soft zones and springs given by frequency: a
//! test cannot compute the energy that these store or add. It is not checked in steps in which the test changes the
//! world, nor while joints close afterwards.

mod energy;
mod generate;
mod joints;
mod plan;
mod run;
mod shrink;

use run::{Failure, Fault, Figures, check};
use sinew_math::{Random, trig};
use std::sync::atomic::{AtomicU64, Ordering};

const STEPS: u32 = 600;

/// Returns true with the given probability.
fn chance(random: &mut Random, probability: f32) -> bool {
    random.unit() < probability
}

/// Returns a power of ten with a random exponent between two bounds.
fn decades(random: &mut Random, lo: f32, hi: f32) -> f32 {
    trig::exp(random.range(lo, hi) * core::f32::consts::LN_10)
}

/// Seeds below 100 whose worlds fail, with the reason. Remove a seed from the list when its world passes.
const KNOWN: &[(&str, &[u64])] =
    &[("eight bodies in fifteen joints with springs and soft limits gain 1.5 % in one step", &[27])];

/// Largest allowed number of failing worlds in a thousand, beyond the first hundred. Last count: 279 of 9,900, none by
/// a panic or by a restored world that continued differently.
const KNOWN_PER_THOUSAND: usize = 28;

type Outcome = (u64, Result<Figures, Failure>);

/// Number of worlds between progress messages of a long run.
const PROGRESS: u64 = 500;

/// Runs the worlds of a range of seeds on all cores; returns the outcomes by seed.
fn outcomes(seeds: core::ops::Range<u64>) -> Vec<Outcome> {
    let next = AtomicU64::new(seeds.start);
    let failed = AtomicU64::new(0);
    let worker = || {
        let mut found = Vec::new();
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= seeds.end {
                return found;
            }
            let outcome = check(&generate::world(seed), STEPS);
            failed.fetch_add(u64::from(outcome.is_err()), Ordering::Relaxed);
            found.push((seed, outcome));
            if (seed + 1).is_multiple_of(PROGRESS) {
                let failed = failed.load(Ordering::Relaxed);
                eprintln!("random worlds: {} of {} done, {failed} failed", seed + 1, seeds.end);
            }
        }
    };
    let cores = std::thread::available_parallelism().map_or(1, core::num::NonZero::get);
    let mut found: Vec<Outcome> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(worker)).collect();
        workers
            .into_iter()
            .flat_map(|worker| worker.join().expect("a worker thread must not panic"))
            .collect()
    });
    found.sort_unstable_by_key(|&(seed, _)| seed);
    found
}

/// Returns the seeds in `SINEW_WORLDS`, if it is set.
pub fn asked_seeds() -> Option<core::ops::Range<u64>> {
    let range = std::env::var("SINEW_WORLDS").ok()?;
    let (lo, hi) = range.split_once("..").expect("SINEW_WORLDS is lo..hi");
    Some(lo.parse().expect("a seed")..hi.parse().expect("a seed"))
}

/// Checks the world of a seed.
fn random_world(seed: u64) {
    let plan = generate::world(seed);
    if let Err(failure) = check(&plan, STEPS) {
        let (least, failure) = shrink::shrunk(&plan, &failure, STEPS);
        panic!("world {seed}: {failure:?}\n{}\n{}", shrink::features(&least), shrink::as_code(&least));
    }
}

fn is_known(seed: u64) -> bool {
    KNOWN.iter().any(|(_, seeds)| seeds.contains(&seed))
}

#[test]
fn random_worlds_stay_finite_add_no_energy_and_restore() {
    for (seed, outcome) in outcomes(0..100) {
        match outcome {
            Ok(_) if is_known(seed) => println!("world {seed} passes: remove it from the list `KNOWN`"),
            Err(_) if !is_known(seed) => random_world(seed),
            _ => {}
        }
    }
}

#[test]
fn ten_thousand_random_worlds_hold() {
    if std::env::var_os("SINEW_FULL").is_none() {
        return println!("skipped: SINEW_FULL is not set");
    }
    let outcomes = outcomes(asked_seeds().unwrap_or(100..10_000));
    let failed: Vec<_> = outcomes.iter().filter_map(|(seed, o)| Some((seed, o.as_ref().err()?))).collect();
    let share = failed.len() * 1000 / outcomes.len();
    assert!(share <= KNOWN_PER_THOUSAND, "{share} of 1000 worlds fail: {failed:?}");
    let never = |failure: &Failure| matches!(failure.fault, Fault::Panic(_) | Fault::Restore);
    assert!(
        !failed.iter().any(|(_, failure)| never(failure)),
        "panic or a state that depends on threads: {failed:?}"
    );
}

/// Runs the worlds of the range in `SINEW_WORLDS`, prints failing ones after shrinking, and the distribution of gaps.
#[test]
#[ignore = "manual tool: prints, asserts nothing"]
fn survey() {
    let seeds = asked_seeds().unwrap_or(0..100);
    let count = seeds.end - seeds.start;
    let outcomes = outcomes(seeds);
    let mut gaps: Vec<f32> = outcomes.iter().filter_map(|(_, o)| o.as_ref().ok()).map(|f| f.gap).collect();
    gaps.sort_unstable_by(f32::total_cmp);
    let quantile = |share: f32| {
        gaps.get((share * (gaps.len().max(1) - 1) as f32) as usize).copied().unwrap_or(0.0) * 1e3
    };
    println!("{} of {count} worlds pass", gaps.len());
    println!(
        "largest gap of a world, mm: median {:.4}, p90 {:.4}, p99 {:.4}, max {:.4}",
        quantile(0.5),
        quantile(0.9),
        quantile(0.99),
        quantile(1.0)
    );
    for (seed, outcome) in &outcomes {
        match outcome {
            Ok(figures) if figures.gap > 5e-3 => println!("GAP seed {seed}: {figures:?}"),
            Ok(_) => {}
            Err(failure) => {
                println!("FAIL seed {seed}: {failure:?}: {}", shrink::features(&generate::world(*seed)));
            }
        }
    }
    if std::env::var_os("SINEW_SHRINK").is_none() {
        return;
    }
    for (seed, outcome) in &outcomes {
        let Err(failure) = outcome else { continue };
        let plan = generate::world(*seed);
        let (least, failure) = shrink::shrunk(&plan, failure, STEPS);
        println!(
            "SHRUNK seed {seed}: {failure:?}: {}\n{}",
            shrink::features(&least),
            shrink::as_code(&least)
        );
    }
}
