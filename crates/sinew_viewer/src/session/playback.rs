//! Playback of a recording in both directions.

use sinew::formats::Error;
use sinew::physics::TaskRunner;
use sinew::physics::stage::{NoProfiler, Profiler};
use sinew_scenes::recording::{Difference, Mark, Recording, Replay, compare};
use sinew_scenes::scenes::Metric;
use web_time::Instant;

/// Initial number of steps between marks.
const MARK_STEPS: u64 = 30;
/// Largest total size of the marks, bytes; above that, every second mark is dropped.
const MARK_BYTES: usize = 128 << 20;

/// A recording in playback. Earlier steps are restored with all their measurements.
pub(super) struct Playback {
    pub replay: Replay,
    /// Marks by the number of steps taken, in order.
    marks: Vec<Mark>,
    mark_steps: u64,
    /// Metrics after each number of steps that has been reached.
    metrics: Vec<Vec<Metric>>,
    /// Hash of the state after each step, from its first playback.
    hashes: Vec<u64>,
    /// First step whose state differs from the recorded one.
    pub diverged: Option<u64>,
}

impl Playback {
    pub fn start(recording: Recording) -> Result<Self, Error> {
        let replay = Replay::start(recording)?;
        let metrics = vec![replay.instance().metrics()];
        Ok(Self {
            replay,
            marks: Vec::new(),
            mark_steps: MARK_STEPS,
            metrics,
            hashes: Vec::new(),
            diverged: None,
        })
    }

    /// Returns the number of steps taken.
    pub fn at(&self) -> u64 {
        self.replay.instance().world().step_count()
    }

    /// Returns the number of recorded steps.
    pub fn length(&self) -> u64 {
        self.replay.recording().steps.len() as u64
    }

    /// Returns the metrics up to now, after each number of steps.
    pub fn metrics(&self) -> &[Vec<Metric>] {
        &self.metrics[..=(self.at() as usize).min(self.metrics.len() - 1)]
    }

    /// Takes the next step; returns false at the end.
    pub fn step(&mut self, runner: &dyn TaskRunner, profiler: &dyn Profiler) -> bool {
        let Some(step) = self.replay.step_with(runner, profiler) else { return false };
        if self.hashes.get(step.step as usize - 1).is_some_and(|&first| first != step.found) {
            self.play_anew();
            while self.at() < step.step && self.replay.step_with(runner, &NoProfiler).is_some() {}
            return true;
        }
        if step.found != step.recorded && self.diverged.is_none_or(|first| step.step < first) {
            self.diverged = Some(step.step);
        }
        if self.metrics.len() as u64 == step.step {
            self.metrics.push(self.replay.instance().metrics());
            self.hashes.push(step.found);
            self.mark();
        }
        true
    }

    /// Stores a mark of the present state. Characters beside a world cannot be restored, so their scenes are replayed from the start.
    fn mark(&mut self) {
        if !self.at().is_multiple_of(self.mark_steps) || !self.replay.instance().figures().is_empty() {
            return;
        }
        self.marks.push(self.replay.mark());
        if self.marks.iter().map(Mark::bytes).sum::<usize>() > MARK_BYTES {
            self.mark_steps *= 2;
            let mark_steps = self.mark_steps;
            self.marks.retain(|mark| mark.step().is_multiple_of(mark_steps));
        }
    }

    /// Seeks to a step, in either direction, until a time limit; returns true when the step is reached.
    pub fn seek(&mut self, goal: u64, runner: &dyn TaskRunner, until: Instant) -> bool {
        let goal = goal.min(self.length());
        let at = self.at();
        let mark = self.marks.iter().rposition(|mark| mark.step() <= goal && (mark.step() > at || goal < at));
        if let Some(mark) = mark.map(|place| &self.marks[place]) {
            if !self.replay.go_to(mark) {
                self.play_anew();
            }
        } else if goal < at {
            self.rewind();
        }
        while self.at() < goal && Instant::now() < until {
            if !self.step(runner, &NoProfiler) {
                break;
            }
        }
        self.at() >= goal
    }

    /// Replays from the start, now and for all later seeks, because the scene cannot be restored.
    fn play_anew(&mut self) {
        self.marks.clear();
        self.mark_steps = u64::MAX;
        self.rewind();
    }

    fn rewind(&mut self) {
        let recording = self.replay.recording().clone();
        // The recording has been started before, so this succeeds.
        if let Ok(replay) = Replay::start(recording) {
            self.replay = replay;
        }
    }
}

/// A second run of the same scene, shown beside the first.
pub struct Ghost {
    pub(super) name: String,
    pub(super) playback: Playback,
    pub(super) difference: Option<Difference>,
}

impl Ghost {
    pub(super) fn new(name: String, recording: Recording, first: &Recording) -> Result<Self, Error> {
        let difference = compare(first, &recording);
        if difference == Some(Difference::Scene) {
            return Err(Error::unsupported("is of another scene or has other settings", ""));
        }
        Ok(Self { name, playback: Playback::start(recording)?, difference })
    }

    /// Returns the name of the second run's file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the first difference of the two runs; `None` if there is none.
    pub fn difference(&self) -> Option<&Difference> {
        self.difference.as_ref()
    }

    /// Returns the world of the second run.
    pub fn world(&self) -> &sinew::physics::World {
        self.playback.replay.instance().world()
    }
}
