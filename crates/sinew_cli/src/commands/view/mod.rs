//! `sinew view`: opens a window on a scene, or draws a scene, a world file, or a character or motion file as a picture
//! or a movie.

mod reel;
mod window;

use crate::commands::clip_choice::find_clip;
use crate::failure::{Failure, Result};
use crate::input::files::{Outputs, never_over};
use crate::input::motion::Motion;
use crate::input::picture_file::{PictureFile, length, longest, seconds};
use crate::input::scene_choice::choose;
use crate::render::show::Show;
use crate::report::table::shown;
use crate::report::{Report, number};
use reel::Reel;
use serde_json::json;
use sinew::formats::{MotionOptions, ReadOptions, Textures, load_world};
use sinew::physics::{BodyDef, World, WorldDef};
use sinew_picture::{EncodeError, RenderSettings};
use sinew_scenes::scenes::{Instance, Scene, Settings, find};
use std::path::{Path, PathBuf};

/// Duration of the movie of a world file, and time of its still picture, seconds: long enough for objects to fall.
const WORLD_SECONDS: f32 = 3.0;

/// Open a window on scenes, or draw a scene, a world file, or a character or motion file as a picture or a movie
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("still").args(["picture", "screenshot"]).multiple(true))]
#[command(after_help = "\
Example:
  sinew view
  sinew view stairs
  sinew view ragdoll_drop --screenshot window.png --at 0.5
  sinew view pendulum --picture pendulum.png --at 1.5
  sinew view stairs --movie stairs.gif --set impulse=50
  sinew view character.glb --clip Walk --movie walk.gif
  sinew view walk.bvh --picture walk.png
  sinew view house.json --picture house.png --at 0 --width 1280 --height 720

Without --picture and --movie a window opens; ? in it shows all keys. Pictures need no driver: \
the same command draws the same bytes on every machine.")]
pub struct View {
    /// Name of a scene ('sinew scenes' lists them), a world file (.json), a recording (.sinewrec, in a window), or a
    /// file with a skeleton, a skin or a clip (GLB, glTF, VRM, VRMA, BVH, FBX, DeepMimic)
    subject: Option<String>,
    /// The clip of a file, by name or words of it, or by number from 0; by default its first, in a file without clips
    /// the rest pose
    #[arg(long, value_name = "NAME")]
    clip: Option<String>,
    /// Draw one picture: a .png, .gif or .webp file
    #[arg(long, value_name = "OUT.(png|gif|webp)")]
    picture: Option<PictureFile>,
    /// Time of the picture, seconds from the start; by default the scene's end, or the middle of a clip
    #[arg(long, value_name = "T", requires = "still", value_parser = seconds)]
    at: Option<f32>,
    /// Draw all of it at 20 pictures per second: a .gif, .png (animated) or .webp file
    #[arg(long, value_name = "OUT.(gif|png|webp)")]
    movie: Option<PictureFile>,
    /// Length of the movie, seconds; by default the scene's, or the clip's
    #[arg(long, value_name = "S", requires = "movie", value_parser = length)]
    seconds: Option<f32>,
    /// Change a setting of the scene; repeatable
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// Start the window paused
    #[arg(long, conflicts_with_all = ["picture", "movie"])]
    paused: bool,
    /// A second recording of the same scene, shown in the window next to the first
    #[arg(long, value_name = "OTHER.sinewrec", conflicts_with_all = ["picture", "movie"])]
    ghost: Option<PathBuf>,
    /// Open the window, write a picture of it with its panels (after --at seconds of a scene), and close it
    #[arg(long, value_name = "OUT.png", conflicts_with_all = ["picture", "movie"])]
    screenshot: Option<PathBuf>,
    /// Write the window's messages to stderr as well
    #[arg(long, conflicts_with_all = ["picture", "movie"])]
    log: bool,
    /// Width, pixels
    #[arg(long, value_name = "N", default_value_t = 640, value_parser = clap::value_parser!(u16).range(16..=4096))]
    width: u16,
    /// Height, pixels
    #[arg(long, value_name = "N", default_value_t = 360, value_parser = clap::value_parser!(u16).range(16..=4096))]
    height: u16,
}

impl View {
    /// Runs the command: simulates, draws the picture and writes the output.
    pub fn run(&self) -> Result<Report> {
        if self.outputs().next().is_none() {
            return self.open();
        }
        let Some(name) = self.subject.as_deref() else {
            return Err(Failure::Usage("nothing to draw: name a scene or a file".into()));
        };
        if is_motion(name) {
            return self.show(Path::new(name));
        }
        if self.clip.is_some() {
            return Err(Failure::Usage("--clip is for files with clips: a scene or a world has none".into()));
        }
        let subject = Subject::find(name, &self.settings)?;
        let ends = subject.seconds();
        let reel = Reel { title: subject.title(), ends, settings: self.render_settings() };
        let (at, seconds) = (self.at.unwrap_or(ends), self.seconds.unwrap_or(ends));
        let mut outputs = Outputs::default();
        if let Some(file) = &self.picture {
            outputs.add(file.path(), reel.picture(&subject, at, file.format).map_err(failed(file))?);
        }
        if let Some(file) = &self.movie {
            outputs.add(file.path(), reel.movie(&subject, seconds, file.format).map_err(failed(file))?);
        }
        outputs.write()?;
        Ok(self.report(reel.title, None, at, seconds))
    }

