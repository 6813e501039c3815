//! Measures work in processor time, independent of other programs on the machine.

use cpu_time::ProcessTime;

/// Runs `work`; returns its result, and the processor seconds that it took on all threads of this process.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = ProcessTime::now();
    let result = work();
    (result, start.elapsed().as_secs_f64())
}
