//! A progress bar on stderr for long work.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::{Duration, Instant};

/// Time after which the bar is shown.
const PATIENCE: Duration = Duration::from_secs(1);

/// A progress bar that appears once the work takes over a second, on a terminal only.
pub struct Progress {
    bar: ProgressBar,
    start: Instant,
}

impl Progress {
    /// Creates the display of `steps` steps of `what`.
    pub fn new(what: &'static str, steps: usize) -> Self {
        let bar = ProgressBar::with_draw_target(Some(steps as u64), ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message(what);
        Self { bar, start: Instant::now() }
    }

    /// Reports that one step is done.
    pub fn step(&self) {
        self.bar.inc(1);
        self.show();
    }

    /// Reports that `steps` steps are done.
    pub fn reach(&self, steps: usize) {
        self.bar.set_position(steps as u64);
        self.show();
    }

    /// Shows the bar after [`PATIENCE`]; it stays hidden if stderr is not a terminal.
    fn show(&self) {
        if self.bar.is_hidden() && self.start.elapsed() > PATIENCE {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
