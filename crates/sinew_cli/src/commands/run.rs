//! `sinew run`: runs a named scene without a picture: metrics, times, state hash.

use crate::failure::{Failure, Result};
use crate::input::scene_choice::choose;
use crate::report::Report;
use crate::report::progress::Progress;
use crate::report::table::Table;
use serde_json::{Map, Value, json};
use sinew::physics::stage::NoProfiler;
use sinew::physics::{Quality, Serial, TaskRunner, Threads};
use sinew_scenes::scenes::{Expected, Instance, Metric, Part, Scene};
use std::fmt::Write;
use std::time::Instant;

/// Run a named scene without a picture, and print its figures and the hash of its state
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew run pendulum
  sinew run stairs --steps 600 --threads 2 --set impulse=50 --json
  sinew run mjcf_drop --set file=humanoid.xml
  sinew run double_pendulum --quality exact

'sinew scenes' lists the scenes, 'sinew scenes --json' their settings too. 'mjcf_drop', which it does \
not list, drops MuJoCo's humanoid, or another model in MJCF with the poses 'prone' and 'supine'.

A scene that misses what it expects ends with exit code 1, its report printed all the same; after --set, \
--steps or --quality it expects nothing.")]
pub struct Run {
    /// Name of the scene
    scene: String,
    /// Number of steps of 1/60 s; by default the scene's own length
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    steps: Option<u32>,
    /// Threads; the state does not depend on the number
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=256))]
    threads: u16,
    /// Step quality: more work per step is more accurate
    #[arg(long, default_value_t, value_enum)]
    quality: QualityName,
    /// Change a setting of the scene; repeatable
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
}

/// A [`Quality`] by name.
#[derive(Clone, Copy, Default, clap::ValueEnum)]
enum QualityName {
    /// Half of the substeps and sweeps
    Fast,
    /// The content's own settings
    #[default]
    Balanced,
    /// Twice the substeps and sweeps
    Exact,
}

impl From<QualityName> for Quality {
    fn from(name: QualityName) -> Self {
        match name {
            QualityName::Fast => Self::Fast,
            QualityName::Balanced => Self::Balanced,
            QualityName::Exact => Self::Exact,
        }
    }
}

impl Run {
    /// Runs the command: steps the scene and reports on it.
    pub fn run(&self) -> Result<Report> {
        let (scene, settings) = choose(&self.scene, &self.settings)?;
        let steps = self.steps.unwrap_or(scene.steps);
        let mut instance = scene.start(&settings);
        instance.world_mut().set_world_quality(self.quality.into());
        let times = StepTimes::measure(&mut instance, steps, &*self.runner());
        let outcome = Outcome {
            scene,
            steps,
            threads: self.threads,
            times,
            hash: instance.world().hash(),
            metrics: instance.metrics(),
            has_bars: self.is_by_default(),
        };
        let report = Report { json: outcome.to_json(), text: outcome.to_text() };
        let missed = outcome.missed();
        if missed.is_empty() {
            return Ok(report);
        }
        let what = format!("{} misses its expectations: {}", scene.name, missed.join(", "));
        Err(Failure::Missed { report: Box::new(report), what })
    }

    /// Returns whether the scene runs with its default settings and steps. Expectations apply only then.
    fn is_by_default(&self) -> bool {
        self.settings.is_empty() && self.steps.is_none() && matches!(self.quality, QualityName::Balanced)
    }

    fn runner(&self) -> Box<dyn TaskRunner> {
        match self.threads {
            1 => Box::new(Serial),
            threads => Box::new(Threads::new(usize::from(threads))),
        }
    }
}

/// Wall time of steps, milliseconds.
struct StepTimes {
    median: f64,
    p99: f64,
    costs: Vec<Cost>,
}

/// Cost of one part of the work over all steps.
struct Cost {
    name: &'static str,
    seconds: f64,
    /// Number of processed items, summed over all steps.
    count: u64,
}

/// Adds to the cost of one part.
fn spend(costs: &mut Vec<Cost>, part: Part, seconds: f64) {
    let count = u64::from(part.count);
    match costs.iter_mut().find(|cost| cost.name == part.name) {
        Some(cost) => {
            cost.seconds += seconds;
            cost.count += count;
        }
        None => costs.push(Cost { name: part.name, seconds, count }),
    }
}

