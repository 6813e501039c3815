//! `sinew bake`: simulates a hit or a fall of a character and writes it as a clip on the user's own rig.

mod actor;
mod aim;
mod clip_file;
mod clips;
mod door;
mod grounds;
mod hit;
mod lies;
mod notes;
mod place;

use crate::commands::clip_choice::find_clip;
use crate::failure::{Failure, Result};
use crate::fall::Fall;
use crate::input::files::{CharacterFile, Outputs, WeightSource, never_over};
use crate::input::picture_file::{PictureFile, length, rate, seconds};
use crate::input::ragdoll_file::read_definition;
use crate::input::settings_arg::{SettingsArg, unit_note};
use crate::judge::{Judgement, LIMP_AT, judge_life};
use crate::render::film::{FILM_SIZE, FLOOR_HALF_SIZE, Film, View, body_models};
use crate::report::Report;
use crate::report::garments_report::GarmentsReport;
use crate::report::skin_report::{Life, skin_json};
use crate::report::springs_report::SpringsReport;
use crate::report::table::shown;
pub use actor::{GetUps, actor};
use aim::aim;
use clip_file::{ClipFile, ClipFormat};
pub use clips::Motions;
use clips::{CLIP_NAME, Speed};
use door::door;
use hit::HitArg;
pub use lies::as_in_file;
use place::{Place, degrees, metres, place, point};
use sinew::CharacterSource;
use sinew::anim::{Garment, KeyBound};
use sinew::formats::{Textures, load_world};
use sinew::math::{Rotation, Transform, Vec3, max};
use sinew::physics::{BodyDef, BodyKind, Shape, ShapeDef};
use sinew::ragdoll::bake::KEY_BOUND;
use sinew::ragdoll::quality::{Doubt, toppled};
use sinew::ragdoll::settings::SpringSource;
use sinew::ragdoll::{BakeInput, BuildOptions, HitEffect, RagdollDef, drop_test};
use sinew_picture::Sun;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const FLOOR: [[f32; 3]; 2] = [[0.34, 0.36, 0.38], [0.27, 0.29, 0.31]];
const OBSTACLES: [[f32; 3]; 3] = [[0.45, 0.33, 0.22], [0.40, 0.36, 0.30], [0.33, 0.27, 0.22]];

/// Let your character fall: simulate it from its animation and write the fall as a clip into a copy of your file, or as
/// a BVH
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew bake character.glb -o fall.glb
  sinew bake character.glb --clip Walk --hit chest=0,0,-60@1.0 -o fall.glb \\
      --picture fall.gif
  sinew bake character.glb --world house.json --limp-at 1.2 --seconds 6 \\
      -o fall.glb --json
  sinew bake character.glb --ragdoll edited.sinew.json -o fall.glb
  sinew bake character.glb --role hips=Bone_12 --ignore Cape --height 1.8 \\
      -o fall.glb
  sinew bake character.glb --fps 120 -o fall.bvh

