//! Speed of the eight-lane kernels, beside the limit of the machine's arithmetic measured in the same minute.
//!
//! `cargo xtask bench --kernels` runs this and prints a table of the output: lines of `level kernel
//! items_per_second limit_items_per_second`.
#![forbid(unsafe_code)]

mod counted;
mod limit;
mod work;

use limit::Limits;
use sinew_math::dispatch::Level;
use std::time::{Duration, Instant};

/// Duration of a sample: so short that some samples run while the processor is free.
const SAMPLE: Duration = Duration::from_micros(400);

/// Number of samples of each result. They are interleaved, so that a change of the clock rate affects all
/// measurements.
const ROUNDS: usize = 200;

fn main() {
    let mut works = work::all();
    for level in Level::available() {
        let mut limits = Limits::default();
        let mut times = vec![f64::INFINITY; works.len()];
        for _ in 0..ROUNDS {
            limits.measure(level);
            for (work, time) in works.iter_mut().zip(&mut times) {
                *time = f64::min(*time, seconds(|| work.run_at(level)));
            }
        }
        limits.print(level);
        for (work, time) in works.iter().zip(times) {
            let items = work.items() as f64;
            let limit = limits.seconds(&work.operations());
            println!("{level:?} {} {:.4e} {:.4e}", work.name, items / time, items / limit);
        }
    }
}

/// Returns the mean time of a call in a sample, seconds.
fn seconds(mut call: impl FnMut()) -> f64 {
    let start = Instant::now();
    let mut calls = 0_u32;
    loop {
        call();
        calls += 1;
        let elapsed = start.elapsed();
        if elapsed >= SAMPLE {
            return elapsed.as_secs_f64() / f64::from(calls);
        }
    }
}
