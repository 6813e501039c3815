//! Settings and services of one step.

use crate::runner::TaskRunner;
use crate::stage::Profiler;

/// Settings and services that exist for one step.
pub(crate) struct StepContext<'a> {
    /// Length of the step and of a substep (`h`), seconds.
    pub dt: f32,
    pub h: f32,
    pub substeps: u32,
    /// Start time of the step, seconds.
    pub time: f64,
    pub runner: &'a dyn TaskRunner,
    pub profiler: &'a dyn Profiler,
}