Keys that no joint needs to stay within --key-error are left out. A BVH holds the skeleton alone, with every frame.")]
pub struct Bake {
    /// A GLB, glTF, VRM or FBX file with a skinned character
    character: PathBuf,
    /// The clip that plays until the fall, by name or words of it, or by number from 0; without it the file's walk,
    /// else its idle, else its first clip; in a file without clips the rest pose
    #[arg(long, value_name = "NAME")]
    clip: Option<String>,
    /// Speed ahead while a clip that walks on the spot plays, m/s; 'feet': the speed of its feet
    #[arg(long, value_name = "M/S|feet", allow_negative_numbers = true)]
    speed: Option<Speed>,
    /// Further files with clips (GLB, VRMA, BVH, FBX, DeepMimic): for the same skeleton matched by joint names, else
    /// for a human of any size matched by the joints' roles
    #[arg(long, value_name = "FILE", num_args = 1..)]
    clips: Vec<PathBuf>,
    /// A world file (JSON) or a mesh (GLB, OBJ) to fall in; without it a floor at y = 0
    #[arg(long, value_name = "FILE")]
    world: Option<PathBuf>,
    /// Position of the character, metres; by default a flat position with free height of one and a half times the
    /// character's, on the largest walkable ground of the world; without --world the origin
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    at: Option<Vec3>,
    /// Direction in which it faces, degrees from +Z toward +X
    #[arg(long, value_name = "DEG", default_value = "0", value_parser = degrees, allow_negative_numbers = true)]
    facing: f32,
    /// Add a floor at this height, metres
    #[arg(long, value_name = "Y", value_parser = metres, allow_negative_numbers = true)]
    floor: Option<f32>,
    /// A ragdoll of this character from `ragdoll build`, edited or not; by default one is built
    #[arg(long, value_name = "FILE.sinew.json", conflicts_with = "SettingsArg")]
    ragdoll: Option<PathBuf>,
    /// Get up only by clips of the file or of --clips. By default a human without any gets up and walks by built-in
    /// motions
    #[arg(long)]
    no_builtin_motions: bool,
    /// The clip by which it gets up, chosen as by --clip; a clip that ends lying is played backwards; 'none': it stays
    /// down. By default the get-up clip, among those of the file and of --clips, that begins in the pose nearest to the
    /// lying one
    #[arg(long, value_name = "NAME|none")]
    get_up: Option<String>,
    #[command(flatten)]
    settings: SettingsArg,
    /// Do not simulate the file's springs (hair, tails, …)
    #[arg(long)]
    no_springs: bool,
    /// Simulate springs guessed from joint names (hair, ear, tail, skirt, ribbon, breast, cape) if the file has none
    #[arg(long, conflicts_with = "no_springs")]
    guess_springs: bool,
    /// Do not simulate the garments (capes, skirts, coats) listed in the settings
    #[arg(long)]
    no_garments: bool,
    /// Push a bone: joint name or role, impulse in N·s along the world's axes (+Y up), time in seconds; repeatable. For
    /// a role without a body the nearest body is used
    #[arg(long = "hit", value_name = "BONE=IX,IY,IZ@T", allow_hyphen_values = true)]
    hits: Vec<HitArg>,
    /// Show hits that are too weak for a fall as a flinch: the limb yields and recovers
    #[arg(long)]
    flinch: bool,
    /// Go limp at this time, seconds; without any --hit the default is 0.5, and a character that stays upright is
    /// pushed over
    #[arg(long, value_name = "T", value_parser = seconds, allow_negative_numbers = true)]
    limp_at: Option<f32>,
    /// Length of the clip, seconds
    #[arg(long, value_name = "S", default_value = "8", value_parser = length, allow_negative_numbers = true)]
    seconds: f32,
    /// Frames per second of the clip
    #[arg(long, value_name = "N", default_value = "30", value_parser = rate)]
    fps: f32,
    /// Largest error of any joint of the clip at a frame, mm, and the largest rotation error in tenths of a degree; 0
    /// keeps a key for every frame. Default 0.1: a tenth of a millimetre, a hundredth of a degree
    #[arg(long, value_name = "MM", value_parser = key_error, allow_negative_numbers = true)]
    key_error: Option<f32>,
    /// File to write: a copy of yours with the new clip in it (.glb, .vrm), or its skeleton and the clip (.bvh)
    #[arg(short, long, value_name = "OUT.(glb|vrm|bvh)")]
    output: ClipFile,
    /// Name of the new clip; by default sinew, or sinew 2 and so on where the file has that already
    #[arg(long, value_name = "NAME", value_parser = clap::builder::NonEmptyStringValueParser::new())]
    name: Option<String>,
    /// Also draw it: a .gif, .png (animated) or .webp file
    #[arg(long, value_name = "OUT.(gif|png|webp)")]
    picture: Option<PictureFile>,
}

/// The falling character, and notes about the character.
struct Cast {
    file: CharacterFile,
    ragdoll: RagdollDef,
    garments: Vec<Garment>,
    /// Reason to doubt the character's mass, if there is one.
    doubt: Option<Doubt>,
    notes: Vec<String>,
}

/// Largest key error that the user may allow, mm. With a larger one the clip would no longer resemble the motion.
const LARGEST_KEY_ERROR: f32 = 100.0;

/// Parses an allowed key error, mm.
fn key_error(text: &str) -> Result<f32, String> {
    let error: f32 = text.parse().map_err(|_| format!("'{text}' is not a number"))?;
    if (0.0..=LARGEST_KEY_ERROR).contains(&error) {
        Ok(error)
    } else {
        Err(format!("must lie between 0 and {LARGEST_KEY_ERROR} mm"))
    }
}

