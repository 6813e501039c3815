//! `sinew convert`: converts clips between formats, or retargets them to another character.

use crate::commands::clip_choice::{choose_clips, few};
use crate::failure::{Failure, Result};
use crate::input::files::{CharacterFile, Outputs, WeightSource, must_end_in, never_over};
use crate::input::motion::Motion;
use crate::input::onto::{Carried, carry};
use crate::input::picture_file::{PictureFile, longest, rate};
use crate::input::settings_arg::unit;
use crate::input::skeleton::{bones_only, frame_rate, lost_meshes, transform};
use crate::input::source::{load_gltf, name};
use crate::render::bones::add_bone_models;
use crate::render::show::Show;
use crate::report::Report;
use crate::report::table::shown;
use clap::ValueEnum;
use serde_json::json;
use sinew::CharacterSource;
use sinew::anim::retarget::{Feet, Pace, RetargetOptions};
use sinew::anim::{Clip, ClipEvent, Rig, RigAnalysis, Take, rest_pose};
use sinew::formats::bvh::{BvhRows, BvhUnit, RestFrame};
use sinew::formats::{
    BvhEnds, BvhOptions, BvhWriteOptions, MotionFormat, MotionOptions, NewClip, ReadOptions, Textures,
    append_clips, events_extras, events_path, no_files, read_motion, write_bvh, write_events, write_motion,
};
use sinew::math::{EulerOrder, Rotation, Vec3};
use sinew_picture::RenderSettings;
use std::path::{Path, PathBuf};

/// Convert clips between BVH, FBX and GLB, or put them on another character
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew convert walk.bvh walk.glb
  sinew convert character.glb --clip Walk walk.bvh
  sinew convert character.fbx character.glb
  sinew convert walk.bvh --onto character.glb walking.glb \\
      --picture walking.gif

