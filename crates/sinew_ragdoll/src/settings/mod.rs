//! Settings: a user's overrides of the build, stored beside the rig. Settings name bones by role or joint name, never
//! by index, so that they survive a re-export of the rig.
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
//! let head = def.bodies.iter().find(|body| body.role == "head").expect("the body exists");
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
use sinew_anim::{JointIdx, Rig, Springs, Take, guess_springs};
use sinew_math::{Range, Vec3};

/// Requested changes to the build. The default changes nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// Kind of all shapes; `None`: as in the options.
    pub shapes: Option<ShapeChoice>,
    /// Total mass, kg; `None`: as in the options.
    pub mass: Option<f32>,
    /// Mass distribution; `None`: as in the options.
    pub sex: Option<Sex>,
    /// Source of joint limits; `None`: as in the options.
    pub limits: Option<LimitSource>,
    /// Length of the file's unit; `None`: inferred.
    pub unit: Option<Unit>,
    /// The file's axis that points up: unit, along an axis; `None`: inferred.
    pub up_axis: Option<Vec3>,
    /// Bones, by role, by role without its side (both sides), or by joint name; later entries win.
    pub bones: Vec<(String, BoneSettings)>,
    /// Bones that are not part of the body, with all their descendants, by joint name. They follow their parents, and
    /// their skin does not affect shapes.
    pub ignore: Vec<String>,
    /// Pairs of bones that shall not collide.
    pub disable: Vec<[String; 2]>,
    /// Pairs of bones that collide in any case.
    pub enable: Vec<[String; 2]>,
    /// Source of the springs that the character wears; `None`: the file. The build of bodies ignores it.
    pub springs: Option<SpringSource>,
    /// Links across strands of these springs; `None`: the links of the source.
    pub spring_links: Option<Vec<LinkSettings>>,
    /// Garments that the character wears. Their bones are not part of the body, as if [`ignore`](Self::ignore) named
    /// them. Default none.
    pub garments: GarmentSource,
}

/// Source of the springs that a character wears.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpringSource {
    /// Springs that the file declares. Default.
    #[default]
    File,
    /// Springs that the file declares; without any, springs inferred from joint names ([`guess_springs`]).
    Names,
    /// No springs.
    None,
}

impl SpringSource {
    /// Returns the springs of a rig whose up axis is `up`, unit.
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
    /// Length of the unit, metres.
    Scale(f32),
    /// Scales the character to this height in its bind pose, metres.
    Height(f32),
}

/// Requested changes to the build of one bone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BoneSettings {
    /// Body part of the bone. Only for a bone selected by joint name, because this changes roles.
    pub role: Option<Role>,
    /// Forces or forbids a body for the bone; `None`: the build decides.
    pub body: Option<BodyWish>,
    /// Kind of the bone's shape.
    pub shape: Option<ShapeWish>,
    /// Factor on the fitted shape.
    pub scale: Option<f32>,
    /// Mass, kg. If the total mass is also given, the other bodies share the rest.
    pub mass: Option<f32>,
    /// Kind of the bone's joint to its parent.
    pub joint: Option<JointWish>,
    /// Swing about y, radians; the range contains zero.
    pub swing_y: Option<Range>,
    /// Swing about z, radians; the range contains zero.
    pub swing_z: Option<Range>,
    /// Twist, or the angle of a hinge, radians.
    pub twist: Option<Range>,
    /// Friction torque, N·m.
    pub friction_torque: Option<f32>,
}

/// Forces or forbids a body for a bone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyWish {
    /// The bone gets a body, even if the build would merge the bone into another.
    Keep,
    /// The bone moves with its parent's body.
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
    /// The joint swings and twists.
    Ball,
    /// The joint rotates about one axis.
    Hinge,
    /// The joint swings.
    Universal,
    /// The joint does not rotate.
    Fixed,
}

/// Reason why settings cannot be applied.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// The rig cannot be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A setting that this rig does not allow.
    #[error("{what}")]
    Setting {
        /// One-line description of the problem.
        what: String,
        /// Key of the setting, such as `bones.leftHand`.
        place: String,
    },
}

impl SettingsError {
    fn at(place: impl Into<String>, what: impl Into<String>) -> Self {
        Self::Setting { what: what.into(), place: place.into() }
    }
}

/// Does [`build`](crate::build()) with settings. If an option is `None`, the setting applies.
///
/// # Errors
/// The errors of `build`; names that match no bone of this rig, with the nearest one; a dropped pelvis; colliding pairs
/// that a joint connects.
pub fn build_with(
    rig: &Rig,
    analysis: &RigAnalysis,
    options: &BuildOptions,
    settings: &Settings,
) -> Result<(RagdollDef, BuildReport), SettingsError> {
    build_moving(rig, analysis, &[], options, settings)
}

/// Like [`build_with`], for a character whose motion is known, as [`takes`](crate::build::takes()) returns it from
/// clips. Shapes that overlap in this motion are corrected, and limits may be learned from it.
///
/// # Errors
/// The errors of `build_with`; if limits are to be learned and no take moves a joint, [`BuildError::NoClips`].
///
/// # Panics
/// If a take does not belong to the rig.
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

impl Settings {
    /// Returns the joints of a rig that are not part of the body, without those below them: joints to ignore, and those of
    /// garments.
    ///
    /// # Errors
    /// If a name matches no joint.
    pub fn ignored_joints(&self, rig: &Rig) -> Result<Vec<JointIdx>, SettingsError> {
        Ok(correct::correction(rig, self)?.ignored)
    }
}

/// Returns an analysis corrected by the settings: roles, ignored joints, unit and axis. The build decides which bones
/// get bodies; it calls this function itself.
///
/// # Errors
/// For names that the rig does not have, with the nearest ones, and impossible roles.
pub fn analyze_with(
    rig: &Rig,
    analysis: &RigAnalysis,
    settings: &Settings,
) -> Result<RigAnalysis, SettingsError> {
    let correction = correct::correction(rig, settings)?;
    correct::corrected(rig, &correction.seen(rig), analysis, &correction, settings)
}
