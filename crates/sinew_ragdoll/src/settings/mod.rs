//! Settings: what a user wants otherwise than the build does it, kept beside the rig, so that they survive when the rig is exported
//! anew: by role or by bone, never by index.
//!
//! ```
//! # let rig = sinew::mannequin::mannequin().rig;
//! # let analysis = sinew_anim::analyze(&rig)?;
//! use sinew_ragdoll::settings::{BoneSettings, ShapeWish};
//! use sinew_ragdoll::{BuildOptions, Settings, build_with};
//!
//! let round = BoneSettings { shape: Some(ShapeWish::Sphere), ..BoneSettings::default() };
//! let settings = Settings { bones: vec![("head".into(), round)], ..Settings::default() };
//! let (def, _) = build_with(&rig, &analysis, &BuildOptions::default(), &settings)?;
//! let head = def.bodies.iter().find(|body| body.role == "head").expect("it has one");
//! assert!(matches!(head.shape, sinew_physics::Shape::Sphere { .. }));
//!
//! let slip = Settings { bones: vec![("haed".into(), round)], ..Settings::default() };
//! let error = build_with(&rig, &analysis, &BuildOptions::default(), &slip).expect_err("no such bone");
//! assert!(error.to_string().contains("head"), "{error}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod apply;
mod bodies;
mod correct;
mod garments;
mod links;
mod nearest;

pub use garments::{GarmentSettings, GarmentSource, MeshSettings};
pub use links::LinkSettings;
pub use nearest::{instead, nearest, nearest_three, role_named};

use crate::build::{BuildError, BuildOptions, BuildReport};
use crate::def::RagdollDef;
use crate::fit::ShapeChoice;
use crate::limits::LimitSource;
use crate::masses::de_leva::Sex;
use sinew_anim::roles::{RigAnalysis, Role};
use sinew_anim::{Rig, Springs, Take, guess_springs};
use sinew_math::{Range, Vec3};

/// Changes that are wanted to the build. The default changes nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// Kind of all shapes; `None`: that of the options.
    pub shapes: Option<ShapeChoice>,
    /// Mass of the whole, kg; `None`: that of the options.
    pub mass: Option<f32>,
    /// Whose distribution of mass; `None`: that of the options.
    pub sex: Option<Sex>,
    /// Source of joint limits; `None`: what the options say.
    pub limits: Option<LimitSource>,
    /// Length of the file's unit.
    pub unit: Option<Unit>,
    /// The file's axis that points up: unit, along an axis.
    pub up_axis: Option<Vec3>,
    /// Bones, by role, by role without its side (both sides), or by the name of the rig's joint; later ones win.
    pub bones: Vec<(String, BoneSettings)>,
    /// Bones that are no part of the body, with all that hangs below them, by the name of the rig's joint: they go along, and
    /// their skin shapes nothing.
    pub ignore: Vec<String>,
    /// Pairs of bones that shall not collide.
    pub disable: Vec<[String; 2]>,
    /// Pairs of bones that shall collide, whatever the build thinks.
    pub enable: Vec<[String; 2]>,
    /// Source of the springs that the character wears; `None`: what the file states. The build of bodies does not ask for it.
    pub springs: Option<SpringSource>,
    /// Links across strands of those springs; `None`: those that come with them.
    pub spring_links: Option<Vec<LinkSettings>>,
    /// Garments that the character wears. Their bones are no part of the body, as if [`ignore`](Self::ignore) named them. Default none.
    pub garments: GarmentSource,
}

/// Source of the springs that a character wears.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpringSource {
    /// Springs that the file states. Default.
    #[default]
    File,
    /// Springs that the file states, and where it states none what names of joints tell ([`guess_springs`]).
    Names,
    /// None.
    None,
}

impl SpringSource {
    /// Springs of a rig whose axis `up` points up, unit.
    pub fn springs(self, rig: &Rig, up: Vec3) -> Springs {
        match self {
            Self::None => Springs::default(),
            Self::Names if rig.springs.is_empty() => guess_springs(rig, up),
            Self::File | Self::Names => rig.springs.clone(),
        }
    }
}

