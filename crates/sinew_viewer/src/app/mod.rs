//! The viewer without its window: what is shown, what hands do, the panels around it.

mod bench;
mod browser;
mod editor;
mod help;
mod inspector;
mod mouse;
mod style;
mod timeline;
mod transport;
mod walk;

use crate::layers::Layer;
use crate::preferences::Preferences;
use crate::session::{NamedFile, Session, Subject};
use crate::stage::Stage;
use crate::view::{self, Orbit};
use bench::Bench;
use egui::{Key, Rect, Vec2};
use mouse::Mouse;
use sinew::math::Vec3;
use sinew_picture::Camera;
use sinew_scenes::recording::Recording;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use web_time::{Duration, Instant};

/// Longest that a frame may step, so that the window stays awake in scenes that are slower than real time.
const MOST_STEPPING: Duration = Duration::from_millis(60);
/// Longest stretch of real time that a frame makes up for, seconds.
const LONGEST_FRAME: f64 = 0.1;
/// Time that a message is shown.
const MESSAGE: Duration = Duration::from_secs(6);
/// Values of a metric that its plot shows.
const HISTORY: usize = 600;

/// Start of a viewer.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Shown first; by default the demo of a first minute.
    pub subject: Option<Subject>,
    /// True to start without running.
    pub paused: bool,
    /// Steps that are taken as fast as it goes, after which it is paused and tells its hash; `None` runs in real time.
    pub steps: Option<u64>,
    /// True to print each message to stderr as well.
    pub log: bool,
    /// File in which choices are kept from one start to the next; `None` keeps none.
    pub preferences: Option<PathBuf>,
    /// Size of the window, points.
    pub size: Option<[f32; 2]>,
    /// A second recording of the same scene, which is shown beside the first.
    pub ghost: Option<PathBuf>,
    /// True to show no list of scenes: for a small window on one of them.
    pub hides_browser: bool,
    /// True to show no times of this machine: for pictures that are compared.
    pub hides_times: bool,
    /// File to which a picture of the window is written once the steps are taken, after which it is closed.
    pub screenshot: Option<PathBuf>,
}

/// Frames in which panels find their sizes.
const SETTLING: u8 = 4;

/// Scene of the first minute, with its settings: figures in colour walk, are hit, fall and get up. The camera goes along.
const FIRST: (&str, &str) = ("crowd", "n=6");
/// Time in which a camera that goes along makes up for two thirds of its distance, seconds: limbs that swing do not shake it.
const FOLLOWING: f32 = 0.4;

/// The viewer without its window.
pub struct App {
    session: Session,
    orbit: Orbit,
    running: bool,
    /// Step up to which it goes as fast as it can.
    goal: Option<u64>,
    /// Simulated over real time.
    speed: f32,
    /// Real time that has not been stepped yet, seconds of simulation.
    pending: f64,
    last_frame: Option<Instant>,
    frame_time: f32,
    /// Time from the last frame to this, seconds.
    passed: f32,
    layers: Vec<Layer>,
    search: String,
    focuses_search: bool,
    /// Settings of the scene as its sliders have them.
    sliders: Vec<(&'static str, f32)>,
    /// Values of each metric so far.
    history: Vec<VecDeque<f64>>,
    message: Option<(String, Instant)>,
    shows_help: bool,
    /// Seen since the start, until something is done.
    shows_hints: bool,
    mouse: Mouse,
    bench: Bench,
    /// Step of a recording to which it is on its way.
    seeking: Option<u64>,
    /// Middle of the scene when the camera last went along with it.
    follows: Option<Vec3>,
    /// Way of the character that keys lead, m/s; `None` while they move the camera.
    leads: Option<Vec3>,
    hides_times: bool,
    hides_browser: bool,
    area: Rect,
    /// True once the camera has been set for the size that the picture really has.
    is_framed: bool,
    /// Sessions that were started.
    starts: u64,
    log: bool,
    preferences: Option<PathBuf>,
    /// Files to be written by whoever shows it.
    files: Vec<NamedFile>,
    wants_screenshot: bool,
    wants_to_close: bool,
    /// File for a picture of the window, and frames until it is taken: panels find their sizes in the first ones.
    screenshot: Option<(PathBuf, u8)>,
}

impl App {
    /// A viewer of the subject, or of the demo.
    ///
    /// # Errors
    /// One line: the subject cannot be started.
    pub fn new(options: Options) -> Result<Self, String> {
        let preferences = options.preferences.as_deref().map(Preferences::load).unwrap_or_default();
        let shows_hints = options.subject.is_none();
        let subject = match options.subject {
            Some(subject) => subject,
            None => Subject::scene(FIRST.0, &[FIRST.1.to_owned()])?,
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
            hides_times: options.hides_times,
            hides_browser: options.hides_browser,
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
        app.follows = shows_hints.then(|| view::bounds(app.session.instance()).center());
        Ok(app)
    }

    /// Session that is shown.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Camera as it stands.
    pub fn camera(&self) -> Camera {
        self.orbit.camera()
    }

    /// Camera as it turns around a point.
    pub fn orbit(&self) -> Orbit {
        self.orbit
    }

    /// Moves the camera.
    pub fn set_orbit(&mut self, orbit: Orbit) {
        self.orbit = orbit;
    }

    /// Content of the picture.
    pub fn stage(&self) -> Stage<'_> {
        let mut stage = view::stage(&self.session, &self.camera(), &self.layers);
        bench::draw(self, &mut stage);
        stage
    }

