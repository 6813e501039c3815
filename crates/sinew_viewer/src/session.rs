//! Subjects that run: a scene with hands on it, or a recording.

use crate::stage_times::StageTimes;
use sinew::anim::{Hints, analyze_hinted};
use sinew::formats::{
    Error, MotionFile, MotionOptions, ReadOptions, Textures, load_motion, read_bytes, read_motion,
    read_ragdoll, read_world,
};
use sinew::physics::{Serial, TaskRunner, Threads, World, WorldDef};
use sinew_scenes::fallen::{fall_of, fall_of_bodies};
use sinew_scenes::recording::{Hands, Operation, Recorder, Recording, Replay};
use sinew_scenes::scenes::{Instance, Scene, Settings, find};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use web_time::{Duration, Instant};

/// Subject of a session, from which it can be started anew.
#[derive(Clone, Debug)]
pub enum Subject {
    /// A named scene with its settings, and those of them that are not at their defaults, `key=value`.
    Scene(&'static Scene, Box<Settings>, Vec<String>),
    /// A file: a world, a character, a ragdoll.
    File(PathBuf),
    /// Files without a folder, as a page is given them: what [`File`](Self::File) may be, and the files beside it.
    Dropped(Arc<[NamedFile]>),
    /// A recording, and where it comes from.
    Recording(PathBuf, Box<Recording>),
}

/// A file without a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedFile {
    /// Its name, with its extension.
    pub name: String,
    /// Content.
    pub bytes: Vec<u8>,
}

impl Subject {
    /// The scene of that name, with settings `key=value`.
    ///
    /// # Errors
    /// One line: there is no such scene, or it refuses a setting.
    pub fn scene(name: &str, assignments: &[String]) -> Result<Self, String> {
        let scene = find(name).ok_or_else(|| format!("no scene '{name}'"))?;
        let mut settings = scene.settings();
        for assignment in assignments {
            settings.assign(assignment).map_err(|error| error.to_string())?;
        }
        settings.check().map_err(|error| error.to_string())?;
        Ok(Self::Scene(scene, Box::new(settings), assignments.to_vec()))
    }

    /// A file by its path, of whatever kind it is.
    ///
    /// # Errors
    /// One line that names the file.
    pub fn file(path: &Path) -> Result<Self, Error> {
        if has_extension(path, "sinewrec") {
            return Self::recording(path, &read_bytes(path)?);
        }
        Ok(Self::File(path.to_owned()))
    }

    /// Files that were dropped together. The first of a kind that can be shown by itself is shown, the others are beside it.
    ///
    /// # Errors
    /// One line that names the file.
    pub fn dropped(mut files: Vec<NamedFile>) -> Result<Self, Error> {
        let is_shown =
            |file: &NamedFile| SHOWN.iter().any(|extension| has_extension(Path::new(&file.name), extension));
        let first = files.iter().position(is_shown).unwrap_or(0);
        match files.get(first) {
            None => Err(Error::unsupported("nothing was dropped", "")),
            Some(file) if has_extension(Path::new(&file.name), "sinewrec") => {
                Self::recording(Path::new(&file.name), &file.bytes)
            }
            Some(_) => {
                files.swap(0, first);
                Ok(Self::Dropped(files.into()))
            }
        }
    }

    fn recording(path: &Path, bytes: &[u8]) -> Result<Self, Error> {
        let recording = Recording::read(bytes);
        let recording = recording.map_err(|error| error.with_file(path.display().to_string()))?;
        Ok(Self::Recording(path.to_owned(), Box::new(recording)))
    }

    /// Name to be shown.
    pub fn title(&self) -> String {
        let file_name =
            |path: &Path| path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        match self {
            Self::Scene(scene, ..) => scene.name.to_owned(),
            Self::File(path) | Self::Recording(path, _) => file_name(path),
            Self::Dropped(files) => files[0].name.clone(),
        }
    }

    /// One line on what it is about.
    pub fn about(&self) -> String {
        match self {
            Self::Scene(scene, ..) => scene.about.to_owned(),
            Self::File(path) => path.display().to_string(),
            Self::Dropped(files) => files[0].name.clone(),
            Self::Recording(_, recording) => format!(
                "recording of {} by version {}, {} steps",
                recording.scene,
                recording.made_by,
                recording.steps.len()
            ),
        }
    }
}

