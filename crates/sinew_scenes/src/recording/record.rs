//! Records and replays scenes.

use super::format::{KeyFrame, RecordedStep, Recording};
use super::hands::{Hands, Operation};
use crate::framework::instance::Instance;
use crate::scenes::find;
use sinew::formats::Error;
use sinew::math::{Reader, Transform, Writer};
use sinew::physics::stage::{NoProfiler, Profiler};
use sinew::physics::{BodyId, Serial, TaskRunner, World};

/// Steps between key frames.
const KEY_FRAME_STEPS: u64 = 30;

/// A running scene and its recording.
pub struct Recorder {
    instance: Instance,
    hands: Hands,
    recording: Recording,
    /// Operations for the next step.
    operations: Vec<Operation>,
}

/// Creates an instance of a scene with settings, each `key=value`.
fn instance_of(scene: &str, settings: &[String]) -> Result<Instance, Error> {
    let refused = |what: String| Error::unsupported(what, "scene");
    let scene = find(scene).ok_or_else(|| refused(format!("no scene '{scene}'")))?;
    let mut values = scene.settings();
    for setting in settings {
        values.assign(setting).map_err(|error| refused(error.to_string()))?;
    }
    values.check().map_err(|error| refused(error.to_string()))?;
    Ok(scene.start(&values))
}

impl Recorder {
    /// Starts a scene by name, with settings `key=value`.
    ///
    /// # Errors
    /// If the scene does not exist or refuses a setting.
    pub fn start(scene: &str, settings: &[String]) -> Result<Self, Error> {
        Ok(Self::of(instance_of(scene, settings)?, scene, settings))
    }

    /// Creates the recorder of an instance that has taken no steps, made from that scene with those settings.
    pub fn of(instance: Instance, scene: &str, settings: &[String]) -> Self {
        let world = instance.world();
        let recording = Recording {
            made_by: env!("CARGO_PKG_VERSION").to_owned(),
            scene: scene.to_owned(),
            settings: settings.to_vec(),
            dt: world.def().dt(),
            steps: Vec::new(),
            key_frames: vec![key_frame(world)],
        };
        Self { instance, hands: Hands::default(), recording, operations: Vec::new() }
    }

    /// Returns the running scene.
    pub fn instance(&self) -> &Instance {
        &self.instance
    }

    /// Returns the user's hands, with the body that they hold.
    pub fn hands(&self) -> &Hands {
        &self.hands
    }

    /// Applies an operation now, and records it for the next step.
    pub fn apply(&mut self, operation: Operation) {
        self.hands.apply(self.instance.world_mut(), &operation);
        operation.apply_to(&mut self.instance);
        self.operations.push(operation.of_any_world());
    }

    /// Takes one step on the calling thread.
    pub fn step(&mut self) {
        self.step_with(&Serial, &NoProfiler);
    }

    /// Takes one step with the host's threads and stage times.
    pub fn step_with(&mut self, runner: &dyn TaskRunner, profiler: &dyn Profiler) {
        self.instance.step_with(runner, profiler);
        let world = self.instance.world();
        let operations = core::mem::take(&mut self.operations);
        self.recording.steps.push(RecordedStep { operations, hash: world.hash() });
        if world.step_count().is_multiple_of(KEY_FRAME_STEPS) {
            self.recording.key_frames.push(key_frame(world));
        }
    }

    /// The recording so far.
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// Saves the present state with the recording so far, to return to it.
    pub fn mark(&self) -> RecorderMark {
        let mut out = Writer::new();
        self.instance.save(&mut out);
        RecorderMark {
            state: out.into_bytes(),
            hands: self.hands.clone(),
            recording: self.recording.clone(),
            operations: self.operations.clone(),
        }
    }

    /// Returns to a state of this run. Returns false if the scene cannot be restored; the run is then unusable. Metrics
    /// are those of the whole run, except those that a scene saves.
    pub fn go_to(&mut self, mark: &RecorderMark) -> bool {
        self.hands = mark.hands.clone();
        self.recording = mark.recording.clone();
        self.operations = mark.operations.clone();
        self.instance.load(&mut Reader::new(&mark.state)).is_ok()
    }

