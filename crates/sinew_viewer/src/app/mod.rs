//! The viewer without its window: subject, user operations, and panels.

mod actor;
mod bench;
mod browser;
mod editor;
mod help;
mod inspector;
mod keys;
mod mouse;
mod names;
mod orders;
mod probe;
mod run_all;
mod solver;
mod style;
mod timeline;
mod tour;
mod transport;
mod undo;
mod walk;

use crate::chase::Chase;
use crate::layers::Layer;
use crate::preferences::Preferences;
use crate::session::{NamedFile, Session, Subject};
use crate::stage::Stage;
use crate::view::{self, Orbit};
use actor::Pressed;
use bench::Bench;
use egui::{Rect, Vec2};
use mouse::Mouse;
pub use orders::Order;
use probe::Probe;
use sinew::math::Vec3;
use sinew_picture::Camera;
use sinew_scenes::recording::{Operation, Recording};
use sinew_scenes::scenes::Act;
use sinew_scenes::staged::Sample;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use tour::Tour;
use web_time::{Duration, Instant};

/// Longest stepping time of a frame, so that the window stays responsive in scenes slower than real time.
const MOST_STEPPING: Duration = Duration::from_millis(60);
/// Longest real time that a frame catches up, seconds.
const LONGEST_FRAME: f64 = 0.1;
/// Time for which a message is shown.
const MESSAGE: Duration = Duration::from_secs(6);
/// Number of metric values in a plot.
const HISTORY: usize = 600;

/// Start options of a viewer.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// First subject; by default the introductory demo.
    pub subject: Option<Subject>,
    /// True to start paused.
    pub paused: bool,
    /// Number of steps taken at full speed, after which the viewer pauses and shows the hash; `None` runs in real time.
    pub steps: Option<u64>,
    /// True to print each message to stderr as well.
    pub log: bool,
    /// File in which preferences are kept; `None` keeps none.
    pub preferences: Option<PathBuf>,
    /// Size of the window, points.
    pub size: Option<[f32; 2]>,
    /// A second recording of the same scene, shown beside the first.
    pub ghost: Option<PathBuf>,
    /// True to hide the list of scenes: for a small window on one scene.
    pub hides_browser: bool,
    /// True to hide all panels and messages, for a picture on a page that has its own controls.
    pub hides_panels: bool,
    /// True to hide measured times, so that pictures can be compared.
    pub hides_times: bool,
    /// File to which a picture of the window is written after the steps; then the window closes.
    pub screenshot: Option<PathBuf>,
}

/// Number of frames until panels have their final sizes.
const SETTLING: u8 = 4;

/// Least width of a window in which both panels are beside the picture, points; narrower windows fold them.
const WIDE: f32 = 860.0;
/// Least width of the picture that leaves room for all hints, points.
const ROOMY: f32 = 600.0;

/// A panel beside the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Scenes,
    Figures,
}

