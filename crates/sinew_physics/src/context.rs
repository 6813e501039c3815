//! Settings and services of one step.

use crate::runner::TaskRunner;
use crate::stage::Profiler;

/// Data of one step: its times, its threads and its profiler.
pub(crate) struct StepContext<'a> {
    /// Length of the step, and of a substep, seconds.
    pub dt: f32,
    pub h: f32,
    pub substeps: u32,
    /// Start time, seconds.
    pub time: f64,
    pub runner: &'a dyn TaskRunner,
    pub profiler: &'a dyn Profiler,
}