impl Bake {
    /// Runs the command: reads the files, simulates, draws the picture and writes the output.
    pub fn run(&self) -> Result<Report> {
        let key_bound = self.key_bound()?;
        self.check_outputs()?;
        self.check_times()?;
        let textures = if self.picture.is_some() { Textures::Decode } else { Textures::Skip };
        let bodies = self.bodies()?;
        let Cast { file, ragdoll, garments, doubt, mut notes } = self.character(textures, &bodies)?;
        let name = self.clip_name(&file)?;
        let mut motions = Motions::gather(&file, &self.clips, self.clip.as_deref())?;
        notes.extend(motions.notes.iter().cloned());
        notes.extend(motions.go_ahead(&file, self.speed)?);
        let get_ups = self.get_ups(&file, &motions)?;
        let place = self.place(&bodies, ragdoll.height)?;
        let (mut character, gets_up_by) = actor(&file, ragdoll, motions, get_ups)?;
        character.set_garments(&garments);
        let springs = SpringsReport::of(&character);
        notes.extend(springs.notes());
        let garments = GarmentsReport::of(&character);
        notes.extend(garments.notes());
        let up = file.analysis.hints.up.unwrap_or(Vec3::Y);
        let starts = as_in_file(place.stands, &character, up);
        let character = Arc::new(character);
        let aimed = self.hits.iter().map(|hit| aim(hit, &character, &file, &mut notes));
        let hits = aimed.collect::<Result<Vec<_>>>()?;
        let limp_at = self.limp_at.or(if hits.is_empty() { Some(LIMP_AT) } else { None });
        let input = BakeInput {
            world_from_character: starts,
            bodies: &bodies,
            hits: &hits,
            hit_effect: if self.flinch { HitEffect::FlinchesOrFalls } else { HitEffect::Falls },
            limp_at,
            seconds: self.seconds,
            fps: self.fps,
            key_bound,
            name: &name,
            ..BakeInput::new(character)
        };
        let fall = Fall::simulate(&input, doubt.as_ref());
        let is_default = self.hits.is_empty() && self.limp_at.is_none();
        let pushed = toppled(&input, &fall.baked).filter(|_| is_default);
        notes.extend(pushed.as_ref().map(notes::is_pushed));
        let mut fall = pushed.as_ref().map_or(fall, |pushed| Fall::simulate(pushed, doubt.as_ref()));
        let world = self.world.as_ref().map(|path| path.display().to_string());
        notes.extend(world.as_deref().and_then(|world| notes::stands_at(&place, world)));
        notes.extend(notes::of_bake(&input, &fall.baked.events, &gets_up_by, world.as_deref()));
        let is_level = self.world.is_none() && place.stands.translation.y == self.floor.unwrap_or(0.0);
        let floor = is_level.then_some(place.stands.translation.y);
        let tested = drop_test(&input.character.ragdoll);
        let stays_down = gets_up_by.flaw();
        let life = Life { fall: &fall, floor, stays_down: stays_down.as_deref() };
        let Judgement { verdict, reasons, skin } = judge_life(&file, &tested, life, doubt.as_ref());
        (fall.verdict, fall.reasons) = (verdict, reasons);
        notes.extend(skin.flaws.iter().map(|flaw| format!("skin: {flaw}")));
        notes.extend(self.write(&file, &fall)?);
        let mut report = self.report(&file, &fall, &once(notes));
        report.json["skin"] = skin_json(&skin);
        report.json["springs"] = springs.to_json();
        report.json["garments"] = garments.to_json();
        Ok(report)
    }

    /// Returns the get-ups that the user has chosen.
    fn get_ups(&self, file: &CharacterFile, motions: &Motions) -> Result<GetUps> {
        match self.get_up.as_deref() {
            Some("none") => Ok(GetUps::None),
            Some(name) => find_clip(&motions.clips, name)
                .map(GetUps::Clip)
                .map_err(|what| Failure::at(&file.name, what, "--get-up")),
            None if self.no_builtin_motions => Ok(GetUps::OfFiles),
            None => Ok(GetUps::Any),
        }
    }

    /// Returns the bodies of the world: from the file, and a floor if requested, at y = 0 without a file.
    fn bodies(&self) -> Result<Vec<BodyDef>> {
        let mut bodies = self.world.as_ref().map_or(Ok(Vec::new()), load_world)?;
        let level = self.floor.or_else(|| self.world.is_none().then_some(0.0));
        bodies.extend(level.map(floor));
        Ok(bodies)
    }