/// The viewer without its window.
pub struct App {
    session: Session,
    orbit: Orbit,
    running: bool,
    /// Step up to which the viewer runs at full speed.
    goal: Option<u64>,
    /// Ratio of simulated to real time.
    speed: f32,
    /// Real time that is not simulated yet, seconds.
    pending: f64,
    last_frame: Option<Instant>,
    frame_time: f32,
    /// Time between the last two frames, seconds.
    passed: f32,
    layers: Vec<Layer>,
    search: String,
    focuses_search: bool,
    /// Values of the sliders for the scene's settings.
    sliders: Vec<(&'static str, f32)>,
    /// Values of each metric so far.
    history: Vec<VecDeque<f64>>,
    message: Option<(String, Instant)>,
    shows_help: bool,
    /// True until the first user action.
    shows_hints: bool,
    mouse: Mouse,
    bench: Bench,
    /// Target step while seeking in a recording.
    seeking: Option<u64>,
    /// The following camera; `None` if the camera stands still.
    follows: Option<Chase>,
    /// Velocity of the character controlled by keys, m/s; `None` while keys move the camera.
    leads: Option<Vec3>,
    probe: Probe,
    /// Subjects with other settings, before and after this one.
    past: Vec<Subject>,
    future: Vec<Subject>,
    tour: Tour,
    /// Settings with which a second run takes place beside the next one.
    pinned: Option<Subject>,
    hides_times: bool,
    hides_browser: bool,
    hides_panels: bool,
    /// Panel that is open in a narrow window.
    unfolded: Option<Side>,
    is_narrow: bool,
    area: Rect,
    /// True after the camera was set for the actual size of the picture.
    is_framed: bool,
    /// Number of started sessions.
    starts: u64,
    log: bool,
    preferences: Option<PathBuf>,
    /// Files for the host to write.
    files: Vec<NamedFile>,
    wants_screenshot: bool,
    wants_to_close: bool,
    /// File for a picture of the window, and number of frames until then: panels find their sizes in the first frames.
    screenshot: Option<(PathBuf, u8)>,
}

impl App {
    /// Creates a viewer of the subject, or of the demo.
    ///
    /// # Errors
    /// The reason why the subject cannot start, one line.
    pub fn new(options: Options) -> Result<Self, String> {
        let preferences = options.preferences.as_deref().map(Preferences::load).unwrap_or_default();
        let shows_hints = options.subject.is_none();
        let subject = match options.subject {
            Some(subject) => subject,
            None => Subject::Sample(Sample::Mannequin),
        };
        let mut session = Session::start(subject).map_err(|error| error.to_string())?;
        if let Some(path) = &options.ghost {
            let Subject::Recording(_, recording) = Subject::file(path).map_err(|error| error.to_string())?
            else {
                return Err(format!("{}: is no recording", path.display()));
            };
            let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
            session.set_ghost(&name, *recording).map_err(|error| error.to_string())?;
        }
        session.set_threads(preferences.threads);
        let mut app = Self {
            orbit: Orbit { target: Vec3::ZERO, yaw: 0.0, pitch: 0.0, distance: 1.0 },
            session,
            running: !options.paused,
            goal: options.steps,
            speed: 1.0,
            pending: 0.0,
            last_frame: None,
            frame_time: 0.0,
            passed: 0.0,
            layers: preferences.layers,
            search: String::new(),
            focuses_search: false,
            sliders: Vec::new(),
            history: Vec::new(),
            message: None,
            shows_help: false,
            shows_hints,
            mouse: Mouse::default(),
            bench: Bench::default(),
            seeking: None,
            follows: None,
            leads: None,
            probe: Probe::default(),
            past: Vec::new(),
            future: Vec::new(),
            tour: Tour::default(),
            pinned: None,
            hides_times: options.hides_times,
            hides_browser: options.hides_browser,
            hides_panels: options.hides_panels,
            unfolded: None,
            is_narrow: false,
            area: Rect::from_min_size(Default::default(), Vec2::new(640.0, 360.0)),
            is_framed: false,
            starts: 0,
            log: options.log,
            preferences: options.preferences,
            files: Vec::new(),
            wants_screenshot: false,
            wants_to_close: false,
            screenshot: options.screenshot.map(|path| (path, SETTLING)),
        };
        app.begin();
        Ok(app)
    }

    /// Returns the session that is shown.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Returns the camera at its present position.
    pub fn camera(&self) -> Camera {
        self.orbit.camera()
    }

    /// Returns the position of the camera around its target.
    pub fn orbit(&self) -> Orbit {
        self.orbit
    }

    /// Moves the camera.
    pub fn set_orbit(&mut self, orbit: Orbit) {
        self.orbit = orbit;
    }

    /// Returns the content of the picture.
    pub fn stage(&self) -> Stage<'_> {
        let mut stage = view::stage(&self.session, &self.camera(), &self.layers);
        bench::draw(self, &mut stage);
        self.probe.draw(self.orbit.distance, &mut stage);
        stage
    }

    /// Returns the displayed message, if any.
    pub fn message(&self) -> Option<&str> {
        self.message.as_ref().map(|(line, _)| line.as_str())
    }

    /// Returns the window position, points, of a point of the world (metres); `None` behind the camera.
    pub fn on_screen(&self, point: Vec3) -> Option<egui::Pos2> {
        let camera = self.camera();
        let axes = camera.axes(self.area.width() / self.area.height());
        let way = point - camera.position;
        let depth = way.dot(axes.forward);
        let x = 0.5 + 0.5 * way.dot(axes.right) / (depth * axes.half_width);
        let y = 0.5 - 0.5 * way.dot(axes.up) / (depth * axes.half_height);
        (depth > 0.0).then(|| self.area.min + Vec2::new(x * self.area.width(), y * self.area.height()))
    }