impl StepTimes {
    fn measure(instance: &mut Instance, steps: u32, runner: &dyn TaskRunner) -> Self {
        let progress = Progress::new("running", steps as usize);
        let mut costs = Vec::new();
        let mut times: Vec<f64> = (0..steps)
            .map(|_| {
                let start = Instant::now();
                let mut last = start;
                instance.step_in_parts(runner, &NoProfiler, &mut |part| {
                    let now = Instant::now();
                    spend(&mut costs, part, (now - last).as_secs_f64());
                    last = now;
                });
                progress.step();
                start.elapsed().as_secs_f64() * 1e3
            })
            .collect();
        times.sort_unstable_by(f64::total_cmp);
        let rank = |percent: usize| times[(times.len() * percent).div_ceil(100) - 1];
        Self { median: rank(50), p99: rank(99), costs }
    }
}

/// A scene that has been run.
struct Outcome<'a> {
    scene: &'a Scene,
    steps: u32,
    threads: u16,
    times: StepTimes,
    hash: u64,
    metrics: Vec<Metric>,
    /// True if the metrics are compared with the scene's expectations.
    has_bars: bool,
}

impl Outcome<'_> {
    /// Returns the metrics that miss the scene's expectations.
    fn missed(&self) -> Vec<&'static str> {
        let unmet = self.metrics.iter().filter(|metric| self.has_bars && !metric.is_met());
        unmet.map(|metric| metric.name).collect()
    }

    fn to_json(&self) -> Value {
        let metrics: Map<String, Value> =
            self.metrics.iter().map(|metric| (metric.name.to_owned(), json!(metric.value))).collect();
        json!({
            "scene": self.scene.name,
            "steps": self.steps,
            "threads": self.threads,
            "ms_per_step_median": self.times.median,
            "ms_per_step_p99": self.times.p99,
            "cost_us": self.costs(),
            "hash": format!("{:016x}", self.hash),
            "metrics": metrics,
        })
    }

    /// Returns the microseconds per step per item of each kind, in scenes whose work has parts.
    fn costs(&self) -> Map<String, Value> {
        let parts = self.times.costs.iter().filter(|cost| cost.count > 0);
        let of = |cost: &Cost| (cost.name.to_owned(), json!(cost.seconds * 1e6 / cost.count as f64));
        if self.times.costs.len() > 1 { parts.map(of).collect() } else { Map::new() }
    }

    fn to_text(&self) -> String {
        let Self { scene, steps, threads, times, hash, metrics, has_bars } = self;
        let mut text = format!("{}: {}\n\n", scene.name, scene.about);
        let mut table = Table::titled(&["figure", "value", "expected"]);
        for metric in metrics {
            let value = metric.value.map_or("not yet".to_owned(), |value| format!("{value:.6}"));
            let mark = if *has_bars && !metric.is_met() { "  MISSED" } else { "" };
            table.row([metric.name.to_owned(), value, expectation(metric.expected) + mark]);
        }
        text += &table.to_text();
        if !self.costs().is_empty() {
            let mut table = Table::titled(&["cost a step of one", "µs", "counted"]);
            for cost in self.times.costs.iter().filter(|cost| cost.count > 0) {
                let each = cost.seconds * 1e6 / cost.count as f64;
                table.row([part_name(cost.name), format!("{each:.3}"), cost.count.to_string()]);
            }
            let _ = write!(text, "\n{}", table.to_text());
        }
        let _ = writeln!(
            text,
            "\n{steps} steps on {threads} {}: median {:.3} ms, 99 % below {:.3} ms; state {hash:016x}",
            if *threads == 1 { "thread" } else { "threads" },
            times.median,
            times.p99,
        );
        text
    }
}

/// Returns the name of a part in a table.
fn part_name(name: &str) -> String {
    if name == Instance::WORLD {
        "body, in the world".to_owned()
    } else {
        format!("{}, beside it", name.replace('_', " "))
    }
}

fn expectation(expected: Expected) -> String {
    match expected {
        Expected::Near { value, tolerance } => format!("{value:.6} ± {tolerance:.1e}"),
        Expected::AtMost(most) => format!("at most {most}"),
        Expected::Anything => String::new(),
    }
}