    /// Draws a file with a skeleton, a skin or a clip.
    fn show(&self, path: &Path) -> Result<Report> {
        if !self.settings.is_empty() {
            return Err(Failure::Usage("--set is for scenes; a file has none".into()));
        }
        never_over([path], self.outputs().map(PictureFile::path))?;
        let gltf = ReadOptions { textures: Textures::Decode };
        let motion = Motion::load(path, &MotionOptions { gltf, ..MotionOptions::default() })?;
        let name = motion.name.clone();
        let clips = &motion.file.clips;
        let clip = match &self.clip {
            Some(wanted) => {
                Some(find_clip(clips, wanted).map_err(|what| Failure::at(&name, what, "--clip"))?)
            }
            None => (!clips.is_empty()).then_some(0),
        };
        let called = clip.map(|clip| clips[clip].name.clone());
        let show = Show::new(motion, clip)?;
        let settings = self.render_settings();
        let (at, seconds) =
            (self.at.unwrap_or(0.5 * show.seconds()), self.seconds.unwrap_or(longest(show.seconds())));
        let mut outputs = Outputs::default();
        if let Some(file) = &self.picture {
            outputs.add(file.path(), show.picture(at, settings, file.format).map_err(failed(file))?);
        }
        if let Some(file) = &self.movie {
            outputs.add(file.path(), show.movie(seconds, settings, file.format).map_err(failed(file))?);
        }
        outputs.write()?;
        Ok(self.report(&name, called.as_deref(), at, seconds))
    }

    fn outputs(&self) -> impl Iterator<Item = &PictureFile> {
        self.picture.iter().chain(&self.movie)
    }

    fn render_settings(&self) -> RenderSettings {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let (width, height) = (u32::from(self.width), u32::from(self.height));
        RenderSettings { width, height, threads, ..RenderSettings::default() }
    }

    fn report(&self, subject: &str, clip: Option<&str>, at: f32, seconds: f32) -> Report {
        let paths: Vec<String> = self.outputs().map(|file| file.path().display().to_string()).collect();
        let at = self.picture.as_ref().map(|_| number(at));
        let seconds = self.movie.as_ref().map(|_| number(seconds));
        let wrote: String = paths.iter().map(|path| format!("wrote {path}\n")).collect();
        let text = format!("{}\n{wrote}", shown(subject));
        let json =
            json!({"subject": subject, "clip": clip, "at_s": at, "seconds": seconds, "outputs": paths});
        Report { json, text }
    }
}

/// Returns true if a subject is a file of a character or a motion: no scene, world or recording.
fn is_motion(name: &str) -> bool {
    const OTHERS: [&str; 2] = ["json", "sinewrec"];
    let extension = Path::new(name).extension().and_then(|extension| extension.to_str());
    let is_other = extension.is_some_and(|it| OTHERS.iter().any(|other| it.eq_ignore_ascii_case(other)));
    find(name).is_none() && extension.is_some() && !is_other
}

fn failed(file: &PictureFile) -> impl Fn(EncodeError) -> Failure {
    |error| Failure::of_file(file.path().display().to_string(), error)
}

/// Subject of a picture.
pub enum Subject<'a> {
    /// A named scene with its settings.
    Scene(&'static Scene, Box<Settings>),
    /// The bodies of a world file.
    World(&'a str, Vec<BodyDef>),
}

impl<'a> Subject<'a> {
    fn find(name: &'a str, assignments: &[String]) -> Result<Self> {
        if find(name).is_none() {
            match Path::new(name).extension().and_then(|extension| extension.to_str()) {
                Some("json") if assignments.is_empty() => {
                    return Ok(Self::World(name, load_world(name)?));
                }
                Some("json") => {
                    return Err(Failure::Usage("--set is for scenes; a world file has none".into()));
                }
                Some("sinewrec") => {
                    let line =
                        format!("a recording is shown in a window, or played by 'sinew replay': {name}");
                    return Err(Failure::Usage(line));
                }
                _ => {}
            }
        }
        let (scene, settings) = choose(name, assignments)?;
        Ok(Self::Scene(scene, Box::new(settings)))
    }

    /// Returns a fresh instance of the subject.
    pub fn start(&self) -> Instance {
        match self {
            Self::Scene(scene, settings) => scene.start(settings),
            Self::World(_, bodies) => {
                let mut world = World::new(WorldDef::default());
                for body in bodies {
                    world.add_body(body);
                }
                Instance::of_world(world)
            }
        }
    }

    fn title(&self) -> &str {
        match self {
            Self::Scene(scene, _) => scene.name,
            Self::World(file, _) => file,
        }
    }

    /// Returns the duration of the scene, seconds.
    fn seconds(&self) -> f32 {
        match self {
            Self::Scene(scene, settings) => scene.steps as f32 * scene.start(settings).world().def().dt(),
            Self::World(..) => WORLD_SECONDS,
        }
    }
}
