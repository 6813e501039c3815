//! Settings of a ragdoll: those next to the character's file or in a named file, overridden by the command line.

use crate::failure::{Failure, Result};
use crate::input::files::{CharacterFile, WeightSource};
use crate::input::source::{name, read_bytes};
use sinew::anim::{Garment, Hints, RigAnalysis, Role, Springs, UnitGuess};
use sinew::formats::{Textures, read_ragdoll_settings, settings_path};
use sinew::math::Vec3;
use sinew::ragdoll::build::BuildReport;
use sinew::ragdoll::quality::Doubt;
use sinew::ragdoll::settings::{BodyWish, BoneSettings, SpringSource, Unit, role_named};
use sinew::ragdoll::{BuildError, BuildOptions, RagdollDef, Settings, SettingsError};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Heading of these options in the help.
const HEADING: &str = "Correcting what is read from the file";

/// Options by which a user corrects the build of a ragdoll.
#[derive(clap::Args)]
pub struct SettingsArg {
    /// Settings of the ragdoll, a JSON file; by default NAME.ragdoll.json next to the character, if it exists. The
    /// options below override it
    #[arg(help_heading = HEADING, long, value_name = "FILE")]
    settings: Option<PathBuf>,
    /// Number of the character in the file, from 1, where there are several; by default the one with the most vertices
    #[arg(help_heading = HEADING, long = "character", id = "character_number", value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    character: Option<u16>,
    /// Height that the character has, metres: sets the length of the file's unit
    #[arg(help_heading = HEADING, long, value_name = "M", value_parser = positive, allow_negative_numbers = true, conflicts_with = "unit")]
    height: Option<f32>,
    /// Length of one unit of the file: m, dm, cm, mm, in, ft, or metres as a number
    #[arg(help_heading = HEADING, long, value_name = "UNIT", value_parser = unit, allow_negative_numbers = true)]
    unit: Option<f32>,
    /// Axis of the file that points up; by default y, as glTF has it
    #[arg(help_heading = HEADING, long, value_name = "AXIS", value_parser = axis, allow_hyphen_values = true)]
    up: Option<Vec3>,
    /// Weights of the skin; nearest is for a file that has lost its own
    #[arg(help_heading = HEADING, long, value_name = "SOURCE", value_enum, default_value_t)]
    weights: WeightSource,
    /// Mass of the whole character, kg; by default from its height or volume
    #[arg(help_heading = HEADING, long, value_name = "KG", value_parser = positive, allow_negative_numbers = true)]
    mass: Option<f32>,
    /// State the role of a bone, as in hips=Bone_12; 'sinew inspect' lists both; repeatable
    #[arg(help_heading = HEADING, long = "role", value_name = "ROLE=BONE")]
    roles: Vec<RoleArg>,
    /// Exclude a bone and everything below it (a cape, hair, a flag) from the body; it moves with its parent;
    /// repeatable
    #[arg(help_heading = HEADING, long, value_name = "BONE")]
    ignore: Vec<String>,
    /// Give a bone, by role or name, a body of its own; repeatable
    #[arg(help_heading = HEADING, long, value_name = "BONE")]
    body: Vec<String>,
    /// A bone, by role or name, that moves with its parent's body; repeatable
    #[arg(help_heading = HEADING, long, value_name = "BONE")]
    no_body: Vec<String>,
}

/// `ROLE=BONE`.
#[derive(Clone, Debug)]
struct RoleArg {
    role: Role,
    bone: String,
}

impl FromStr for RoleArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // Role names contain no `=`, but bone names may.
        let (role, bone) = text.split_once('=').ok_or("must be ROLE=BONE, as in hips=Bone_12")?;
        if bone.is_empty() {
            return Err("BONE is missing, as in hips=Bone_12".to_owned());
        }
        Ok(Self { role: role_named(role)?, bone: bone.to_owned() })
    }
}

/// Parses a number above 0.
fn positive(text: &str) -> Result<f32, String> {
    let number: f32 = text.parse().map_err(|_| format!("'{text}' is not a number"))?;
    if number > 0.0 && number.is_finite() { Ok(number) } else { Err("must be above 0".to_owned()) }
}

/// Key of the total mass in settings.
const MASS: &str = "mass";

/// Units by their names, in metres.
const UNITS: [(&str, f32); 6] =
    [("m", 1.0), ("dm", 0.1), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254), ("ft", 0.3048)];

/// Parses a unit by its name, or as a number; returns its length in metres.
pub fn unit(text: &str) -> Result<f32, String> {
    match UNITS.iter().find(|(name, _)| name.eq_ignore_ascii_case(text)) {
        Some(&(_, metres)) => Ok(metres),
        None => positive(text).map_err(|_| "must be m, dm, cm, mm, in, ft or metres above 0".to_owned()),
    }
}

