//! Times of the stages of Sinew's step on a scene, µs, and counts of their work.
//!
//! Scenes without a world's step (rays, pairs of boxes, clips) have one time for the whole.

use crate::engine::Effort;
use crate::engines;
use crate::measure::quantile;
use crate::run::{Judging, Start, run};
use crate::scenes::{self, Work};
use core::time::Duration;
use cpu_time::ProcessTime;
use serde_json::{Map, Value, json};
use sinew::physics::stage::{Counter, NoProfiler, Profiler, Stage};
use sinew::physics::{Serial, TaskRunner, Threads};
use sinew_scenes::scenes::{Instance, find};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Largest share of a step for reading the processor's clock; above that the wall clock is read, which costs less.
const CLOCK_SHARE: f64 = 0.02;

/// Number of steps for the choice of the clock.
const TRIAL: u32 = 3;

/// Number of reads that measure a clock's cost.
const READS: u32 = 1_000;

/// A scene to trace, and its number of steps.
#[derive(Clone, Copy, Debug)]
pub struct Trace<'a> {
    /// A scene of the peers, or else of `sinew scenes`.
    pub scene: &'a str,
    /// Number of steps after the warm-up; `None`: the rest of the scene.
    pub steps: Option<u32>,
    /// Number of steps before the trace; `None`: a third of the scene's.
    pub warm_up: Option<u32>,
    /// Number of threads; stages and counts need one.
    pub threads: usize,
}

/// A running world and its counters.
enum Run {
    World(Box<sinew::physics::World>),
    Scene(Box<Instance>),
}

impl Run {
    fn step(&mut self, runner: &dyn TaskRunner, profiler: &dyn Profiler) {
        match self {
            Self::World(world) => world.step_with(runner, profiler),
            Self::Scene(scene) => scene.step_with(runner, profiler),
        }
    }
}

impl Trace<'_> {
    /// Runs the scene and returns time and counts of each stage as one JSON object.
    ///
    /// # Errors
    /// If there is no such scene, or it cannot be built without settings.
    pub fn run(&self) -> Result<Value, String> {
        let (mut run, steps) = match scenes::find(self.scene) {
            Some(scene) => match (scene.work)() {
                Work::Bodies(blueprint) => (Run::World(Box::new(blueprint.build().0)), blueprint.steps),
                _ => return self.whole(scene),
            },
            None => {
                let scene = find(self.scene).ok_or_else(|| format!("no scene {}", self.scene))?;
                let settings = scene.settings();
                settings.check().map_err(|error| error.to_string())?;
                (Run::Scene(Box::new(scene.start(&settings))), scene.steps)
            }
        };
        let warm_up = self.warm_up.unwrap_or(steps / 3);
        let steps = self.steps.unwrap_or(steps.saturating_sub(warm_up)).max(1);
        if self.threads > 1 {
            return Ok(self.threaded(&mut run, warm_up, steps));
        }
        (0..warm_up.saturating_sub(TRIAL)).for_each(|_| run.step(&Serial, &NoProfiler));
        let clock = choose_clock(&mut run, warm_up.min(TRIAL));
        let records: Vec<Record> = (0..steps).map(|_| traced(&mut run, clock)).collect();
        Ok(self.report(clock, warm_up, &records))
    }

    /// Measures the wall time of whole steps with several threads.
    fn threaded(&self, run: &mut Run, warm_up: u32, steps: u32) -> Value {
        let threads = Threads::new(self.threads);
        (0..warm_up).for_each(|_| run.step(&threads, &NoProfiler));
        let step = |_| {
            let start = Instant::now();
            run.step(&threads, &NoProfiler);
            start.elapsed().as_secs_f64() * 1e6
        };
        let wall = quantile(&(0..steps).map(step).collect::<Vec<_>>(), 0.5);
        let step = json!({ "cpu_us": null, "wall_us": wall });
        json!({ "scene": self.scene, "warm_up": warm_up, "steps": steps, "step": step })
    }

    /// Returns the time of whole steps, for work without a world (rays, boxes, clips).
    fn whole(&self, scene: &scenes::Scene) -> Result<Value, String> {
        let entry = engines::find("sinew").and_then(|entry| entry.engine).ok_or("this build has no Sinew")?;
        let steps = self.steps.map(|steps| steps as usize);
        let report = run(entry, scene, Start::Own, steps, (Judging::Off, Effort::Default));
        if let Some(why) = report["unsupported"].as_str() {
            return Err(format!("{}: {why}", self.scene));
        }
        let us = report["cpu_ms"]["median"].as_f64().map(|ms| ms * 1e3);
        let step = json!({ "cpu_us": us, "wall_us": null });
        Ok(json!({ "scene": self.scene, "warm_up": 0, "steps": report["steps"], "step": step }))
    }

    fn report(&self, clock: Clock, warm_up: u32, records: &[Record]) -> Value {
        let median = |of: &dyn Fn(&Record) -> f64| quantile(&records.iter().map(of).collect::<Vec<_>>(), 0.5);
        let us = |time: Duration| time.as_secs_f64() * 1e6;
        let mut stages = Map::new();
        for stage in 0..=Stage::Movers as usize {
            let found = records.iter().find_map(|record| record.stages[stage].stage);
            let Some(named) = found else { continue };
            stages.insert(
                snake_case(&format!("{named:?}")),
                json!(median(&|record| us(record.stages[stage].time))),
            );
        }
        let mut counts = Map::new();
        let counters: BTreeMap<Counter, ()> =
            records.iter().flat_map(|record| record.counts.keys().map(|&counter| (counter, ()))).collect();
        for &counter in counters.keys() {
            let of = |record: &Record| record.counts.get(&counter).map_or(0, |count| count.sum) as f64;
            counts.insert(snake_case(&format!("{counter:?}")), json!(median(&of)));
        }
        let bodies = |record: &Record| record.counts.get(&Counter::Bodies).copied().unwrap_or_default();
        counts.insert("islands".into(), json!(median(&|record| bodies(record).calls as f64)));
        counts.insert("largest_island".into(), json!(median(&|record| bodies(record).most as f64)));
        let reads = median(&|record| f64::from(record.reads));
        json!({
            "scene": self.scene,
            "warm_up": warm_up,
            "steps": records.len(),
            "step": {
                "cpu_us": median(&|record| us(record.cpu)),
                "wall_us": median(&|record| us(record.wall)),
            },
            "clock": clock.name(),
            "clock_us": reads * us(clock.cost()),
            "stages_us": stages,
            "counts": counts,
        })
    }
}

