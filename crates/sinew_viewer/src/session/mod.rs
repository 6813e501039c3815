//! A running subject: a scene with user operations, a character on the workbench, or a recording.

mod files;
mod playback;
mod subject;
mod takes;
mod undo;
mod workbench;

pub use playback::Ghost;
pub use subject::{NamedFile, Subject};
pub use workbench::{Workbench, limits};

use crate::stage_times::StageTimes;
use files::Opened;
use playback::Playback;
use sinew::formats::{Error, read_bytes};
use sinew::math::Affine;
use sinew::physics::stage::NoProfiler;
use sinew::physics::{BodyId, BodyKind, Serial, Sleeping, TaskRunner, Threads, World};
use sinew::ragdoll::settings::BoneSettings;
use sinew_picture::world::Trails;
use sinew_scenes::recording::{Hands, Operation, Recorder, Recording};
use sinew_scenes::scenes::{Instance, Metric, Trails as DrawnTrails};
use sinew_scenes::staged::staged;
use std::path::Path;
use undo::Undo;
use web_time::{Duration, Instant};

/// Mode in which a subject runs.
enum Run {
    Live(Box<Recorder>),
    Replay(Box<Playback>),
}

/// Largest number of poses kept for export: five minutes.
const MOST_POSES: usize = 18_000;

fn is_glb(path: &Path) -> bool {
    ["glb", "vrm"].into_iter().any(|extension| subject::has_extension(path, extension))
}

/// Longest time that a ghost may block the window.
const LONGEST_WAIT: Duration = Duration::from_secs(5);

/// A running subject.
pub struct Session {
    subject: Subject,
    run: Run,
    threads: usize,
    runner: Box<dyn TaskRunner>,
    times: StageTimes,
    /// Wall time of the last step.
    step_time: Duration,
    report: Vec<String>,
    workbench: Option<Box<Workbench>>,
    /// Bodies of the ragdoll, if no character lists them.
    bodies: Vec<BodyId>,
    ghost: Option<Box<Ghost>>,
    /// Poses of the workbench's character at its start and after each step, world from joint.
    poses: Vec<Vec<Affine>>,
    /// Paths of a few moving bodies.
    trails: Trails,
    /// Number of steps up to which the trails are drawn.
    trailed: u64,
    undo: Undo,
    /// The same scene with other settings, which takes the same operations, and its subject.
    twin: Option<(Box<Recorder>, Subject)>,
}

impl Session {
    /// Starts a subject.
    ///
    /// # Errors
    /// One line: the file cannot be read, or the recording is of an unknown scene.
    pub fn start(subject: Subject) -> Result<Self, Error> {
        let opened = match &subject {
            Subject::Scene(scene, settings, assignments) => {
                let run = Recorder::of(scene.start(settings), scene.name, assignments);
                return Ok(Self::of(subject, Run::Live(Box::new(run))));
            }
            Subject::Recording(path, recording) => {
                let playback = Playback::start((**recording).clone());
                let playback = playback.map_err(|error| error.with_file(path.display().to_string()))?;
                return Ok(Self::of(subject, Run::Replay(Box::new(playback))));
            }
            Subject::Sample(sample) => {
                let instance = staged(sample.character());
                let run = Recorder::of(instance, sample.name(), &[]);
                return Ok(Self::of(subject, Run::Live(Box::new(run))));
            }
            Subject::Staged(files) => files::stage(files)?,
            Subject::File(path) => files::open(path)?,
            Subject::Dropped(files) => files::open_dropped(files)?,
        };
        match opened {
            Opened::World(instance, report) | Opened::Motion(instance, report) => {
                let run = Recorder::of(*instance, &subject.title(), &[]);
                Ok(Self { report, ..Self::of(subject, Run::Live(Box::new(run))) })
            }
            Opened::Workbench(workbench) => Ok(Self::on(subject, workbench)),
        }
    }

    fn of(subject: Subject, run: Run) -> Self {
        let mut session = Self {
            subject,
            run,
            threads: 1,
            runner: Box::new(Serial),
            times: StageTimes::default(),
            step_time: Duration::ZERO,
            report: Vec::new(),
            workbench: None,
            bodies: Vec::new(),
            ghost: None,
            poses: Vec::new(),
            trails: Trails::default(),
            trailed: 0,
            undo: Undo::default(),
            twin: None,
        };
        session.begin_trails();
        session
    }

    /// Begins the trails at the present positions.
    fn begin_trails(&mut self) {
        let drawn = self.instance().camera_hint().trails;
        self.trails = if drawn == DrawnTrails::None { Trails::default() } else { Trails::of(self.world()) };
        self.trailed = self.world().step_count();
    }

    /// Extends the trails by a step; begins them again after a jump in time.
    fn extend_trails(&mut self) {
        let now = self.world().step_count();
        if now == self.trailed + 1 {
            let mut trails = core::mem::take(&mut self.trails);
            trails.go_on(self.world());
            (self.trails, self.trailed) = (trails, now);
        } else if now != self.trailed {
            self.begin_trails();
        }
    }

