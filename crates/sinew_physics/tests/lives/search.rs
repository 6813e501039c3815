//! Runs many lives in parallel, and reports those that fail.

use crate::life::Life;
use crate::run::{self, Outcome, run};
use crate::{interface, shrink};
use core::ops::Range;
use std::collections::BTreeMap;
use std::io::Write;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Duration of a full run.
const LONG: Duration = Duration::from_secs(600);
/// Largest number of additional lives that do each deed, run for calls that the requested lives do not make.
const RARE: u64 = 8;
/// Running time above which a life is reported as slow.
const SLOW: Duration = Duration::from_secs(2);
/// Number of lives between progress messages.
const PROGRESS: u64 = 500;

/// Lives that a test run executes.
struct Asked {
    /// Seeds, or indices into a list.
    seeds: Range<u64>,
    listed: &'static [u64],
    time: Duration,
}

impl Asked {
    /// Returns the requested lives: a range of seeds (`SINEW_LIVES=17..1000`), the seeds from one on for some time
    /// (`SINEW_LIVES=17.. SINEW_MINUTES=20`), all seeds for ten minutes (`SINEW_FULL`), or else the listed ones.
    fn of(some: &'static [u64]) -> Self {
        let minutes = std::env::var("SINEW_MINUTES").ok();
        let minutes = minutes.map(|minutes| minutes.parse::<f32>().expect("SINEW_MINUTES must be a number"));
        let time = minutes.map(|minutes| Duration::from_secs_f32(60.0 * minutes));
        if let Ok(range) = std::env::var("SINEW_LIVES") {
            let (lo, hi) = range.split_once("..").expect("SINEW_LIVES must be lo..hi or lo..");
            let hi =
                if hi.is_empty() { u64::MAX } else { hi.parse().expect("SINEW_LIVES must contain seeds") };
            let seeds = lo.parse().expect("SINEW_LIVES must contain seeds")..hi;
            return Self { seeds, listed: &[], time: time.unwrap_or(Duration::MAX) };
        }
        match (std::env::var_os("SINEW_FULL"), time) {
            (None, None) => Self { seeds: 0..some.len() as u64, listed: some, time: Duration::MAX },
            (_, time) => Self { seeds: 0..u64::MAX, listed: &[], time: time.unwrap_or(LONG) },
        }
    }

    /// Returns the seed with this index, if the index is in the range.
    fn seed(&self, number: u64) -> Option<u64> {
        let listed = self.listed.get(number as usize).copied();
        self.seeds.contains(&number).then(|| listed.unwrap_or(number))
    }
}

/// Shrinks a failing life and returns its failure and its program as text.
fn told(seed: u64, outcome: &Outcome) -> String {
    let failure = outcome.result.as_ref().expect_err("only failures are reported");
    let (least, failure) = shrink::shrunk(&Life::of(seed), failure);
    let lines = run(&least, None, true).program.unwrap_or_default();
    let acts = least.acts.len();
    let program = run::program(&least, &lines);
    format!("life {seed} ({acts} deeds left): {failure:?}\n{program}")
}

/// Metrics of many lives.
#[derive(Default)]
struct Sum {
    lives: u64,
    deeds: u64,
    calls: BTreeMap<&'static str, u64>,
    rise: f32,
    failed: Vec<(u64, String)>,
    /// First seed that was not run.
    next: u64,
}

/// Runs lives until their seeds or their time run out.
fn all(asked: &Asked, workers: usize) -> Sum {
    let (next, start) = (AtomicU64::new(asked.seeds.start), Instant::now());
    let worker = || {
        let mut sum = Sum::default();
        loop {
            if start.elapsed() > asked.time {
                return sum;
            }
            let Some(seed) = asked.seed(next.fetch_add(1, Ordering::Relaxed)) else { return sum };
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
                eprintln!("lives: at {}, {:.0} s", seed + 1, start.elapsed().as_secs_f32());
            }
        }
    };
    let mut total = Sum::default();
    let sums: Vec<Sum> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..workers).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().map(|worker| worker.join().expect("a worker thread must not panic")).collect()
    });
    for sum in sums {
        total.lives += sum.lives;
        total.deeds += sum.deeds;
        total.rise = sinew_math::max(total.rise, sum.rise);
        sum.calls.into_iter().for_each(|(name, count)| *total.calls.entry(name).or_insert(0) += count);
        total.failed.extend(sum.failed);
    }
    total.failed.sort();
    total.next = u64::min(next.load(Ordering::Relaxed), asked.seeds.end);
    total
}

/// Number of lives that run in parallel.
pub fn workers() -> usize {
    std::env::var("SINEW_WORKERS")
        .ok()
        .and_then(|count| count.parse().ok())
        .unwrap_or_else(|| std::thread::available_parallelism().map_or(1, core::num::NonZero::get))
}

/// Runs lives and reports failures, the first of them as a short program.
///
/// # Panics
/// If a life fails, or if at least as many lives as in `some` ran and lack a call.
pub fn search(some: &'static [u64]) {
    let asked = Asked::of(some);
    let mut sum = all(&asked, workers());
    let calls: u64 = sum.calls.values().sum();
    let Sum { lives, deeds, rise, failed, next, .. } = &sum;
    eprintln!(
        "{lives} lives, {deeds} deeds, {calls} calls, {} failed; largest rise of energy {rise} of the allowed; next seed {next}",
        failed.len()
    );
    log(&format!(
        "seeds {}..{next}, {lives} lives, {deeds} deeds, {calls} calls, failed: {failed:?}",
        asked.seeds.start
    ));
    if let Some((seed, _)) = sum.failed.first() {
        let outcome = run(&Life::of(*seed), None, false);
        panic!("{} of {lives} lives fail: {failed:?}\n{}", failed.len(), told(*seed, &outcome));
    }
    if sum.lives >= some.len() as u64 {
        // Few lives make rare calls.
        for seed in 0..RARE {
            if interface::has_all(&sum.calls) {
                break;
            }
            let outcome = run(&Life::of_each_deed(seed), None, false);
            assert_eq!(outcome.result, Ok(()), "the life {seed} with each deed must pass");
            for (name, count) in outcome.calls {
                *sum.calls.entry(name).or_insert(0) += count;
            }
        }
        interface::expect_all(&sum.calls);
    }
}

/// Adds a line to the file `SINEW_LOG`, if it is set.
fn log(line: &str) {
    if let Some(path) = std::env::var_os("SINEW_LOG") {
        let file = std::fs::OpenOptions::new().create(true).append(true).open(path);
        writeln!(file.expect("the log can be opened"), "{line}").expect("the log can be written");
    }
}

/// Shrinks the failures among the requested lives, and prints them.
pub fn shorten(some: &'static [u64]) {
    let asked = Asked::of(some);
    for seed in asked.seeds.clone().filter_map(|number| asked.seed(number)) {
        let outcome = run(&Life::of(seed), None, false);
        if outcome.result.is_err() {
            println!("{}", told(seed, &outcome));
        }
    }
}
