//! Measures work in processor time, independent of other programs on the machine.

use cpu_time::ProcessTime;

/// Processor seconds that this process spent on `work`, on all its threads, and its result.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = ProcessTime::now();
    let result = work();
    (result, start.elapsed().as_secs_f64())
}