    /// Returns the paths of a few moving bodies.
    pub fn trails(&self) -> &Trails {
        &self.trails
    }

    /// Starts the fall of a ragdoll.
    fn on(subject: Subject, workbench: Box<Workbench>) -> Self {
        let (instance, bodies) = workbench.fall();
        let run = Run::Live(Box::new(Recorder::of(instance, &subject.title(), &[])));
        let mut session = Self { workbench: Some(workbench), bodies, ..Self::of(subject, run) };
        session.keep_pose();
        session
    }

    fn keep_pose(&mut self) {
        if self.workbench.is_some() && self.poses.len() < MOST_POSES {
            let pose = self.instance().figures().first().map(|figure| figure.world_from_joint.to_vec());
            self.poses.extend(pose);
        }
    }

    /// Writes the steps so far as a clip in a GLB.
    ///
    /// # Errors
    /// One line: there is no character, or nothing was played.
    pub fn to_glb(&self) -> Result<NamedFile, String> {
        let workbench = self.workbench.as_ref().ok_or("only characters of files can be written as GLB")?;
        let original = match &self.subject {
            Subject::File(path) if is_glb(path) => Some(read_bytes(path).map_err(|error| error.to_string())?),
            Subject::Dropped(files) if is_glb(files[0].name.as_ref()) => Some(files[0].bytes.clone()),
            _ => None,
        };
        workbench.to_glb(&self.poses, self.world().def().dt(), original.as_deref())
    }

    /// Restarts the subject: a scene with its settings, a ragdoll with its edits.
    ///
    /// # Errors
    /// The errors of [`start`](Self::start).
    pub fn restart(&mut self) -> Result<(), Error> {
        let subject = self.subject.clone();
        let mut started = match self.workbench.take() {
            Some(workbench) => Self::on(subject, workbench),
            None => Self::start(subject)?,
        };
        started.set_threads(self.threads);
        started.ghost = self.ghost.take();
        started.undo = core::mem::take(&mut self.undo).of_edits();
        let twin = self.twin.take().map(|(_, subject)| subject);
        *self = started;
        if let Some(subject) = twin {
            self.set_twin(&subject);
        }
        self.follow();
        Ok(())
    }

    /// Returns the ragdoll that can be edited, if there is one.
    pub fn workbench(&self) -> Option<&Workbench> {
        self.workbench.as_deref()
    }

    /// Returns the bodies of that ragdoll in the world, in the order of its definition.
    pub fn ragdoll(&self) -> Vec<BodyId> {
        match &self.workbench {
            Some(workbench) if workbench.has_rig() => self.instance().bodies_of_figures(),
            _ => self.bodies.clone(),
        }
    }

    /// Changes a body of the ragdoll and its joint to the parent, and lets the ragdoll fall again.
    ///
    /// # Errors
    /// One line: there is no ragdoll, or the edit is invalid; nothing changes then.
    pub fn edit(&mut self, body: usize, wish: BoneSettings) -> Result<(), String> {
        let workbench = self.workbench.as_mut().ok_or("only ragdolls of files can be edited")?;
        let before = workbench.wish(body);
        workbench.set_wish(body, wish)?;
        self.undo.edited(body, before);
        self.restart().map_err(|error| error.to_string())
    }

    /// Returns the subject of the session.
    pub fn subject(&self) -> &Subject {
        &self.subject
    }

    /// Returns the running scene.
    pub fn instance(&self) -> &Instance {
        match &self.run {
            Run::Live(recorder) => recorder.instance(),
            Run::Replay(playback) => playback.replay.instance(),
        }
    }

    /// Returns the world of the session.
    pub fn world(&self) -> &World {
        self.instance().world()
    }

    /// Returns the user's hands, with the body that they hold.
    pub fn hands(&self) -> &Hands {
        match &self.run {
            Run::Live(recorder) => recorder.hands(),
            Run::Replay(playback) => playback.replay.hands(),
        }
    }

    /// Returns the number of threads for the steps.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// Sets the number of threads for the next steps, at least 1. The bits do not depend on the number.
    pub fn set_threads(&mut self, threads: usize) {
        self.threads = threads.max(1);
        self.runner = if self.threads == 1 { Box::new(Serial) } else { Box::new(Threads::new(self.threads)) };
    }

    /// Applies an operation to the scene; ignored in a recording.
    pub fn apply(&mut self, operation: Operation) {
        if let Run::Live(recorder) = &mut self.run {
            if self.undo.begins(&operation) {
                self.undo.changed(recorder.mark());
            }
            recorder.apply(operation);
            if let Some((twin, _)) = &mut self.twin {
                twin.apply(operation.of_any_world());
            }
        }
    }

    /// Runs the scene with other settings beside the first run.
    pub fn set_twin(&mut self, subject: &Subject) {
        if let Subject::Scene(scene, settings, assignments) = subject {
            let run = Recorder::of(scene.start(settings), scene.name, assignments);
            self.twin = Some((Box::new(run), subject.clone()));
        }
    }