    /// Returns the position of a character of this height (metres).
    fn place(&self, bodies: &[BodyDef], height: f32) -> Result<Place> {
        let Some(world) = &self.world else {
            let on_floor = self.at.unwrap_or(Vec3::Y * self.floor.unwrap_or(0.0));
            let turn = Rotation::from_axis_angle(Vec3::Y, self.facing.to_radians());
            return Ok(Place { stands: Transform::new(on_floor, turn), found: false });
        };
        let name = world.display().to_string();
        place(bodies, height, self.at, self.facing)
            .map_err(|what| Failure::at(&name, what, if self.at.is_some() { "--at" } else { "--world" }))
    }

    /// Returns the allowed key error; zero for formats that store every frame.
    fn key_bound(&self) -> Result<KeyBound> {
        match (self.output.format, self.key_error) {
            (ClipFormat::Bvh, None) => Ok(KeyBound::ALL_KEYS),
            (ClipFormat::Bvh, Some(_)) => {
                Err(Failure::Usage("--key-error does not apply to a BVH, which holds every frame".to_owned()))
            }
            (ClipFormat::Copy, None) => Ok(KEY_BOUND),
            (ClipFormat::Copy, Some(mm)) => {
                Ok(KeyBound { distance: 1e-3 * mm, angle: 0.1 * mm.to_radians() })
            }
        }
    }

    /// Reads the character with the given definition, or builds one.
    fn character(&self, textures: Textures, world: &[BodyDef]) -> Result<Cast> {
        let Some(path) = &self.ragdoll else {
            let door = || self.world.as_ref().and_then(|_| door(world));
            let (mut file, settings) =
                self.settings.load_into(&self.character, textures, door, !self.no_garments)?;
            let source = self.spring_source(settings.settings.springs);
            file.document.rig.springs = settings.springs(source, &file)?;
            let garments = if self.no_garments { Vec::new() } else { settings.garments(&file)? };
            let (ragdoll, _) = settings.build(&file, &BuildOptions::default())?;
            let guess = file.analysis.unit_guess.as_ref().filter(|guess| !guess.is_sure);
            let mut notes: Vec<String> = guess.map(unit_note).into_iter().collect();
            let is_for_bake =
                |note: &&String| ["--character", "--up"].iter().any(|option| note.contains(option));
            notes.extend(file.analysis.notes.iter().filter(is_for_bake).cloned());
            let loose = file.document.warnings.iter().filter(|note| note.ends_with("the nearest skin"));
            notes.extend(loose.cloned());
            let doubt = settings.doubt(&file, &ragdoll);
            notes.extend(doubt.iter().map(|doubt| doubt.reason.clone()));
            return Ok(Cast { file, ragdoll, garments, doubt, notes });
        };
        let mut file = CharacterFile::load(&self.character, textures, WeightSource::File)?;
        let CharacterSource { document, analysis, .. } = &mut file.source;
        document.rig.springs = self.spring_source(None).springs(&document.rig, analysis.up_axis);
        let ragdoll = read_definition(path, &file)?;
        // A given definition may have a guessed or a given mass.
        let mut doubt = Doubt::of(&ragdoll);
        if let Some(doubt) = &mut doubt {
            doubt.reason += "; --height, --unit or --mass of `ragdoll build` sets it";
        }
        let notes = doubt.iter().map(|doubt| doubt.reason.clone()).collect();
        Ok(Cast { file, ragdoll, garments: Vec::new(), doubt, notes })
    }

    /// Returns the source of springs: an option, else the settings.
    fn spring_source(&self, setting: Option<SpringSource>) -> SpringSource {
        match (self.no_springs, self.guess_springs) {
            (true, _) => SpringSource::None,
            (_, true) => SpringSource::Names,
            _ => setting.unwrap_or_default(),
        }
    }

    /// Returns the name of the new clip: the user's, else `sinew`, with a number if the file has that name already.
    fn clip_name(&self, file: &CharacterFile) -> Result<String> {
        let is_taken = |name: &str| file.document.clips.iter().any(|clip| clip.name == name);
        match &self.name {
            Some(name) if self.output.format == ClipFormat::Copy && is_taken(name) => {
                let what =
                    format!("there is a clip '{}' already: give the new one another name", shown(name));
                Err(Failure::at(&file.name, what, "--name"))
            }
            Some(name) => Ok(name.clone()),
            None => {
                let mut names = std::iter::once(CLIP_NAME.to_owned())
                    .chain((2..).map(|number: u32| format!("{CLIP_NAME} {number}")));
                Ok(names.find(|name| !is_taken(name)).expect("one of infinitely many names is free"))
            }
        }
    }