/// Takes one traced step.
fn traced(run: &mut Run, clock: Clock) -> Record {
    let recorder = Recorder::new(clock);
    let (wall, cpu) = (Instant::now(), ProcessTime::now());
    run.step(&Serial, &recorder);
    let (cpu, wall) = (cpu.elapsed(), wall.elapsed());
    let record = recorder.record.into_inner().unwrap_or_else(PoisonError::into_inner);
    Record { cpu, wall, ..record }
}

/// Chooses processor time, unless there are so many zones that reading it would affect the result.
fn choose_clock(run: &mut Run, steps: u32) -> Clock {
    let trial: Vec<Record> = (0..steps).map(|_| traced(run, Clock::Wall)).collect();
    let reads: f64 = trial.iter().map(|record| f64::from(record.reads)).sum();
    let time: f64 = trial.iter().map(|record| record.cpu.as_secs_f64()).sum();
    if reads * Clock::Processor.cost().as_secs_f64() <= CLOCK_SHARE * time {
        Clock::Processor
    } else {
        Clock::Wall
    }
}

/// Clock that times stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Clock {
    /// Processor time of the process, which has one thread: other load does not count, but a read is a system call.
    Processor,
    Wall,
}

impl Clock {
    fn name(self) -> &'static str {
        match self {
            Self::Processor => "processor",
            Self::Wall => "wall",
        }
    }

    /// Returns the duration of one read of the clock.
    fn cost(self) -> Duration {
        let start = Instant::now();
        let watch = Watch::start(self);
        (0..READS).for_each(|_| {
            core::hint::black_box(watch.elapsed());
        });
        start.elapsed() / READS
    }
}

/// Clock that starts at the beginning of a step.
#[derive(Clone, Copy)]
enum Watch {
    Processor(ProcessTime),
    Wall(Instant),
}

impl Watch {
    fn start(clock: Clock) -> Self {
        match clock {
            Clock::Processor => Self::Processor(ProcessTime::now()),
            Clock::Wall => Self::Wall(Instant::now()),
        }
    }