    /// Returns the position of the subject in the picture, from the left and upper edge, as shares of the size; `None`
    /// behind the camera.
    pub fn subject_place(&self) -> Option<[f32; 2]> {
        let at = self.on_screen(view::bounds(self.session.instance()).center())? - self.area.min;
        Some([at.x / self.area.width(), at.y / self.area.height()])
    }

    /// Returns true if the camera follows its subject.
    pub fn is_following(&self) -> bool {
        self.follows.is_some()
    }

    /// Returns true if the simulation runs.
    pub fn is_running(&self) -> bool {
        self.running
    }

    /// Returns the key of the subject; each start has a new one.
    pub(crate) fn subject_key(&self) -> u64 {
        self.starts
    }

    /// Returns the part of the window that is the picture, points.
    pub fn area(&self) -> Rect {
        self.area
    }

    /// Returns true if the next frame will differ from this one even without input.
    pub fn is_moving(&self) -> bool {
        self.running
            || self.mouse.is_busy()
            || self.seeking.is_some()
            || self.screenshot.is_some()
            || self.message.is_some()
    }

    /// Returns true once if a picture of the window was requested.
    pub fn takes_screenshot(&mut self) -> bool {
        std::mem::take(&mut self.wants_screenshot)
    }

    /// Returns the file for the requested picture of the window once the steps are done; the viewer then ends.
    pub(crate) fn due_screenshot(&mut self) -> Option<PathBuf> {
        if self.goal.is_some() {
            return None;
        }
        let (path, frames) = self.screenshot.take()?;
        if frames > 0 {
            self.screenshot = Some((path, frames - 1));
            return None;
        }
        self.wants_to_close = true;
        Some(path)
    }

    /// Returns true if the viewer should close.
    pub fn is_closing(&self) -> bool {
        self.wants_to_close
    }

    /// Shows a message for some seconds.
    pub fn tell(&mut self, line: impl Into<String>) {
        let line = line.into();
        if self.log {
            eprintln!("{line}");
        }
        self.message = Some((line, Instant::now()));
    }

    /// Opens another subject from its start. If it cannot start, a message is shown.
    pub fn open(&mut self, subject: Subject) {
        let threads = self.session.threads();
        match Session::start(subject) {
            Ok(session) => {
                self.session = session;
                self.session.set_threads(threads);
                self.shows_hints = false;
                (self.past, self.future, self.pinned) = (Vec::new(), Vec::new(), None);
                self.begin();
                self.tell(format!("opened {}", self.session.subject().title()));
            }
            Err(error) => self.tell(error.to_string()),
        }
    }

    /// Opens a file dropped on the window. If it cannot be read, a message is shown.
    pub fn open_file(&mut self, path: &Path) {
        match Subject::file(path) {
            Ok(subject) => self.open_or_compare(subject),
            Err(error) => self.tell(error.to_string()),
        }
    }

    /// Opens a subject; a second recording of the same scene is shown as a ghost of the first.
    fn open_or_compare(&mut self, subject: Subject) {
        let (Subject::Recording(_, second), Subject::Recording(_, first)) =
            (&subject, self.session.subject())
        else {
            return self.open(subject);
        };
        if (&first.scene, &first.settings) != (&second.scene, &second.settings) {
            return self.open(subject);
        }
        let (title, recording) = (subject.title(), (**second).clone());
        self.compare_with(&title, recording);
    }

    /// Shows a second recording of the same scene beside the current one. If that is impossible, a message is shown.
    pub fn compare_with(&mut self, name: &str, recording: Recording) {
        let line = match self.session.set_ghost(name, recording) {
            Ok(()) => {
                let difference = self.session.ghost().and_then(|ghost| ghost.difference());
                format!("beside it {name}: {}", timeline::told(difference))
            }
            Err(error) => error.to_string(),
        };
        self.tell(line);
    }

    /// Replays the last run from its start, as a recording with a timeline.
    fn replay(&mut self) {
        let Some(recording) = self.session.recording().cloned() else {
            return self.tell("only scenes can be played again");
        };
        let orbit = self.orbit;
        let name = format!("{}-{}.sinewrec", recording.scene, recording.steps.len());
        let length = recording.steps.len() as u64;
        self.open(Subject::Recording(name.into(), Box::new(recording)));
        (self.orbit, self.is_framed, self.running) = (orbit, true, false);
        self.seek(length);
    }

    /// Seeks to a step of the recording.
    pub fn seek(&mut self, step: u64) {
        let Some(length) = self.session.length() else { return };
        self.seeking = Some(step.min(length));
        self.running = false;
        self.go_on_seeking();
    }