    /// The line that is shown, if there is one.
    pub fn message(&self) -> Option<&str> {
        self.message.as_ref().map(|(line, _)| line.as_str())
    }

    /// Place in the window, points, at which a point of the world (metres) is seen; `None` behind the eye.
    pub fn on_screen(&self, point: Vec3) -> Option<egui::Pos2> {
        let camera = self.camera();
        let axes = camera.axes(self.area.width() / self.area.height());
        let way = point - camera.position;
        let depth = way.dot(axes.forward);
        let x = 0.5 + 0.5 * way.dot(axes.right) / (depth * axes.half_width);
        let y = 0.5 - 0.5 * way.dot(axes.up) / (depth * axes.half_height);
        (depth > 0.0).then(|| self.area.min + Vec2::new(x * self.area.width(), y * self.area.height()))
    }

    /// Key of what is shown: another one for each start.
    pub(crate) fn subject_key(&self) -> u64 {
        self.starts
    }

    /// Part of the window that is the picture, points.
    pub fn area(&self) -> Rect {
        self.area
    }

    /// True if the next frame differs from this one by itself.
    pub fn is_moving(&self) -> bool {
        self.running
            || self.mouse.is_busy()
            || self.seeking.is_some()
            || self.screenshot.is_some()
            || self.message.is_some()
    }

    /// True once, if a picture of the window was asked for.
    pub fn takes_screenshot(&mut self) -> bool {
        std::mem::take(&mut self.wants_screenshot)
    }

    /// File for a picture of the window, once what it was asked for is shown; then it is to end.
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

    /// True if it is to end.
    pub fn is_closing(&self) -> bool {
        self.wants_to_close
    }

    /// Shows a line for a while.
    pub fn tell(&mut self, line: impl Into<String>) {
        let line = line.into();
        if self.log {
            eprintln!("{line}");
        }
        self.message = Some((line, Instant::now()));
    }

    /// Shows another subject, from its start. What cannot be started is a message.
    pub fn open(&mut self, subject: Subject) {
        let threads = self.session.threads();
        match Session::start(subject) {
            Ok(session) => {
                self.session = session;
                self.session.set_threads(threads);
                self.shows_hints = false;
                self.begin();
                self.tell(format!("opened {}", self.session.subject().title()));
            }
            Err(error) => self.tell(error.to_string()),
        }
    }

    /// Shows a file that was dropped on the window. What cannot be read is a message.
    pub fn open_file(&mut self, path: &Path) {
        match Subject::file(path) {
            Ok(subject) => self.open_or_compare(subject),
            Err(error) => self.tell(error.to_string()),
        }
    }