/// Axes by their names.
const AXES: [(&str, Vec3); 6] = [
    ("x", Vec3::X),
    ("y", Vec3::Y),
    ("z", Vec3::Z),
    ("-x", Vec3::NEG_X),
    ("-y", Vec3::NEG_Y),
    ("-z", Vec3::NEG_Z),
];

fn axis(text: &str) -> Result<Vec3, String> {
    let known = AXES.iter().find(|(name, _)| name.eq_ignore_ascii_case(text.trim_start_matches('+')));
    known.map(|&(_, axis)| axis).ok_or_else(|| "must be x, y, z, -x, -y or -z".to_owned())
}

/// Settings and their source.
#[derive(Debug, Default)]
pub struct LoadedSettings {
    /// Name of the file, as given by the user, or `""`.
    pub file: String,
    /// The settings themselves.
    pub settings: Settings,
    /// Keys of the settings set by the command line, with the option as typed.
    typed_keys: Vec<(String, String)>,
}

impl SettingsArg {
    /// Returns the first option given, as typed.
    pub fn given(&self) -> Option<&'static str> {
        let given = [
            ("--settings", self.settings.is_some()),
            ("--character", self.character.is_some()),
            ("--height", self.height.is_some()),
            ("--unit", self.unit.is_some()),
            ("--up", self.up.is_some()),
            ("--weights", self.weights != WeightSource::default()),
            ("--mass", self.mass.is_some()),
            ("--role", !self.roles.is_empty()),
            ("--ignore", !self.ignore.is_empty()),
            ("--body", !self.body.is_empty()),
            ("--no-body", !self.no_body.is_empty()),
        ];
        given.into_iter().find(|(_, is_given)| *is_given).map(|(option, _)| option)
    }

    /// Returns the path of the settings for a character's file: the user's, else next to the file, whether or not it
    /// exists.
    pub fn path_for(&self, character: &Path) -> PathBuf {
        self.settings.clone().unwrap_or_else(|| settings_path(character))
    }

    /// Reads the settings for a character's file.
    pub fn load(&self, character: &Path) -> Result<LoadedSettings> {
        let path = &self.path_for(character);
        let mut loaded = LoadedSettings::default();
        if self.settings.is_some() || path.is_file() {
            loaded.file = name(path);
            let read = read_bytes(path).and_then(|bytes| read_ragdoll_settings(&bytes));
            loaded.settings = read.map_err(|error| error.with_file(&loaded.file))?;
        }
        self.say(&mut loaded)?;
        Ok(loaded)
    }

    /// Reads a character and applies its settings to roles and unit.
    pub fn load_character(&self, path: &Path, textures: Textures) -> Result<(CharacterFile, LoadedSettings)> {
        self.load_into(path, textures, || None, true)
    }

    /// Reads a character like [`Self::load_character`] for a world, whose door height (metres) is requested if the
    /// unit is
    /// in doubt. Optionally converts the listed meshes to garments.
    pub fn load_into(
        &self,
        path: &Path,
        textures: Textures,
        door: impl FnOnce() -> Option<f32>,
        wears_garments: bool,
    ) -> Result<(CharacterFile, LoadedSettings)> {
        let mut character = CharacterFile::load(path, textures, self.weights)?;
        if self.up.is_some() {
            let hints = Hints { up: self.up, ..character.analysis.hints.clone() };
            character.hint(&hints)?;
        }
        character.choose(self.character.map(usize::from))?;
        if character.is_in_doubt()
            && let Some(door) = door()
        {
            // The note on the choice of a character is not part of the analysis.
            let notes = character.analysis.notes.clone();
            let hints = Hints { door: Some(door), ..character.analysis.hints.clone() };
            character.hint(&hints)?;
            character.analysis.notes = notes;
        }
        let mut loaded = self.load(path)?;
        if !wears_garments {
            loaded.settings.garments.leave_meshes();
        }
        let corrected = character.source.correct(&loaded.settings);
        corrected.map_err(|error| loaded.failure(&character.name, error))?;
        Ok((character, loaded))
    }

    /// Overrides the file's settings by the command line.
    fn say(&self, loaded: &mut LoadedSettings) -> Result<()> {
        let LoadedSettings { settings, typed_keys, .. } = loaded;
        for (index, RoleArg { role, bone }) in self.roles.iter().enumerate() {
            if self.roles[..index].iter().any(|other| other.role == *role || other.bone == *bone) {
                let what = "is given twice: a role has one bone, and a bone one role";
                return Err(Failure::Usage(format!("--role {}={bone} {what}", role.name())));
            }
            settings
                .bones
                .push((bone.clone(), BoneSettings { role: Some(*role), ..BoneSettings::default() }));
            typed_keys.push((format!("bones.{bone}.role"), format!("--role {}={bone}", role.name())));
        }
        for bone in &self.ignore {
            typed_keys.push((format!("ignore[{}]", settings.ignore.len()), format!("--ignore {bone}")));
            settings.ignore.push(bone.clone());
        }
        if !self.ignore.is_empty() {
            typed_keys.push(("ignore".into(), "--ignore".into()));
        }
        for (bones, body, option) in
            [(&self.body, BodyWish::Keep, "--body"), (&self.no_body, BodyWish::Drop, "--no-body")]
        {
            for bone in bones {
                settings
                    .bones
                    .push((bone.clone(), BoneSettings { body: Some(body), ..BoneSettings::default() }));
                typed_keys.push((format!("bones.{bone}"), format!("{option} {bone}")));
            }
        }
        if let Some(unit) = self.height.map(Unit::Height).or_else(|| self.unit.map(Unit::Scale)) {
            settings.unit = Some(unit);
            typed_keys.push(("height".into(), "--height".into()));
        }
        if let Some(mass) = self.mass {
            settings.mass = Some(mass);
            typed_keys.push((MASS.into(), "--mass".into()));
        }
        Ok(())
    }
}