    /// Returns the run beside the first one.
    pub fn twin(&self) -> Option<&Instance> {
        self.twin.as_ref().map(|(twin, _)| twin.instance())
    }

    /// Returns to the moment before the last operation or edit, or with `redo` to that after it; returns false if there is
    /// none.
    ///
    /// # Errors
    /// One line: the scene cannot be restored.
    pub fn undo(&mut self, redo: bool) -> Result<bool, String> {
        let mut undo = core::mem::take(&mut self.undo);
        let done = undo.go(self, redo);
        self.undo = undo;
        done
    }

    /// Returns true if a dynamic body may fall asleep.
    pub fn may_sleep(&self) -> bool {
        let world = self.world();
        let mut moving = world.body_ids().filter(|&id| world.kind(id) == BodyKind::Dynamic);
        moving.next().is_none_or(|id| world.sleeping(id) == Sleeping::On)
    }

    /// Returns true if the session accepts operations.
    pub fn is_live(&self) -> bool {
        matches!(self.run, Run::Live(_))
    }

    /// Takes one step; returns false at the end of a recording.
    pub fn step(&mut self) -> bool {
        let start = Instant::now();
        self.times.begin_step();
        let went_on = match &mut self.run {
            Run::Live(recorder) => {
                recorder.step_with(&*self.runner, &self.times);
                if let Some((twin, _)) = &mut self.twin {
                    twin.step_with(&*self.runner, &NoProfiler);
                }
                true
            }
            Run::Replay(playback) => playback.step(&*self.runner, &self.times),
        };
        self.times.end_step();
        self.step_time = start.elapsed();
        self.keep_pose();
        self.extend_trails();
        self.follow();
        went_on
    }

    /// Returns the metrics so far; for a recording, those when the step was first played.
    pub fn metrics(&self) -> Vec<Metric> {
        match &self.run {
            Run::Live(recorder) => recorder.instance().metrics(),
            Run::Replay(playback) => playback.metrics().last().cloned().unwrap_or_default(),
        }
    }

    /// Returns the metrics of a recording up to now, after each number of steps; empty for live subjects.
    pub fn past_metrics(&self) -> &[Vec<Metric>] {
        match &self.run {
            Run::Live(_) => &[],
            Run::Replay(playback) => playback.metrics(),
        }
    }

    /// Returns the number of steps in the recording; `None` for live subjects.
    pub fn length(&self) -> Option<u64> {
        match &self.run {
            Run::Live(_) => None,
            Run::Replay(playback) => Some(playback.length()),
        }
    }

    /// Seeks to a step of a recording, in either direction, until a time limit; returns true when the step is
    /// reached.
    pub fn seek(&mut self, goal: u64, until: Instant) -> bool {
        let Run::Replay(playback) = &mut self.run else { return true };
        let arrived = playback.seek(goal, &*self.runner, until);
        self.extend_trails();
        self.follow();
        arrived
    }

    /// Moves the ghost to the step of the first run.
    fn follow(&mut self) {
        let at = self.world().step_count();
        if let Some(ghost) = &mut self.ghost {
            // The ghost is never far behind, because it follows each step.
            let until = Instant::now() + LONGEST_WAIT;
            ghost.playback.seek(at, &*self.runner, until);
        }
    }

    /// Returns the second run that is shown beside a recording.
    pub fn ghost(&self) -> Option<&Ghost> {
        self.ghost.as_deref()
    }

    /// Shows a second run of the same scene beside a recording.
    ///
    /// # Errors
    /// One line: no recording is played, or the second one is of another scene.
    pub fn set_ghost(&mut self, name: &str, recording: Recording) -> Result<(), Error> {
        let Run::Replay(playback) = &self.run else {
            return Err(Error::unsupported("a ghost needs a recording, and none is played", ""));
        };
        let ghost = Ghost::new(name.to_owned(), recording, playback.replay.recording());
        self.ghost = Some(Box::new(ghost.map_err(|error| error.with_file(name))?));
        self.follow();
        Ok(())
    }

    /// Returns the times of the stages of the last steps.
    pub fn times(&self) -> &StageTimes {
        &self.times
    }

    /// Returns the wall time of the last step.
    pub fn step_time(&self) -> Duration {
        self.step_time
    }

    /// Returns lines that describe an opened file.
    pub fn report(&self) -> &[String] {
        self.workbench.as_ref().map_or(&self.report, |workbench| workbench.report())
    }

    /// Returns the first step of a recording whose state differs from the recorded one.
    pub fn diverged(&self) -> Option<u64> {
        match &self.run {
            Run::Live(_) => None,
            Run::Replay(playback) => playback.diverged,
        }
    }

    /// Returns the recording of the run so far; `None` for subjects not created by a scene, which cannot be
    /// restarted elsewhere.
    pub fn recording(&self) -> Option<&Recording> {
        match (&self.run, &self.subject) {
            (Run::Live(recorder), Subject::Scene(..)) => Some(recorder.recording()),
            _ => None,
        }
    }
}