    /// Shows a subject; a second recording of the scene that is played goes along with the first as its ghost.
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

    /// Shows a second recording of the same scene beside the one that is played. What cannot be is a message.
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

    /// Plays what was just done from its start, as a recording that can be scrubbed.
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

    /// Goes to a step of the recording that is played.
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

    /// Shows files that were dropped on a page. What cannot be read is a message.
    pub fn open_dropped(&mut self, files: Vec<NamedFile>) {
        match Subject::dropped(files) {
            Ok(subject) => self.open_or_compare(subject),
            Err(error) => self.tell(error.to_string()),
        }
    }

    /// Files to be kept for the person in front of it, once.
    pub fn take_files(&mut self) -> Vec<NamedFile> {
        std::mem::take(&mut self.files)
    }

    /// Begins with a new session: its camera, its sliders, its plots.
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
        self.frame();
    }

    /// Begins anew with the same: nothing of its last run is left.
    fn begin_again(&mut self) {
        self.starts += 1;
        self.pending = 0.0;
        self.mouse = Mouse::default();
        self.seeking = None;
        self.leads = None;
        self.history.clear();
    }

    /// Turns the camera to all that the scene is about.
    fn frame(&mut self) {
        let instance = self.session.instance();
        let aspect = self.area.width().max(1.0) / self.area.height().max(1.0);
        let bounds = view::with_ground(&view::bounds(instance), instance.world());
        self.orbit = Orbit::framing(&bounds, instance.camera_hint().direction, aspect);
    }

    fn restart(&mut self) {
        if self.session.length().is_some() {
            let runs = self.running;
            self.seek(0);
            self.running = runs;
            return;
        }
        match self.session.restart() {
            Ok(()) => self.begin_again(),
            Err(error) => self.tell(error.to_string()),
        }
    }

    /// One step, whether it runs or not.
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

    /// Steps as much as real time has gone on.
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
            return self.hurry(goal, now);
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

    /// Steps as fast as it goes, up to a step, for as long as a frame may take.
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

    /// The panels, and what is done in them and in the picture between.
    pub fn ui(&mut self, ui: &mut egui::Ui) {
        style::apply(ui.ctx());
        self.keys(ui);
        if !self.hides_browser {
            browser::show(self, ui);
        }
        transport::show(self, ui);
        inspector::show(self, ui);
        egui::CentralPanel::no_frame().show(ui, |ui| {
            let area = ui.max_rect();
            if area != self.area {
                self.area = area;
                if !self.is_framed {
                    self.is_framed = true;
                    self.frame();
                }
            }
            if let Some(before) = self.follows {
                let goal = view::bounds(self.session.instance()).center();
                // A picture of a moment has no time to come after.
                let share = if self.hides_times { 1.0 } else { self.passed / (self.passed + FOLLOWING) };
                let now = before + (goal - before) * share;
                self.orbit.target += now - before;
                self.follows = Some(now);
            }
            mouse::act(self, ui);
            self.orbit.rise_above(self.session.instance().world());
            bench::overlay(self, ui);
            help::overlay(self, ui);
        });
        help::window(self, ui.ctx());
        if !self.hides_times && self.message.as_ref().is_some_and(|(_, since)| since.elapsed() > MESSAGE) {
            self.message = None;
        }
    }