    /// Rejects an output that is one of the user's own files.
    fn check_outputs(&self) -> Result<()> {
        let settings = self.settings.path_for(&self.character);
        let inputs = self.clips.iter().chain([&self.character, &settings]).map(PathBuf::as_path);
        never_over(inputs.chain(self.world.as_deref()).chain(self.ragdoll.as_deref()), self.outputs())
    }

    /// Rejects a hit after the end; going limp after the end only gives a note.
    fn check_times(&self) -> Result<()> {
        match self.hits.iter().map(|hit| hit.time).find(|time| *time > self.seconds) {
            Some(time) => {
                let end = self.seconds;
                Err(Failure::Usage(format!("--hit at {time} s is after the end, at {end} s (--seconds)")))
            }
            None => Ok(()),
        }
    }

    fn outputs(&self) -> Vec<&Path> {
        std::iter::once(self.output.path()).chain(self.picture.iter().map(PictureFile::path)).collect()
    }

    /// Writes all files; returns notes on what the clip's format cannot represent.
    fn write(&self, file: &CharacterFile, fall: &Fall<'_>) -> Result<Vec<String>> {
        let (bytes, notes) = self.output.write(file, fall)?;
        let mut outputs = Outputs::default();
        outputs.add(self.output.path(), bytes);
        if let Some(picture) = &self.picture {
            let failed = |error| Failure::of_file(picture.path().display().to_string(), error);
            outputs.add(picture.path(), film(fall).shoot(picture.format, FILM_SIZE).map_err(failed)?);
        }
        outputs.write()?;
        Ok(notes)
    }

    fn report(&self, file: &CharacterFile, fall: &Fall<'_>, notes: &[String]) -> Report {
        let outputs = self.outputs();
        let left_out = left_out(fall.input.bodies).map_or(String::new(), |what| format!("\n{what}"));
        let mut text = format!("{}{left_out}\n{}", shown(&file.name), fall.to_text(&outputs));
        for note in notes {
            text += &format!("note: {}\n", shown(note));
        }
        let mut json = fall.to_json(&outputs);
        json["notes"] = notes.into();
        Report { json, text }
    }
}

/// Removes repeated sentences.
fn once(notes: Vec<String>) -> Vec<String> {
    let mut said: Vec<String> = Vec::new();
    for note in notes {
        if !said.contains(&note) {
            said.push(note);
        }
    }
    said
}

/// Returns a report on degenerate and duplicate triangles of the world, if any.
fn left_out(bodies: &[BodyDef]) -> Option<String> {
    let shapes = bodies.iter().flat_map(|body| &body.shapes);
    let dropped = shapes.filter_map(|shape| match &shape.shape {
        Shape::Mesh(mesh) => Some(mesh.dropped()),
        _ => None,
    });
    let (degenerate, repeated) =
        dropped.fold((0, 0), |(flat, twice), one| (flat + one.degenerate, twice + one.repeated));
    (degenerate + repeated > 0).then(|| {
        format!(
            "  left out of the world: {degenerate} triangles without area, {repeated} that are duplicates"
        )
    })
}

/// Returns a static half-space with its surface at height `level`.
fn floor(level: f32) -> BodyDef {
    let shapes = vec![ShapeDef::new(Shape::HalfSpace)];
    BodyDef { kind: BodyKind::Static, position: Vec3::Y * level, shapes, ..BodyDef::default() }
}

/// Returns a film of the whole character from its front left (facing +Z), unless the view is blocked there.
fn film<'a>(fall: &'a Fall<'a>) -> Film<'a> {
    let mut set = Vec::new();
    let half_size = max(FLOOR_HALF_SIZE, 30.0 * fall.input.character.ragdoll.height);
    for (index, body) in fall.input.bodies.iter().enumerate() {
        let is_floor = body.shapes.iter().any(|shape| shape.shape == Shape::HalfSpace);
        let [color, other] = if is_floor { FLOOR } else { [OBSTACLES[index % OBSTACLES.len()]; 2] };
        set.extend(body_models(body, half_size, color, other));
    }
    Film {
        fall,
        from: 0.0,
        set,
        direction: Vec3::new(0.75, 0.4, 0.75),
        view: View::Whole,
        sun: Sun::default(),
    }
}
