//! Time that each stage of a step takes.

use sinew::physics::stage::{Profiler, Stage};
use std::cell::RefCell;
use std::sync::atomic::{AtomicU64, Ordering};
use web_time::Instant;

/// All stages, in the order of the step.
pub const STAGES: [Stage; 20] = [
    Stage::Pairs,
    Stage::Collide,
    Stage::Touch,
    Stage::Islands,
    Stage::Color,
    Stage::Flight,
    Stage::Prepare,
    Stage::IntegrateVelocity,
    Stage::WarmStart,
    Stage::Solve,
    Stage::IntegratePosition,
    Stage::Project,
    Stage::Relax,
    Stage::Restitution,
    Stage::Store,
    Stage::Finalize,
    Stage::Continuous,
    Stage::Sleep,
    Stage::Sensors,
    Stage::Movers,
];

/// Weight of the newest step in the shown mean, which follows within a few tenths of a second.
const NEWEST: f64 = 0.1;

thread_local! {
    static BEGUN: RefCell<Vec<Instant>> = const { RefCell::new(Vec::new()) };
}

/// Time of each stage, summed over threads, as a mean that follows the last steps.
#[derive(Debug, Default)]
pub struct StageTimes {
    /// Times of the current step, nanoseconds.
    now: [AtomicU64; STAGES.len()],
    /// Mean times, milliseconds.
    mean: [f64; STAGES.len()],
}

impl StageTimes {
    /// Returns the mean milliseconds of each of [`STAGES`].
    pub fn milliseconds(&self) -> [f64; STAGES.len()] {
        self.mean
    }

    pub(crate) fn begin_step(&mut self) {
        self.now.iter_mut().for_each(|time| *time.get_mut() = 0);
    }

    pub(crate) fn end_step(&mut self) {
        for (mean, now) in self.mean.iter_mut().zip(&mut self.now) {
            *mean += (*now.get_mut() as f64 * 1e-6 - *mean) * NEWEST;
        }
    }
}

impl Profiler for StageTimes {
    fn begin(&self, _: Stage) {
        BEGUN.with_borrow_mut(|begun| begun.push(Instant::now()));
    }

    fn end(&self, stage: Stage) {
        if let Some(begun) = BEGUN.with_borrow_mut(Vec::pop) {
            let time = begun.elapsed().as_nanos() as u64;
            self.now[stage as usize].fetch_add(time, Ordering::Relaxed);
        }
    }
}
