//! Settings of a scene, which a user may change.

use super::performance::Performance;
use super::ragdolls::ragdoll_of;
use crate::parts::GRAVITY;
use sinew::formats::{
    BvhOptions, MjcfModel, ReadOptions, TriangleMesh, load_gltf, load_mesh, read_bvh, read_bytes, read_model,
};
use sinew::math::Vec3;
use sinew::physics::{Sleeping, World, WorldDef};
use sinew::ragdoll::RagdollDef;

/// Allowed values of a setting: numbers (bounds included) or a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Domain {
    /// Any number from the first to the second.
    Number(f32, f32),
    /// Any whole number from the first to the second.
    Whole(u16, u16),
    /// Path of an MJCF model; setting it reads the file.
    Model,
    /// Path of a level, GLB or OBJ; setting it reads the file.
    Level,
    /// Path of a character, GLB, optional; setting it reads the file.
    Character,
    /// Path of a captured motion, BVH; setting it reads the file.
    Motion,
}

/// A setting of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Name of the setting.
    pub key: &'static str,
    /// Description, with its unit.
    pub about: &'static str,
    /// Default value; 0 for a file.
    pub default: f32,
    /// Values that are allowed.
    pub domain: Domain,
}

impl Setting {
    pub(crate) const fn number(
        key: &'static str,
        default: f32,
        (lo, hi): (f32, f32),
        about: &'static str,
    ) -> Self {
        Self { key, about, default, domain: Domain::Number(lo, hi) }
    }

    pub(crate) const fn whole(
        key: &'static str,
        default: u16,
        (lo, hi): (u16, u16),
        about: &'static str,
    ) -> Self {
        Self { key, about, default: default as f32, domain: Domain::Whole(lo, hi) }
    }

    pub(crate) const fn model(key: &'static str, about: &'static str) -> Self {
        Self { key, about, default: 0.0, domain: Domain::Model }
    }

    pub(crate) const fn level(key: &'static str, about: &'static str) -> Self {
        Self { key, about, default: 0.0, domain: Domain::Level }
    }

    pub(crate) const fn character(key: &'static str, about: &'static str) -> Self {
        Self { key, about, default: 0.0, domain: Domain::Character }
    }

    pub(crate) const fn motion(key: &'static str, about: &'static str) -> Self {
        Self { key, about, default: 0.0, domain: Domain::Motion }
    }

    /// Parses a number; returns `None` for a setting that is a file.
    fn parse(&self, text: &str) -> Option<f32> {
        match self.domain {
            Domain::Number(lo, hi) => text.parse().ok().filter(|value| (lo..=hi).contains(value)),
            Domain::Whole(lo, hi) => {
                let whole: u16 = text.parse().ok()?;
                (lo..=hi).contains(&whole).then(|| f32::from(whole))
            }
            Domain::Model | Domain::Level | Domain::Character | Domain::Motion => None,
        }
    }
}

/// Reason why a setting was refused, in one line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingError {
    /// The text is not `key=value`.
    #[error("`{0}` is not key=value")]
    NotAnAssignment(String),
    /// The scene has no such setting.
    #[error("no setting `{key}`; there is {}", list(.known))]
    UnknownKey {
        /// Requested key.
        key: String,
        /// Existing keys.
        known: Vec<&'static str>,
    },
    /// The setting does not allow this value.
    #[error("`{key}` does not allow `{value}`: it takes {domain}")]
    Value {
        /// The setting.
        key: &'static str,
        /// Value that was given.
        value: String,
        /// Values that the setting allows.
        domain: String,
    },
    /// The named file cannot be read.
    #[error(transparent)]
    File(#[from] sinew::formats::Error),
    /// The scene cannot start without this setting.
    #[error("`{key}` is not set: it takes {domain}")]
    Missing {
        /// The setting.
        key: &'static str,
        /// Accepted values.
        domain: String,
    },
}

fn list(keys: &[&'static str]) -> String {
    if keys.is_empty() { "none".into() } else { keys.join(", ") }
}

impl core::fmt::Display for Domain {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Number(lo, hi) => write!(f, "a number from {lo} to {hi}"),
            Self::Whole(lo, hi) => write!(f, "a whole number from {lo} to {hi}"),
            Self::Model => write!(f, "the path of a model in MJCF"),
            Self::Level => write!(f, "the path of a level, a GLB or OBJ"),
            Self::Character => write!(f, "the path of a character, a GLB"),
            Self::Motion => write!(f, "the path of a captured motion, a BVH"),
        }
    }
}

/// The settings of one scene with their values.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    declared: &'static [Setting],
    values: Vec<f32>,
    model: Option<MjcfModel>,
    level: Option<TriangleMesh>,
    character: Option<RagdollDef>,
    motion: Option<Performance>,
}

impl Settings {
    pub(crate) fn new(declared: &'static [Setting]) -> Self {
        let values = declared.iter().map(|setting| setting.default).collect();
        Self { declared, values, model: None, level: None, character: None, motion: None }
    }

