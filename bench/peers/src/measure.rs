//! Time and memory of a run.

use cpu_time::ProcessTime;
use serde_json::{Value, json};

/// Processor time of the steps of a run, milliseconds.
#[derive(Clone, Debug, PartialEq)]
pub struct StepTimes {
    /// Time of each step, in order.
    milliseconds: Vec<f64>,
}

impl StepTimes {
    /// Runs `step` `steps` times, with its number as the argument.
    ///
    /// # Panics
    /// If `steps` is 0.
    pub fn measure(steps: usize, mut step: impl FnMut(usize)) -> Self {
        assert!(steps > 0, "at least one step is measured");
        let mut milliseconds = Vec::with_capacity(steps);
        for number in 0..steps {
            let start = ProcessTime::now();
            step(number);
            milliseconds.push(start.elapsed().as_secs_f64() * 1e3);
        }
        Self { milliseconds }
    }

    /// Returns the number of steps.
    pub fn count(&self) -> usize {
        self.milliseconds.len()
    }

    /// Returns the median.
    pub fn median(&self) -> f64 {
        quantile(&self.milliseconds, 0.5)
    }

    /// Returns the times as part of a report; `last_third` is the median of the last third of the steps, when piles have
    /// settled.
    pub fn to_json(&self) -> Value {
        let all = &self.milliseconds;
        json!({
            "median": self.median(),
            "p99": quantile(all, 0.99),
            "mean": all.iter().sum::<f64>() / all.len() as f64,
            "last_third": quantile(&all[all.len() * 2 / 3..], 0.5),
            "best": quantile(all, 0.0),
            "worst": quantile(all, 1.0),
        })
    }
}

/// Returns the smallest value that at least the share `q` of the values does not exceed.
pub(crate) fn quantile(values: &[f64], q: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let rank = (q * sorted.len() as f64).ceil() as usize;
    sorted[rank.saturating_sub(1)]
}

/// Memory of this process, from /proc; unknown on systems other than Linux.
pub struct Memory {
    resident_kib: Option<u64>,
}

impl Memory {
    /// Returns the resident memory now.
    pub fn now() -> Self {
        Self { resident_kib: status("VmRSS:") }
    }

    /// Returns the increase of peak resident memory since the start, MiB.
    pub fn peak_above_mib(&self) -> Option<f64> {
        let peak = status("VmHWM:")?;
        Some(peak.saturating_sub(self.resident_kib?) as f64 / 1024.0)
    }
}

/// Returns an entry of `/proc/self/status`, KiB.
fn status(key: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let entry = status.lines().find_map(|line| line.strip_prefix(key))?;
    entry.trim().strip_suffix(" kB")?.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_equal_entries_of_the_sorted_values() {
        let values: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!(quantile(&values, 0.0), 1.0);
        assert_eq!(quantile(&values, 0.5), 50.0);
        assert_eq!(quantile(&values, 0.99), 99.0);
        assert_eq!(quantile(&[3.0, 1.0, 2.0], 0.5), 2.0);
        assert_eq!(quantile(&[7.0], 0.99), 7.0);
    }

    #[test]
    fn the_last_third_is_at_the_end() {
        let times = StepTimes { milliseconds: vec![9.0, 9.0, 9.0, 9.0, 1.0, 2.0] };
        let report = times.to_json();
        assert_eq!(report["last_third"], 1.0);
        assert_eq!(report["best"], 1.0);
        assert_eq!(report["worst"], 9.0);
        assert_eq!(report["mean"], 6.5);
        assert_eq!(times.median(), 9.0);
    }
}