/// Returns a note on the guessed unit, with the options that change it.
pub fn unit_note(guess: &UnitGuess) -> String {
    let flags = if guess.is_scaled {
        "--unit m keeps the file's size, --height sets another"
    } else {
        "--unit or --height sets it"
    };
    format!("{}; {flags}", guess.note)
}

/// Returns the assumptions of the analysis, including the unit, one sentence each.
pub fn assumed(analysis: &RigAnalysis) -> Vec<String> {
    let unit = analysis.unit_guess.as_ref().map(unit_note);
    unit.into_iter().chain(analysis.notes.iter().cloned()).collect()
}

impl LoadedSettings {
    /// Builds the ragdoll of a character and its clips; returns notes of the build.
    pub fn build(
        &self,
        character: &CharacterFile,
        options: &BuildOptions,
    ) -> Result<(RagdollDef, BuildReport)> {
        let built = character.build(&self.settings, options);
        let (def, mut report) = built.map_err(|error| self.failure(&character.name, error))?;
        let mut notes = Vec::new();
        if !self.file.is_empty() {
            notes.push(format!("with the settings of {}", self.file));
        }
        notes.extend(assumed(&character.analysis));
        notes.extend(self.doubt(character, &def).map(|doubt| doubt.reason));
        notes.append(&mut report.notes);
        report.notes = notes;
        Ok((def, report))
    }

    /// Returns the character's springs from that source.
    pub fn springs(&self, source: SpringSource, character: &CharacterFile) -> Result<Springs> {
        let springs = character.springs(&self.settings, source);
        springs.map_err(|error| self.failure(&character.name, error))
    }

    /// Returns the garments of the character.
    pub fn garments(&self, character: &CharacterFile) -> Result<Vec<Garment>> {
        let garments = character.garments(&self.settings);
        garments.map_err(|error| self.failure(&character.name, error))
    }

    /// Returns the doubt about the mass, with advice. A given unit is in doubt only if no body has such a mass.
    pub fn doubt(&self, character: &CharacterFile, def: &RagdollDef) -> Option<Doubt> {
        let Settings { mass, unit, .. } = self.settings;
        let of_kind = || {
            let analysis = &character.analysis;
            Doubt::of_kind(def, analysis.animal.as_ref()?, analysis.unit_scale)
        };
        let is_counted = |doubt: &Doubt| doubt.is_gross || mass.is_some() || unit.is_none();
        let mut doubt = Doubt::of(def).filter(is_counted).or_else(of_kind)?;
        let advice = match (mass, unit) {
            (Some(mass), _) => format!("the mass of {mass} kg is given, in kg"),
            (_, Some(Unit::Height(height))) => format!("the height of {height} m is given, in metres"),
            (_, Some(Unit::Scale(metres))) => format!("a unit of {metres} m is given"),
            (None, None) => "--height or --unit sets the size, --mass the mass".to_owned(),
        };
        doubt.reason += &format!("; {advice}");
        Some(doubt)
    }

    /// Adds the settings file, or the option with the invalid value, to an error.
    fn failure(&self, character: &str, error: SettingsError) -> Failure {
        match error {
            SettingsError::Build(error @ BuildError::Mass(_)) => {
                let is_typed = self.typed_keys.iter().any(|(key, _)| key == MASS);
                let place = if is_typed { "--mass" } else { "" };
                Failure::at(character, error, place)
            }
            SettingsError::Build(error) => Failure::of_file(character, error),
            SettingsError::Setting { what, place } => {
                match self.typed_keys.iter().rev().find(|(key, _)| *key == place) {
                    Some((_, option)) => Failure::at(character, what, option),
                    None => Failure::at(&self.file, what, place),
                }
            }
        }
    }
}