/// Way in which a subject runs.
enum Run {
    Live(Box<Recorder>),
    Replay(Box<Replay>),
}

/// A subject that runs.
pub struct Session {
    subject: Subject,
    run: Run,
    threads: usize,
    runner: Box<dyn TaskRunner>,
    times: StageTimes,
    /// Wall time of the last step.
    step_time: Duration,
    /// First step of a recording that came to another state than was recorded.
    diverged: Option<u64>,
    report: Vec<String>,
}

impl Session {
    /// Starts a subject.
    ///
    /// # Errors
    /// One line: a file that cannot be read, a recording of a scene that is not there.
    pub fn start(subject: Subject) -> Result<Self, Error> {
        let mut report = Vec::new();
        let run = match &subject {
            Subject::Scene(scene, settings, assignments) => {
                Run::Live(Box::new(Recorder::of(scene.start(settings), scene.name, assignments)))
            }
            Subject::File(path) => {
                let name = path.display().to_string();
                let (instance, lines) = instance_of_file(path)?;
                report = lines;
                Run::Live(Box::new(Recorder::of(instance, &name, &[])))
            }
            Subject::Dropped(files) => {
                let (instance, lines) = instance_of_dropped(files)?;
                report = lines;
                Run::Live(Box::new(Recorder::of(instance, &files[0].name, &[])))
            }
            Subject::Recording(path, recording) => {
                let replay = Replay::start((**recording).clone());
                Run::Replay(Box::new(replay.map_err(|error| error.with_file(path.display().to_string()))?))
            }
        };
        Ok(Self {
            subject,
            run,
            threads: 1,
            runner: Box::new(Serial),
            times: StageTimes::default(),
            step_time: Duration::ZERO,
            diverged: None,
            report,
        })
    }

    /// Subject that it shows.
    pub fn subject(&self) -> &Subject {
        &self.subject
    }

    /// The scene as it runs.
    pub fn instance(&self) -> &Instance {
        match &self.run {
            Run::Live(recorder) => recorder.instance(),
            Run::Replay(replay) => replay.instance(),
        }
    }

    /// Its world.
    pub fn world(&self) -> &World {
        self.instance().world()
    }

    /// Hands, and so what they hold.
    pub fn hands(&self) -> &Hands {
        match &self.run {
            Run::Live(recorder) => recorder.hands(),
            Run::Replay(replay) => replay.hands(),
        }
    }

    /// Number of threads that its steps run on.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// Runs the steps to come on so many threads, at least 1: the same bits.
    pub fn set_threads(&mut self, threads: usize) {
        self.threads = threads.max(1);
        self.runner = if self.threads == 1 { Box::new(Serial) } else { Box::new(Threads::new(self.threads)) };
    }

    /// Does something to the scene; nothing to a recording.
    pub fn apply(&mut self, operation: Operation) {
        if let Run::Live(recorder) = &mut self.run {
            recorder.apply(operation);
        }
    }

    /// True if hands reach into it.
    pub fn is_live(&self) -> bool {
        matches!(self.run, Run::Live(_))
    }

    /// One step; false at the end of a recording.
    pub fn step(&mut self) -> bool {
        let start = Instant::now();
        self.times.begin_step();
        let went_on = match &mut self.run {
            Run::Live(recorder) => {
                recorder.step_with(&*self.runner, &self.times);
                true
            }
            Run::Replay(replay) => match replay.step_with(&*self.runner, &self.times) {
                Some(step) => {
                    if step.found != step.recorded && self.diverged.is_none() {
                        self.diverged = Some(step.step);
                    }
                    true
                }
                None => false,
            },
        };
        self.times.end_step();
        self.step_time = start.elapsed();
        went_on
    }

    /// Times of the stages of the last steps.
    pub fn times(&self) -> &StageTimes {
        &self.times
    }

    /// Wall time of the last step.
    pub fn step_time(&self) -> Duration {
        self.step_time
    }

    /// Lines that tell of a file that was opened.
    pub fn report(&self) -> &[String] {
        &self.report
    }