    fn keys(&mut self, ui: &egui::Ui) {
        let ctx = ui.ctx();
        if ctx.egui_wants_keyboard_input() {
            return;
        }
        let pressed = |key: Key| ctx.input(|input| input.key_pressed(key));
        let typed = |text: &str| {
            ctx.input(|input| {
                input.events.iter().any(|event| matches!(event, egui::Event::Text(it) if it == text))
            })
        };
        if pressed(Key::Space) {
            self.running = !self.running;
        }
        if pressed(Key::N) || typed(".") {
            self.running = false;
            self.step();
        }
        if pressed(Key::R) {
            self.restart();
        }
        self.bench_keys(ctx);
        if pressed(Key::F) {
            self.frame();
        }
        if pressed(Key::G) {
            walk::toggle(self);
        }
        if pressed(Key::C) {
            self.follows = self.follows.is_none().then(|| view::bounds(self.session.instance()).center());
            self.tell(if self.follows.is_some() { "the camera goes along" } else { "the camera stays" });
        }
        if pressed(Key::B) {
            mouse::throw(self, ui);
        }
        if pressed(Key::P) || pressed(Key::F12) {
            self.wants_screenshot = true;
        }
        if typed("?") || pressed(Key::F1) {
            self.shows_help = !self.shows_help;
        }
        if typed("/") {
            self.focuses_search = true;
        }
        if pressed(Key::Escape) {
            self.shows_help = false;
            self.shows_hints = false;
        }
        use Key::{H, Num0, Num1, Num2, Num3, Num4, Num5, Num6, Num7, Num8, Num9};
        let keys = [Num1, Num2, Num3, Num4, Num5, Num6, Num7, Num8, Num9, Num0, H];
        for (key, layer) in keys.into_iter().zip(Layer::ALL) {
            if pressed(key) {
                self.toggle(layer);
            }
        }
        self.fly(ctx);
    }

    /// Keys that change a ragdoll, or go through a recording.
    fn bench_keys(&mut self, ctx: &egui::Context) {
        let pressed = |key: Key| ctx.input(|input| input.key_pressed(key));
        // Ctrl may be up again at the end of a slow frame, so what counts is the event.
        let is_save = |event: &egui::Event| matches!(event, egui::Event::Key { key: Key::S, pressed: true, modifiers, .. } if modifiers.command);
        let saves = |input: &egui::InputState| input.events.iter().any(is_save);
        if ctx.input(saves) {
            bench::save(self);
        }
        for (key, by) in [(Key::OpenBracket, -1), (Key::CloseBracket, 1)] {
            if pressed(key) {
                bench::choose_next(self, by);
            }
        }
        for (key, sign) in [(Key::Minus, -1.0), (Key::Equals, 1.0), (Key::Plus, 1.0)] {
            if pressed(key) {
                bench::widen(self, sign);
            }
        }
        let at = self.session.world().step_count();
        for (key, step) in [
            (Key::ArrowLeft, at.saturating_sub(1)),
            (Key::ArrowRight, at + 1),
            (Key::Home, 0),
            (Key::End, u64::MAX),
        ] {
            if pressed(key) {
                self.seek(step);
            }
        }
    }

    /// Moves the camera while keys are held.
    fn fly(&mut self, ctx: &egui::Context) {
        let (seconds, fast) = ctx.input(|input| (input.stable_dt.min(0.1), input.modifiers.shift));
        if ctx.input(|input| input.modifiers.command) {
            return;
        }
        let held = |key: Key| ctx.input(|input| f32::from(u8::from(input.key_down(key))));
        if self.leads.is_some() {
            return walk::lead(self, held(Key::D) - held(Key::A), held(Key::W) - held(Key::S), fast);
        }
        let way =
            Vec3::new(held(Key::D) - held(Key::A), held(Key::E) - held(Key::Q), held(Key::W) - held(Key::S));
        if way != Vec3::ZERO {
            self.orbit.shift(way * (seconds * if fast { 2.4 } else { 0.8 }));
            ctx.request_repaint();
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

    /// Keeps the choices for the next start, if they are to be kept. What cannot be written is no fault worth a line.
    pub fn keep_preferences(&self) {
        if let Some(path) = &self.preferences {
            let kept = Preferences { layers: self.layers.clone(), threads: self.session.threads() };
            kept.save(path);
        }
    }

    /// Hands out what was just played as a GLB, to be written.
    pub fn save_glb(&mut self) {
        match self.session.to_glb() {
            Ok(file) => self.files.push(file),
            Err(line) => self.tell(line),
        }
    }

    /// Hands out the recording of the scene so far, to be written.
    fn save_recording(&mut self) {
        let Some(recording) = self.session.recording() else {
            return self.tell("only scenes can be recorded");
        };
        let name = format!("{}-{}.sinewrec", recording.scene, recording.steps.len());
        self.files.push(NamedFile { name, bytes: recording.to_bytes() });
    }
}