    /// Declared settings.
    pub fn declared(&self) -> &'static [Setting] {
        self.declared
    }

    /// Sets one setting by `key=value`.
    ///
    /// # Errors
    /// See [`SettingError`].
    pub fn assign(&mut self, assignment: &str) -> Result<(), SettingError> {
        let (key, value) =
            assignment.split_once('=').ok_or_else(|| SettingError::NotAnAssignment(assignment.to_owned()))?;
        let Some(place) = self.declared.iter().position(|setting| setting.key == key) else {
            let known = self.declared.iter().map(|setting| setting.key).collect();
            return Err(SettingError::UnknownKey { key: key.to_owned(), known });
        };
        let Setting { key, domain, .. } = self.declared[place];
        if self.read(domain, value)? {
            return Ok(());
        }
        self.values[place] = self.declared[place].parse(value).ok_or_else(|| SettingError::Value {
            key,
            value: value.to_owned(),
            domain: domain.to_string(),
        })?;
        Ok(())
    }

    /// Reads the file named by a setting; returns false if the setting is no file.
    fn read(&mut self, domain: Domain, path: &str) -> Result<bool, SettingError> {
        let refused = |what: String| sinew::formats::Error::malformed(what, "").with_file(path);
        match domain {
            Domain::Number(..) | Domain::Whole(..) => return Ok(false),
            Domain::Model => {
                let bytes = read_bytes(path)?;
                self.model = Some(read_model(&bytes).map_err(|error| error.with_file(path))?);
            }
            Domain::Level => {
                let level = load_mesh(path)?;
                level.to_body().map_err(|error| error.with_file(path))?;
                self.level = Some(level);
            }
            Domain::Character => {
                let document = load_gltf(path, ReadOptions::default())?;
                let def = ragdoll_of(&document.rig);
                self.character = Some(def.ok_or_else(|| refused("no skinned character".into()))?);
            }
            Domain::Motion => {
                let document = read_bvh(&read_bytes(path)?, BvhOptions::default());
                let document = document.map_err(|error| error.with_file(path))?;
                self.motion = Some(Performance::of(document).map_err(refused)?);
            }
        }
        Ok(true)
    }

    /// Checks that the scene can start.
    ///
    /// # Errors
    /// If a required file is missing.
    pub fn check(&self) -> Result<(), SettingError> {
        let missing = |setting: &&Setting| match setting.domain {
            Domain::Model => self.model.is_none(),
            Domain::Level => self.level.is_none(),
            Domain::Motion => self.motion.is_none(),
            Domain::Number(..) | Domain::Whole(..) | Domain::Character => false,
        };
        match self.declared.iter().find(missing) {
            Some(Setting { key, domain, .. }) => {
                Err(SettingError::Missing { key, domain: domain.to_string() })
            }
            None => Ok(()),
        }
    }

    /// Number value of a setting.
    ///
    /// # Panics
    /// If there is no such setting.
    pub fn get(&self, key: &str) -> f32 {
        let place = self.declared.iter().position(|setting| setting.key == key);
        self.values[place.expect("the scene declares this setting")]
    }
}

/// Input from which a scene is built.
pub(crate) struct Setup<'a> {
    pub settings: &'a Settings,
    /// Scale of the world's gravity relative to that of the expectations.
    pub gravity_factor: f32,
}

impl Setup<'_> {
    pub fn number(&self, key: &str) -> f32 {
        self.settings.get(key)
    }

    pub fn whole(&self, key: &str) -> usize {
        self.settings.get(key) as usize
    }

    /// Returns the MJCF model of the settings.
    ///
    /// # Panics
    /// If the model is not set: see [`Settings::check`].
    pub fn model(&self) -> &MjcfModel {
        self.settings.model.as_ref().expect("the model is set")
    }

    /// Returns the level of the settings.
    ///
    /// # Panics
    /// If the level is not set: see [`Settings::check`].
    pub fn level(&self) -> &TriangleMesh {
        self.settings.level.as_ref().expect("the level is set")
    }

    /// Returns the captured motion of the settings.
    ///
    /// # Panics
    /// If the motion is not set: see [`Settings::check`].
    pub fn motion(&self) -> &Performance {
        self.settings.motion.as_ref().expect("the motion is set")
    }

    pub fn character(&self) -> Option<&RagdollDef> {
        self.settings.character.as_ref()
    }

    /// Creates an empty world.
    pub fn world(&self) -> World {
        self.world_with(Sleeping::On)
    }

    /// Creates an empty world without sleep, for bodies that swing or fly for ever.
    pub fn sleepless_world(&self) -> World {
        self.world_with(Sleeping::Off)
    }

    fn world_with(&self, sleeping: Sleeping) -> World {
        World::new(WorldDef { sleeping, ..self.world_def() })
    }

    /// Definition of a world that differs from the usual one in more than its sleeping mode.
    pub fn world_def(&self) -> WorldDef {
        WorldDef { gravity: Vec3::NEG_Y * (GRAVITY * self.gravity_factor), ..WorldDef::default() }
    }
}

/// Creates a world without gravity, in which nothing falls asleep.
pub(crate) fn weightless_world() -> World {
    World::new(WorldDef { gravity: Vec3::ZERO, sleeping: Sleeping::Off, ..WorldDef::default() })
}