    /// First step of a recording that came to another state than was recorded.
    pub fn diverged(&self) -> Option<u64> {
        self.diverged
    }

    /// Recording of what was done so far and what became of it; `None` of what no scene made, which cannot be started again elsewhere.
    pub fn recording(&self) -> Option<&Recording> {
        match (&self.run, &self.subject) {
            (Run::Live(recorder), Subject::Scene(..)) => Some(recorder.recording()),
            _ => None,
        }
    }
}

/// Extensions of files that are shown by themselves; others lie beside them.
const SHOWN: [&str; 7] = ["sinewrec", "json", "glb", "gltf", "vrm", "fbx", "bvh"];

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|it| it.eq_ignore_ascii_case(extension))
}

/// A world of what is in a file: its bodies, or the character in it, which falls; and lines that tell of it.
fn instance_of_file(path: &Path) -> Result<(Instance, Vec<String>), Error> {
    let name = path.display().to_string();
    if has_extension(path, "json") {
        return instance_of_json(&read_bytes(path)?).map_err(|error| error.with_file(name));
    }
    instance_of_character(load_motion(path, &motion_options())?, &name)
}

/// As [`instance_of_file`], of files without a folder.
fn instance_of_dropped(files: &[NamedFile]) -> Result<(Instance, Vec<String>), Error> {
    let [NamedFile { name, bytes }, beside @ ..] = files else {
        return Err(Error::unsupported("nothing was dropped", ""));
    };
    if has_extension(Path::new(name), "json") {
        return instance_of_json(bytes).map_err(|error| error.with_file(name.clone()));
    }
    // A page is told names without folders.
    let last = |path: &str| path.rsplit('/').next().unwrap_or(path).to_owned();
    let mut resolve = |relative: &str| {
        let found = beside.iter().find(|file| file.name == last(relative));
        let missing = || Error::io(format!("'{relative}' was not dropped with it"));
        found.map(|file| file.bytes.clone()).ok_or_else(missing)
    };
    let file = read_motion(bytes, &motion_options(), &mut resolve);
    instance_of_character(file.map_err(|error| error.with_file(name.clone()))?, name)
}

fn motion_options() -> MotionOptions<'static> {
    let gltf = ReadOptions { textures: Textures::Decode };
    MotionOptions { gltf, ..MotionOptions::default() }
}

/// A ragdoll, or a world.
fn instance_of_json(bytes: &[u8]) -> Result<(Instance, Vec<String>), Error> {
    let kind = serde_json::from_slice::<serde_json::Value>(bytes);
    if kind.is_ok_and(|value| value["sinew"] == "ragdoll") {
        let def = read_ragdoll(bytes)?;
        let about = format!("{} bodies, {} joints", def.bodies.len(), def.joints.len());
        let size = format!("{:.2} m, {:.1} kg", def.height, def.total_mass);
        return Ok((fall_of_bodies(&def), vec![about, size]));
    }
    let bodies = read_world(bytes)?;
    let mut world = World::new(WorldDef::default());
    bodies.iter().for_each(|body| {
        world.add_body(body);
    });
    Ok((Instance::of_world(world), vec![format!("{} bodies", bodies.len())]))
}

fn instance_of_character(file: MotionFile, name: &str) -> Result<(Instance, Vec<String>), Error> {
    let hints = Hints { exporter: file.generator.clone(), ..Hints::of_clips(&file.rig, &file.clips) };
    let refused = |what: String| Error::unsupported(what, "").with_file(name);
    let analysis = analyze_hinted(&file.rig, &hints).map_err(|error| refused(error.to_string()))?;
    let (joints, clips) = (file.rig.joints.len(), file.clips.len());
    let (instance, report) = fall_of(file.rig, &analysis).map_err(|error| refused(error.to_string()))?;
    let mut lines = vec![
        format!("{} bodies of {joints} joints, {clips} clips", report.bodies.len()),
        format!("{:.2} m, {:.1} kg", analysis.height, mass(&instance)),
    ];
    lines.extend(file.notes.iter().chain(&analysis.notes).chain(&report.notes).cloned());
    Ok((instance, lines))
}

fn mass(instance: &Instance) -> f32 {
    let world = instance.world();
    world.body_ids().map(|id| world.mass(id).mass).sum()
}