    fn go_on_seeking(&mut self) {
        let Some(goal) = self.seeking else { return };
        if self.session.seek(goal, Instant::now() + MOST_STEPPING) {
            self.seeking = None;
        }
        let past = self.session.past_metrics();
        let recent = &past[past.len().saturating_sub(HISTORY)..];
        let count = recent.first().map_or(0, Vec::len);
        let values = |i: usize| recent.iter().map(|it| it[i].value.unwrap_or(f64::NAN)).collect();
        self.history = (0..count).map(values).collect();
    }

    /// Opens files dropped on a page. If they cannot be read, a message is shown.
    pub fn open_dropped(&mut self, files: Vec<NamedFile>) {
        match Subject::dropped(files) {
            Ok(subject) => self.open_or_compare(subject),
            Err(error) => self.tell(error.to_string()),
        }
    }

    /// Returns the files for the host to write, once.
    pub fn take_files(&mut self) -> Vec<NamedFile> {
        std::mem::take(&mut self.files)
    }

    /// Begins a new session: its camera, sliders and plots.
    fn begin(&mut self) {
        self.begin_again();
        self.bench = Bench::default();
        self.is_framed = false;
        self.sliders = match self.session.subject() {
            Subject::Scene(scene, settings, _) => {
                let declared = scene.settings().declared().iter();
                declared.map(|setting| (setting.key, settings.get(setting.key))).collect()
            }
            _ => Vec::new(),
        };
        let is_staged = self.session.subject().is_staged();
        self.follows = is_staged.then(|| Chase::at(Vec3::ZERO));
        self.frame();
    }

    /// Restarts the session without any state of the last run.
    fn begin_again(&mut self) {
        self.starts += 1;
        self.pending = 0.0;
        self.mouse = Mouse::default();
        self.seeking = None;
        self.leads = None;
        self.history.clear();
    }

    /// Moves the camera so that it shows the whole scene.
    fn frame(&mut self) {
        let instance = self.session.instance();
        let aspect = self.area.width().max(1.0) / self.area.height().max(1.0);
        let bounds = view::with_ground(&view::bounds(instance), instance.world());
        self.orbit = Orbit::framing(&bounds, instance.camera_hint().direction, aspect);
        self.follow(self.follows.is_some());
    }

    /// Makes the camera follow the subject, or stand still.
    fn follow(&mut self, follows: bool) {
        self.follows = follows.then(|| Chase::at(view::bounds(self.session.instance()).center()));
    }

    /// Moves the camera with the subject for a time, seconds.
    pub fn go_along(&mut self, seconds: f32) {
        if let Some(chase) = &mut self.follows {
            let subject = view::bounds(self.session.instance()).center();
            self.orbit.target += chase.go(subject, seconds, self.orbit.distance);
        }
        self.orbit.rise_above(self.session.instance().world());
    }

    fn restart(&mut self) {
        if self.session.length().is_some() {
            let runs = self.running;
            self.seek(0);
            self.running = runs;
            return;
        }
        match self.session.restart() {
            Ok(()) => {
                self.begin_again();
                if self.follows.is_some() {
                    self.frame();
                }
            }
            Err(error) => self.tell(error.to_string()),
        }
    }

    /// Takes one step, even when paused.
    pub fn step(&mut self) {
        if !self.session.step() {
            self.running = false;
            let line = match self.session.diverged() {
                Some(step) => format!("end of the recording; its state differs from step {step} on"),
                None => "end of the recording; every state was as recorded".to_owned(),
            };
            self.tell(line);
        }
        let metrics = self.session.metrics();
        self.history.resize_with(metrics.len(), VecDeque::new);
        for (history, metric) in self.history.iter_mut().zip(&metrics) {
            if history.len() == HISTORY {
                history.pop_front();
            }
            history.push_back(metric.value.unwrap_or(f64::NAN));
        }
    }

    /// Takes the steps due in real time.
    pub fn advance(&mut self) {
        let now = Instant::now();
        let passed = self.last_frame.map_or(0.0, |last| (now - last).as_secs_f64());
        self.last_frame = Some(now);
        self.passed = passed as f32;
        self.frame_time += (passed as f32 - self.frame_time) * 0.1;
        if self.seeking.is_some() {
            return self.go_on_seeking();
        }
        if !self.running {
            return;
        }
        if let Some(goal) = self.goal {
            self.hurry(goal, now);
            return self.go_on_touring();
        }
        let dt = f64::from(self.session.world().def().dt());
        self.pending += passed.min(LONGEST_FRAME) * f64::from(self.speed);
        while self.running && self.pending >= dt {
            self.step();
            self.pending -= dt;
            if now.elapsed() > MOST_STEPPING {
                self.pending = 0.0;
            }
        }
    }