    fn elapsed(&self) -> Duration {
        match self {
            Self::Processor(start) => start.elapsed(),
            Self::Wall(start) => start.elapsed(),
        }
    }
}

/// Times and counts of one step.
#[derive(Clone, Debug, Default)]
struct Record {
    wall: Duration,
    cpu: Duration,
    stages: [StageTime; Stage::Movers as usize + 1],
    counts: BTreeMap<Counter, Count>,
    /// Number of reads of the clock.
    reads: u32,
}

#[derive(Clone, Debug, Default)]
struct StageTime {
    /// Stage to which the time belongs.
    stage: Option<Stage>,
    time: Duration,
}

#[derive(Clone, Copy, Debug, Default)]
struct Count {
    sum: u64,
    /// Largest number in one call.
    most: u64,
    calls: u64,
}

/// Profiler of one step on one thread.
struct Recorder {
    watch: Watch,
    record: Mutex<Record>,
    /// Start times of the open zones.
    open: Mutex<Vec<Duration>>,
}

impl Recorder {
    fn new(clock: Clock) -> Self {
        let watch = Watch::start(clock);
        Self { watch, record: Mutex::default(), open: Mutex::new(Vec::with_capacity(2)) }
    }
}

impl Profiler for Recorder {
    fn begin(&self, _: Stage) {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        open.push(self.watch.elapsed());
    }

    fn end(&self, stage: Stage) {
        let now = self.watch.elapsed();
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        let began = open.pop().unwrap_or(now);
        let mut record = self.record.lock().unwrap_or_else(PoisonError::into_inner);
        record.reads += 2;
        let entry = &mut record.stages[stage as usize];
        entry.time += now - began;
        entry.stage = Some(stage);
    }

    fn is_counting(&self) -> bool {
        true
    }

    fn count(&self, counter: Counter, by: u64) {
        let mut record = self.record.lock().unwrap_or_else(PoisonError::into_inner);
        let count = record.counts.entry(counter).or_default();
        count.sum += by;
        count.most = count.most.max(by);
        count.calls += 1;
    }
}

fn snake_case(name: &str) -> String {
    let mut snake = String::new();
    for c in name.chars() {
        if c.is_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.extend(c.to_lowercase());
    }
    snake
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trace(scene: &str, warm_up: u32, steps: u32) -> Value {
        Trace { scene, steps: Some(steps), warm_up: Some(warm_up), threads: 1 }.run().expect("it is a scene")
    }

    #[test]
    fn counts_match_the_scene() {
        let counts = &trace("chain_100_links", 0, 2)["counts"];
        assert_eq!(counts["islands"], 10.0, "{counts}");
        assert_eq!(counts["largest_island"], 101.0, "{counts}");
        assert_eq!((&counts["joints"], &counts["bodies"]), (&json!(1010.0), &json!(1010.0)));
        assert_eq!((&counts["manifolds"], &counts["visits"]), (&json!(0.0), &json!(0.0)));
        assert_eq!(counts["body_substeps"], 4040.0);
    }

    #[test]
    fn stack_has_stages_and_sweeps() {
        let trace = trace("stack_ratio", 5, 5);
        let stages = trace["stages_us"].as_object().expect("stages");
        assert!(stages.contains_key("integrate_velocity") && stages.contains_key("pairs"), "{trace:#}");
        let counts = &trace["counts"];
        assert!(counts["relax_rows"].as_f64() >= counts["pass_rows"].as_f64(), "{counts}");
        assert!(counts["touched_bytes"].as_f64() > counts["resident_bytes"].as_f64(), "{counts}");
    }

    #[test]
    fn named_scenes_and_work_without_a_world_can_be_traced() {
        assert!(trace("pendulum", 1, 2)["stages_us"].is_object());
        assert!(trace("obb_tests", 0, 1)["step"]["cpu_us"].is_number());
        assert!(Trace { scene: "nowhere", steps: None, warm_up: None, threads: 1 }.run().is_err());
        let on_two = Trace { scene: "stack_ratio", steps: Some(2), warm_up: Some(1), threads: 2 }.run();
        assert!(on_two.is_ok_and(|trace| trace["step"]["wall_us"].is_number()));
    }
}