/// Length of the file's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unit {
    /// Metres.
    Scale(f32),
    /// So that the character has this height in its bind pose, metres.
    Height(f32),
}

/// Changes that are wanted to the build of one bone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BoneSettings {
    /// Part of the body that it is. Only for a bone by the name of its joint, for roles are what this changes.
    pub role: Option<Role>,
    /// Wish for a body of its own, or for none; `None`: as the build decides.
    pub body: Option<BodyWish>,
    /// Kind of its shape.
    pub shape: Option<ShapeWish>,
    /// Factor on the fitted shape.
    pub scale: Option<f32>,
    /// kg. Where the mass of the whole is given too, the other bodies make up for it.
    pub mass: Option<f32>,
    /// Kind of its joint to the parent.
    pub joint: Option<JointWish>,
    /// Swing about y, radians, zero inside.
    pub swing_y: Option<Range>,
    /// Swing about z, radians, zero inside.
    pub swing_z: Option<Range>,
    /// Twist, or the angle of a hinge, radians.
    pub twist: Option<Range>,
    /// N·m.
    pub friction_torque: Option<f32>,
}

/// Wish for a body of a bone, or for none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyWish {
    /// It gets one, though the build would merge it into another.
    Keep,
    /// It moves with its parent's body.
    Drop,
}

/// Kind of one shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeWish {
    /// A box.
    Box,
    /// A capsule.
    Capsule,
    /// A ball of the box's volume.
    Sphere,
}

/// Kind of one joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointWish {
    /// Swings and twists.
    Ball,
    /// Turns about one axis.
    Hinge,
    /// Swings.
    Universal,
    /// Does not turn.
    Fixed,
}

/// Why settings cannot be followed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// The rig cannot be built at all.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A setting that this rig does not allow.
    #[error("{what}")]
    Setting {
        /// Description of what is wrong, one line.
        what: String,
        /// The key that says it, such as `bones.leftHand`.
        place: String,
    },
}

impl SettingsError {
    fn at(place: impl Into<String>, what: impl Into<String>) -> Self {
        Self::Setting { what: what.into(), place: place.into() }
    }
}

/// [`build`](crate::build()) with settings. What both say, the options' `None` leaves to the settings.
///
/// # Errors
/// What `build` refuses; names that are no bone of this rig, with the nearest one; a pelvis that shall be dropped; pairs
/// that shall collide though a joint ties them.
pub fn build_with(
    rig: &Rig,
    analysis: &RigAnalysis,
    options: &BuildOptions,
    settings: &Settings,
) -> Result<(RagdollDef, BuildReport), SettingsError> {
    build_moving(rig, analysis, &[], options, settings)
}

/// [`build_with`] for a character whose motion is known, as [`takes`](crate::build::takes()) gives it from clips: shapes
/// that overlap in it are dealt with, and limits may be learned from it.
///
/// # Errors
/// As `build_with`; where limits are to be learned and no take moves a joint, [`BuildError::NoClips`].
///
/// # Panics
/// If a take is not one of the rig's.
pub fn build_moving(
    rig: &Rig,
    analysis: &RigAnalysis,
    takes: &[Take],
    options: &BuildOptions,
    settings: &Settings,
) -> Result<(RagdollDef, BuildReport), SettingsError> {
    let correction = correct::correction(rig, settings)?;
    let seen = correction.seen(rig);
    let analysis = correct::corrected(rig, &seen, analysis, &correction, settings)?;
    let analysis = bodies::settled(rig, analysis, settings)?;
    apply::build(&seen, &analysis, options, settings, takes)
}

/// An analysis as settings correct it: roles, what is ignored, unit and axis. Which bones get bodies is left to the build,
/// which asks for this by itself.
///
/// # Errors
/// Names that the rig does not have, with the nearest ones; roles that cannot be.
pub fn analyze_with(
    rig: &Rig,
    analysis: &RigAnalysis,
    settings: &Settings,
) -> Result<RigAnalysis, SettingsError> {
    let correction = correct::correction(rig, settings)?;
    correct::corrected(rig, &correction.seen(rig), analysis, &correction, settings)
}