    /// Steps at full speed up to a goal, within the time of a frame.
    fn hurry(&mut self, goal: u64, start: Instant) {
        while self.running && self.session.world().step_count() < goal && start.elapsed() < MOST_STEPPING {
            self.step();
        }
        let world = self.session.world();
        if world.step_count() >= goal {
            let line = format!("hash {:016x} after {} steps", world.hash(), world.step_count());
            (self.goal, self.running) = (None, false);
            self.tell(line);
        }
    }

    /// Shows the panels and handles input in them and in the picture.
    pub fn ui(&mut self, ui: &mut egui::Ui) {
        style::apply(ui.ctx());
        self.keys(ui);
        self.panels(ui);
        egui::CentralPanel::no_frame().show(ui, |ui| {
            let area = ui.max_rect();
            if area != self.area {
                self.area = area;
                if !self.is_framed || self.hides_panels {
                    self.is_framed = true;
                    self.frame();
                }
            }
            mouse::act(self, ui);
            // A still picture needs no fade.
            self.go_along(if self.hides_times { f32::INFINITY } else { self.passed });
            bench::overlay(self, ui);
            let at = ui.input(|input| input.pointer.hover_pos()).filter(|at| self.area.contains(*at));
            let below = at.map(|at| (at, mouse::ray(self, at)));
            self.probe.update(below, self.session.world(), ui);
            if !self.hides_panels {
                help::overlay(self, ui);
            }
        });
        help::window(self, ui.ctx());
        if !self.hides_times && self.message.as_ref().is_some_and(|(_, since)| since.elapsed() > MESSAGE) {
            self.message = None;
        }
    }

    /// Shows the panels around the picture.
    fn panels(&mut self, ui: &mut egui::Ui) {
        self.is_narrow = ui.max_rect().width() < WIDE;
        if self.hides_panels {
            return;
        }
        let is_open = |side: Side| !self.is_narrow || self.unfolded == Some(side);
        let (scenes, figures) = (is_open(Side::Scenes) && !self.hides_browser, is_open(Side::Figures));
        if scenes {
            browser::show(self, ui);
        }
        transport::show(self, ui);
        if figures {
            inspector::show(self, ui);
        }
    }

    /// Gives an instruction to the character of the scene.
    pub fn act(&mut self, act: Act) {
        if self.session.instance().directed().is_none() || !self.session.is_live() {
            return self.tell("no character here carries out instructions");
        }
        self.session.apply(Operation::Act { act });
        (self.leads, self.running, self.shows_hints) = (None, true, false);
        self.follow(true);
        if let Some(character) = self.session.instance().directed() {
            self.tell(actor::told(act, character));
        }
    }

    /// Executes the action of a button for the character.
    fn press(&mut self, pressed: Pressed) {
        match pressed {
            Pressed::Hit => {
                self.running = true;
                mouse::push_subject(self);
            }
            Pressed::Walk => walk::toggle(self),
            Pressed::Act(act) => self.act(act),
        }
    }

    /// Switches a layer on or off.
    pub fn toggle(&mut self, layer: Layer) {
        match self.layers.iter().position(|&on| on == layer) {
            Some(place) => {
                self.layers.remove(place);
            }
            None => self.layers.push(layer),
        }
    }

    /// Stores the preferences, if the options name a file. Ignores a failed write.
    pub fn keep_preferences(&self) {
        if let Some(path) = &self.preferences {
            let kept = Preferences { layers: self.layers.clone(), threads: self.session.threads() };
            kept.save(path);
        }
    }

    /// Exports the last run as a GLB, for the host to write.
    pub fn save_glb(&mut self) {
        match self.session.to_glb() {
            Ok(file) => self.files.push(file),
            Err(line) => self.tell(line),
        }
    }

    /// Exports the recording of the scene so far, for the host to write.
    fn save_recording(&mut self) {
        let Some(recording) = self.session.recording() else { return };
        let name = format!("{}-{}.sinewrec", recording.scene, recording.steps.len());
        self.files.push(NamedFile { name, bytes: recording.to_bytes() });
    }
}