Reads glTF, GLB, VRM, VRMA, BVH, DeepMimic and FBX; writes GLB and BVH, by the name of OUT. What the new format cannot hold \
is reported in a line each.")]
pub struct Convert {
    /// The file to read
    input: PathBuf,
    /// The file to write: .glb or .bvh
    #[arg(value_name = "OUT", required_unless_present = "output_option", conflicts_with = "output_option")]
    output: Option<PathBuf>,
    /// The same as OUT
    #[arg(short = 'o', long = "output", value_name = "OUT")]
    output_option: Option<PathBuf>,
    /// Also draw the first clip that is written: a .gif, .png (animated) or .webp file
    #[arg(long, value_name = "OUT.(gif|png|webp)")]
    picture: Option<PictureFile>,
    /// Only this clip, by name, or by number from 0 if it has none; repeatable. A BVH holds one
    #[arg(long = "clip", value_name = "NAME")]
    clips: Vec<String>,
    /// Put the clips on this character (GLB, glTF, VRM or FBX): matched by joint names if the skeletons are the same,
    /// else by the joints' roles, without sliding feet
    #[arg(long, value_name = "CHARACTER")]
    onto: Option<PathBuf>,
    /// Frames per second of resampled motion; by default the file's
    #[arg(long, value_name = "N", value_parser = rate)]
    fps: Option<f32>,
    /// Length of one unit of a BVH that is written: m, dm, cm, mm, in, ft, or metres as a number
    #[arg(long, value_name = "UNIT", default_value = "cm", value_parser = unit, allow_negative_numbers = true)]
    unit: f32,
    /// Length of one unit of a BVH input, likewise; by default inferred from the skeleton's size
    #[arg(long, value_name = "UNIT", value_parser = unit, allow_negative_numbers = true)]
    unit_in: Option<f32>,
    /// Axis that points up in a BVH that is written
    #[arg(long, value_name = "AXIS", default_value = "y")]
    up: UpAxis,
    /// Order of the rotations in a BVH that is written
    #[arg(long, value_name = "ORDER", default_value = "zyx")]
    order: Order,
    /// Start a BVH output with a frame of the rest pose, as retargeting tools expect it
    #[arg(long)]
    rest_frame: bool,
    /// Keep the rest pose that some captures start with as a frame of the clip
    #[arg(long)]
    keep_rest_frame: bool,
    /// Accept a BVH whose row count differs from its declaration
    #[arg(long)]
    any_rows: bool,
    /// Do not draw bones for a skeleton that has no mesh
    #[arg(long)]
    bare: bool,
    /// With --onto: duration of a larger body's motion
    #[arg(long, value_name = "PACE", default_value = "same")]
    pace: PaceArg,
    /// With --onto: do not correct the feet
    #[arg(long)]
    free_feet: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum UpAxis {
    Y,
    Z,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Order {
    Xyz,
    Xzy,
    Yxz,
    Yzx,
    Zxy,
    Zyx,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum PaceArg {
    /// The file's duration
    Same,
    /// Scaled by the root of the ratio of leg lengths (Froude's law): large bodies move slowly
    Froude,
}

/// Format of OUT.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Target {
    Glb,
    Bvh,
}

/// Content of the new file.
struct Content {
    rig: Rig,
    clips: Vec<Clip>,
    events: Vec<Vec<ClipEvent>>,
    /// Frames per second, if the source has a rate.
    rate: Option<f64>,
    /// Notes on losses and assumptions, one sentence each.
    notes: Vec<String>,
}

impl Convert {
    /// Runs the command: reads the clips, converts them and writes the output.
    pub fn run(&self) -> Result<Report> {
        let target = self.target()?;
        let inputs = [&self.input].into_iter().chain(&self.onto).map(PathBuf::as_path);
        never_over(inputs, self.picture.iter().map(PictureFile::path).chain([self.output()]))?;
        let mut motion = Motion::load(&self.input, &self.motion_options())?;
        let chosen = choose_clips(&motion, &self.clips)?;
        let source = &mut motion.file;
        source.clips = chosen.iter().map(|&index| source.clips[index].clone()).collect();
        source.events = chosen.iter().map(|&index| source.events[index].clone()).collect();
        if target == Target::Bvh && source.clips.len() != 1 {
            return Err(self.not_one_clip(&motion));
        }
        let mut outputs = Outputs::default();
        let (clips, notes) = match (&self.onto, target) {
            (Some(character), _) => self.onto(&motion, character, target, &mut outputs)?,
            (None, Target::Glb) => self.to_glb(motion, &mut outputs)?,
            (None, Target::Bvh) => {
                let Motion { name, file, analysis } = motion;
                let rate = file.frame_time.map(|frame_time| 1.0 / frame_time);
                let content = Content {
                    rig: file.rig,
                    clips: file.clips,
                    events: file.events,
                    rate,
                    notes: file.notes,
                };
                self.to_bvh(&name, content, analysis.as_ref(), &mut outputs)?
            }
        };
        if let Some(picture) = &self.picture {
            let bytes = draw(&outputs, clips.len(), picture)?;
            outputs.add(picture.path(), bytes);
        }
        outputs.write()?;
        Ok(self.report(&clips, &notes, &outputs))
    }

    fn output(&self) -> &Path {
        let given = self.output.as_ref().or(self.output_option.as_ref());
        given.map_or(Path::new(""), PathBuf::as_path)
    }

    fn target(&self) -> Result<Target> {
        must_end_in(self.output(), &["glb", "bvh"])?;
        let is_bvh = self.output().extension().is_some_and(|it| it.eq_ignore_ascii_case("bvh"));
        Ok(if is_bvh { Target::Bvh } else { Target::Glb })
    }

    fn motion_options(&self) -> MotionOptions<'static> {
        let bvh = BvhOptions {
            unit: self.unit_in.map_or(BvhUnit::default(), BvhUnit::Metres),
            rest_frame: if self.keep_rest_frame { RestFrame::Keep } else { RestFrame::default() },
            rows: if self.any_rows { BvhRows::AsPresent } else { BvhRows::default() },
        };
        MotionOptions { bvh, ..MotionOptions::default() }
    }

    fn not_one_clip(&self, motion: &Motion) -> Failure {
        let count = motion.file.clips.len();
        let what = match count {
            0 => "there is no clip to write".to_owned(),
            _ => {
                let names: Vec<String> = motion.file.clips.iter().map(|clip| shown(&clip.name)).collect();
                let names = few(&names);
                format!(
                    "there are {count} clips, of which a BVH holds one: choose it with --clip NAME, {names}"
                )
            }
        };
        Failure::at(&motion.name, what, "--clip")
    }

    /// Puts the clips on another character: in a copy of its file, or on its skeleton as a BVH.
    fn onto(&self, motion: &Motion, character: &Path, target: Target, outputs: &mut Outputs) -> Result<Told> {
        let CharacterFile { name, source: CharacterSource { document, analysis, .. } } =
            CharacterFile::load(character, Textures::Skip, WeightSource::File)?;
        let rate = self.fps.map_or_else(
            || motion.file.frame_time.map_or(60.0, |frame_time| (1.0 / frame_time).min(60.0)),
            f64::from,
        );
        let options = RetargetOptions {
            frame_time: 1.0 / rate,
            pace: if self.pace == PaceArg::Froude { Pace::Froude } else { Pace::Actor },
            feet: if self.free_feet { Feet::Free } else { Feet::Locked },
            floor: None,
        };
        let carried = carry(motion, &document.rig, Some(&analysis), &options)?;
        if carried.is_empty() {
            return Err(Failure::of_file(&motion.name, "there is no clip to retarget"));
        }
        let lines: Vec<String> = carried.iter().map(Carried::to_text).collect();
        let mut notes = motion.file.notes.clone();
        notes.extend(document.warnings.iter().cloned());
        let clips = carried.iter().map(|one| one.clip.clone()).collect();
        let events: Vec<Vec<ClipEvent>> = carried.into_iter().map(|one| one.events).collect();
        if target == Target::Bvh {
            let content = Content { rig: document.rig, clips, events, rate: Some(rate), notes };
            let (_, notes) = self.to_bvh(&name, content, Some(&analysis), outputs)?;
            return Ok((lines, notes));
        }
        let new = clips.iter().zip(&events);
        let new = new.map(|(clip, events)| NewClip { clip, name: &clip.name, extras: events_extras(events) });
        let bytes =
            append_clips(&document, &new.collect::<Vec<_>>()).map_err(|error| error.with_file(&name))?;
        outputs.add(self.output(), bytes);
        Ok((lines, notes))
    }

    fn to_glb(&self, motion: Motion, outputs: &mut Outputs) -> Result<Told> {
        let Motion { name, mut file, analysis } = motion;
        let lines = file.clips.iter().map(line_of).collect();
        if matches!(file.format, MotionFormat::Glb | MotionFormat::Gltf) {
            if !self.clips.is_empty() {
                let what = "--clip does not apply from glTF to GLB: all of the file is kept as it is";
                return Err(Failure::Usage(what.into()));
            }
            let document = load_gltf(&self.input, ReadOptions::default())?;
            outputs.add(self.output(), append_clips(&document, &[]).map_err(|error| error.with_file(name))?);
            return Ok((lines, file.notes));
        }
        let still: Vec<String> =
            file.clips.iter().filter(|clip| clip.channels.is_empty()).map(|clip| shown(&clip.name)).collect();
        if !still.is_empty() {
            file.notes.push(format!("left out: {}, in which nothing moves", still.join(", ")));
        }
        if let Some(fps) = self.fps {
            let resample = |clip: &Clip| sampled(&file.rig, clip, f64::from(fps), &name);
            file.clips = file.clips.iter().map(resample).collect::<Result<_>>()?;
        }
        let moving =
            |(clip, events): (Clip, Vec<ClipEvent>)| (!clip.channels.is_empty()).then_some((clip, events));
        let (clips, events): (Vec<_>, Vec<_>) =
            file.clips.into_iter().zip(file.events).filter_map(moving).unzip();
        if !self.bare && file.rig.meshes.is_empty() {
            add_bone_models(&mut file.rig, analysis.as_ref());
            file.notes.push("there is no mesh: bones are drawn (--bare leaves them out)".into());
        }
        let bytes = write_motion(&file.rig, &clips, &events).map_err(|error| error.with_file(&name))?;
        outputs.add(self.output(), bytes);
        Ok((lines, file.notes))
    }

    fn to_bvh(
        &self,
        name: &str,
        content: Content,
        analysis: Option<&RigAnalysis>,
        outputs: &mut Outputs,
    ) -> Result<Told> {
        let Content { rig, clips, events, rate, mut notes } = content;
        let (mut bones, mut clip, dropped) = bones_only(&rig, &clips[0]);
        lost_meshes(&rig, &dropped, &mut notes);
        let up = if self.up == UpAxis::Z {
            Rotation::about(Vec3::X, core::f32::consts::FRAC_PI_2)
        } else {
            Rotation::IDENTITY
        };
        transform(&mut bones, &mut clip, up, analysis.map_or(1.0, |analysis| analysis.unit_scale));
        let rate = self.fps.map_or_else(|| rate.unwrap_or_else(|| frame_rate(&clip)), f64::from);
        if self.rest_frame {
            clip = with_rest_frame(&bones, &clip, rate, name)?;
        }
        let options = BvhWriteOptions {
            frame_time: 1.0 / rate,
            metres_per_unit: self.unit,
            rotation_order: self.order.euler(),
            ends: BvhEnds::EveryChain,
            channels: None,
        };
        let written = write_bvh(&bones, &clip, &options).map_err(|error| error.with_file(name))?;
        notes.extend(written.notes);
        outputs.add(self.output(), written.text.into_bytes());
        if !events[0].is_empty() {
            let shift = if self.rest_frame { (1.0 / rate) as f32 } else { 0.0 };
            let later = |event: &ClipEvent| ClipEvent { time: event.time + shift, ..event.clone() };
            let stem = self.output().file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let text = write_events(
                &[Clip { name: stem, ..clip.clone() }],
                &[events[0].iter().map(later).collect()],
            );
            outputs.add(&events_path(self.output()), text.into_bytes());
        }
        Ok((vec![line_of(&clip)], notes))
    }

    fn report(&self, clips: &[String], notes: &[String], outputs: &Outputs) -> Report {
        let paths: Vec<String> = outputs.paths().map(|path| path.display().to_string()).collect();
        let json = json!({
            "file": name(&self.input),
            "clips": clips,
            "notes": notes,
            "outputs": paths,
        });
        let mut text = format!("{}\n", shown(&name(&self.input)));
        for line in clips {
            text += &format!("  {line}\n");
        }
        for note in notes {
            text += &format!("note: {}\n", shown(note));
        }
        for path in &paths {
            text += &format!("wrote {path}\n");
        }
        Report { json, text }
    }
}

/// Draws a movie of the first of the output's last `new` clips.
fn draw(outputs: &Outputs, new: usize, picture: &PictureFile) -> Result<Vec<u8>> {
    let (path, bytes) = outputs.first().expect("the command writes a file");
    let name = path.display().to_string();
    let gltf = ReadOptions { textures: Textures::Decode };
    let options = MotionOptions { gltf, ..MotionOptions::default() };
    let file = read_motion(bytes, &options, &mut no_files).map_err(|error| error.with_file(&name))?;
    let first = file.clips.len().checked_sub(new.max(1));
    let show = Show::new(Motion::new(name, file), first)?;
    let settings = RenderSettings {
        threads: std::thread::available_parallelism().map_or(1, usize::from),
        ..RenderSettings::default()
    };
    show.movie(longest(show.seconds()), settings, picture.format)
        .map_err(|error| Failure::of_file(picture.path().display().to_string(), error))
}

/// Returns the text of the report: one line per clip, and the notes.
type Told = (Vec<String>, Vec<String>);

fn line_of(clip: &Clip) -> String {
    format!("{}: {:.2} s", shown(&clip.name), clip.duration)
}

/// Samples a clip as one pose per frame.
fn take(rig: &Rig, clip: &Clip, rate: f64, file: &str) -> Result<Take> {
    if rig.joints.is_empty() {
        return Err(Failure::of_file(file, "there are no joints"));
    }
    if f64::from(clip.duration) * rate >= Take::MOST_FRAMES as f64 {
        return Err(Failure::of_file(file, format!("the clip lasts {} s, which is too long", clip.duration)));
    }
    Ok(Take::of(rig, clip, 1.0 / rate))
}

fn sampled(rig: &Rig, clip: &Clip, rate: f64, file: &str) -> Result<Clip> {
    Ok(take(rig, clip, rate, file)?.to_clip(rig, &clip.name))
}

/// Returns the clip preceded by a frame of the rest pose.
fn with_rest_frame(rig: &Rig, clip: &Clip, rate: f64, file: &str) -> Result<Clip> {
    let mut take = take(rig, clip, rate, file)?;
    take.poses.splice(0..0, rest_pose(rig));
    Ok(take.to_clip(rig, &clip.name))
}

impl Order {
    fn euler(self) -> EulerOrder {
        match self {
            Self::Xyz => EulerOrder::Xyz,
            Self::Xzy => EulerOrder::Xzy,
            Self::Yxz => EulerOrder::Yxz,
            Self::Yzx => EulerOrder::Yzx,
            Self::Zxy => EulerOrder::Zxy,
            Self::Zyx => EulerOrder::Zyx,
        }
    }
}