    /// The recording, with the poses at its end.
    pub fn finish(mut self) -> Recording {
        let end = key_frame(self.instance.world());
        if self.recording.key_frames.last().is_none_or(|last| last.step != end.step) {
            self.recording.key_frames.push(end);
        }
        self.recording
    }
}

fn key_frame(world: &World) -> KeyFrame {
    let bodies = world.body_ids().map(|id| (id, world.transform(id))).collect();
    KeyFrame { step: world.step_count(), bodies }
}

/// Saved state within a run, to which its recorder can return.
#[derive(Clone, Debug)]
pub struct RecorderMark {
    state: Vec<u8>,
    hands: Hands,
    recording: Recording,
    operations: Vec<Operation>,
}

/// A recording in replay: the recorded operations are applied again.
pub struct Replay {
    instance: Instance,
    hands: Hands,
    recording: Recording,
}

/// Saved state within a replay, to which the replay can return.
#[derive(Clone, Debug)]
pub struct Mark {
    step: u64,
    state: Vec<u8>,
    hands: Hands,
}

impl Mark {
    /// Number of steps taken.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Size in memory, bytes.
    pub fn bytes(&self) -> usize {
        self.state.len()
    }
}

/// Hashes of a replayed step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReplayedStep {
    /// Number of steps taken, including this one.
    pub step: u64,
    /// Recorded hash of the state.
    pub recorded: u64,
    /// Hash of the state in the replay.
    pub found: u64,
}

impl Replay {
    /// Starts at the recording's first step.
    ///
    /// # Errors
    /// If this version does not have the scene, or the scene refuses a setting.
    pub fn start(recording: Recording) -> Result<Self, Error> {
        let instance = instance_of(&recording.scene, &recording.settings)?;
        Ok(Self { instance, hands: Hands::default(), recording })
    }

    /// Returns the running scene.
    pub fn instance(&self) -> &Instance {
        &self.instance
    }

    /// Returns the user's hands, with the body that they hold.
    pub fn hands(&self) -> &Hands {
        &self.hands
    }

    /// The recording that is played.
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// Saves the present state, to return to it.
    pub fn mark(&self) -> Mark {
        let mut out = Writer::new();
        self.instance.save(&mut out);
        let step = self.instance.world().step_count();
        Mark { step, state: out.into_bytes(), hands: self.hands.clone() }
    }

    /// Returns to a state of this recording. Returns false if the scene cannot be restored; the replay is then
    /// unusable. Metrics are those of the last playback, except those that a scene saves.
    pub fn go_to(&mut self, mark: &Mark) -> bool {
        let loaded = self.instance.load(&mut Reader::new(&mark.state));
        self.hands = mark.hands.clone();
        loaded.is_ok() && self.instance.world().step_count() == mark.step
    }

    /// First body whose pose differs from the key frame of this step, or that exists in only one of the two; `None`
    /// without a difference or a key frame.
    pub fn misplaced(&self) -> Option<BodyId> {
        let world = self.instance.world();
        let taken = world.step_count();
        let frame = self.recording.key_frames.iter().find(|frame| frame.step == taken)?;
        let now = key_frame(world).bodies;
        let differs = |(p, q): (&(BodyId, Transform), &(BodyId, Transform))| {
            (p.0.to_bits() != q.0.to_bits() || p.1 != q.1).then_some(q.0)
        };
        let common = usize::min(now.len(), frame.bodies.len());
        let first = frame.bodies.iter().zip(&now).find_map(differs);
        first.or_else(|| frame.bodies[common..].iter().chain(&now[common..]).map(|&(id, _)| id).next())
    }

    /// Takes the next step; `None` at the end.
    pub fn step(&mut self) -> Option<ReplayedStep> {
        self.step_with(&Serial, &NoProfiler)
    }

    /// Takes the next step with the host's threads and stage times; `None` at the end.
    pub fn step_with(&mut self, runner: &dyn TaskRunner, profiler: &dyn Profiler) -> Option<ReplayedStep> {
        let taken = self.instance.world().step_count();
        let step = self.recording.steps.get(usize::try_from(taken).ok()?)?;
        for operation in &step.operations {
            self.hands.apply(self.instance.world_mut(), operation);
            operation.apply_to(&mut self.instance);
        }
        self.instance.step_with(runner, profiler);
        Some(ReplayedStep { step: taken + 1, recorded: step.hash, found: self.instance.world().hash() })
    }
}
