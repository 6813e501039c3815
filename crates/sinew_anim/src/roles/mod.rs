//! Analysis of the joints of a rig: roles, axes, units, and which joints need a body.
//!
//! Roles stated by the file (VRM) come first. Otherwise geometry (mirrored chains of the bind pose) decides, and names
//! support it: they determine how a limb is divided, and raise or lower the confidence. Names whose left and right are
//! not mirrored are ignored. If the shape shows no human (an asymmetric bind pose, feet beside the body), names alone
//! decide, if the named parts stand like a human. Names are read by words, not from a list of names. Clips ([`Hints`])
//! distinguish legs from other hanging parts: legs swing alternately.

mod anatomy;
mod assembly;
mod axes;
mod beside;
mod bind;
mod characters;
mod correct;
mod creature;
mod gait;
mod graph;
mod hints;
mod humanoid;
mod keep;
mod names;
mod props;
mod role;
mod species;
mod symmetry;
mod tuning;
mod units;

pub(crate) use bind::{Bound, bind_pose};
pub use characters::characters;
pub use correct::{Correction, CorrectionError};
pub use gait::Gait;
pub use hints::Hints;
pub(crate) use names::words;

pub use role::{HUMANOID_ROLES, Role, Side};
pub use species::Animal;
use species::Species;

use crate::rig::{JointIdx, LocalTransform, Rig};
use anatomy::Anatomy;
use humanoid::Stance;
use keep::{Kept, Selection};
use sinew_math::{Affine, Transform, Vec3};

/// A role and its confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoleGuess {
    /// Role of the joint.
    pub role: Role,
    /// Confidence, 0..=1; 1 where the file itself states the role.
    pub confidence: f32,
    /// Evidence for the role.
    pub basis: Basis,
}

impl RoleGuess {
    fn new(role: Role, basis: Basis) -> Self {
        Self { role, confidence: basis.confidence(), basis }
    }
}

/// Evidence for a role.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Stated by the file or by a correction.
    Stated,
    /// Shape and name agree.
    ShapeAndName,
    /// The shape alone; the name has no meaning.
    Shape,
    /// The shape, although the name contradicts it.
    ShapeAgainstName,
    /// The name alone; the shape does not show it.
    Name,
    /// The position in the body of a creature.
    Place,
}

impl Basis {
    /// Returns the evidence in words, such as `shape and name`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stated => "stated",
            Self::ShapeAndName => "shape and name",
            Self::Shape => "shape",
            Self::ShapeAgainstName => "shape, against its name",
            Self::Name => "name",
            Self::Place => "place in the body",
        }
    }

    fn confidence(self) -> f32 {
        match self {
            Self::Stated => 1.0,
            Self::ShapeAndName => 0.95,
            Self::Shape => 0.8,
            Self::ShapeAgainstName => 0.5,
            Self::Name | Self::Place => 0.6,
        }
    }
}

/// A joint that gets a body.
#[derive(Clone, Debug, PartialEq)]
pub struct KeptBone {
    /// The joint; its origin is the pivot of the body on its parent.
    pub joint: JointIdx,
    /// Role of the joint.
    pub role: Role,
    /// Confidence of the role, 0..=1.
    pub confidence: f32,
    /// Index into [`RigAnalysis::kept`], smaller than the bone's own; `None` for the first bone. Follows anatomy, not
    /// the rig's hierarchy: the foot's parent is the shank, even if the rig attaches the foot elsewhere.
    pub parent: Option<usize>,
    /// Other joints that move with this body and share its skin.
    pub merged: Vec<JointIdx>,
    /// Transform in the bind pose, model space, file units.
    pub bind_model: Affine,
    /// True for props (a sword, a rigid cape), which are fixed to the body but not part of it.
    pub is_prop: bool,
}

/// Result of [`analyze`] for a rig.
#[derive(Clone, Debug, PartialEq)]
pub struct RigAnalysis {
    /// Metres per file unit.
    pub unit_scale: f32,
    /// Up axis, a unit vector in model space.
    pub up_axis: Vec3,
    /// Rotation to the character's axes: +Y up, +Z forward, left on +X. A model point in file units is at
    /// `character_from_model.point(point * unit_scale)`, metres. The translation is zero.
    pub character_from_model: Transform,
    /// Height of the lowest skin in the bind pose, metres, character axes.
    pub floor: f32,
    /// Distance from the lowest to the highest skin in the bind pose, metres.
    pub height: f32,
    /// True if the roles are those of the VRM humanoid, else generic.
    pub humanoid: bool,
    /// Role per joint; `None` for a joint without a role.
    pub roles: Vec<Option<RoleGuess>>,
    /// Joints that get a body, parents before children, the pelvis (or a creature's root) first.
    pub kept: Vec<KeptBone>,
    /// Index into `kept` of the bone that each joint follows; `None` for kept joints, for joints above them in the rig,
    /// and for joints without skin outside of every body (IK targets).
    pub merge_into: Vec<Option<JointIdx>>,
    /// Transform of every joint in the bind pose, model space, file units: from the inverse bind matrices, or from the
    /// rest pose for joints that no skin lists.
    pub bind_model: Vec<Affine>,
    /// Joints of skins that are not kept.
    pub dropped: Vec<JointIdx>,
    /// Assumed length of a file unit with its reason; `None` if the unit was given.
    pub unit_guess: Option<UnitGuess>,
    /// Kind of animal that the file names; `None` for humans, machines, and kinds without a usual mass.
    pub animal: Option<Animal>,
    /// Other assumptions, one sentence each.
    pub notes: Vec<String>,
    /// Hints that were used.
    pub hints: Hints,
}

/// Assumed length of a file unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitGuess {
    /// The unit, the reason and the alternatives, a sentence.
    pub note: String,
    /// True for a human in metres whose size is plausible in no other unit.
    pub is_sure: bool,
    /// True if only one unit gives a plausible size.
    pub is_only: bool,
    /// True if no file unit gives a plausible size, so that the body was scaled to a likely one.
    pub is_scaled: bool,
}

impl RigAnalysis {
    /// Index into [`kept`](Self::kept) of the bone with that role.
    pub fn kept_with(&self, role: Role) -> Option<usize> {
        self.kept.iter().position(|bone| bone.role == role)
    }

    /// Returns the joint with that role, kept or not.
    pub fn joint_with(&self, role: Role) -> Option<JointIdx> {
        self.roles.iter().position(|guess| guess.is_some_and(|guess| guess.role == role))
    }

    /// Returns the affine map from model space (file units) to character space (metres).
    pub fn character_from_file(&self) -> Affine {
        let turn = self.character_from_model;
        Affine::from_scale_rotation_translation(Vec3::splat(self.unit_scale), turn.rotation, turn.translation)
    }
}

impl RigAnalysis {
    /// Returns the analysis with another file unit, for instance for a giant.
    ///
    /// # Panics
    /// If `unit_scale` (metres) is not above 0 and finite.
    #[must_use]
    pub fn with_unit_scale(self, unit_scale: f32) -> Self {
        assert!(
            unit_scale > 0.0 && unit_scale.is_finite(),
            "the unit must be positive and finite, not {unit_scale}"
        );
        let factor = unit_scale / self.unit_scale;
        let (floor, height) = (self.floor * factor, self.height * factor);
        Self { unit_scale, floor, height, unit_guess: None, ..self }
    }
}

/// Error: the rig has no skin, so it has no body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no skin: nothing to build a ragdoll from")]
pub struct NoSkin;

/// Finds roles, axes, unit and bodies of a rig. Every shape is accepted: bodies that are not human get generic roles.
///
/// # Errors
/// [`NoSkin`] if no vertex is bound to a joint.
///
/// # Panics
/// If the rig's indices (parents, skin joints, vertex slots) are out of range.
pub fn analyze(rig: &Rig) -> Result<RigAnalysis, NoSkin> {
    analyze_hinted(rig, &Hints::default())
}

/// [`analyze`] with further evidence: see [`Hints`].
///
/// # Errors
/// As [`analyze`].
///
/// # Panics
/// As [`analyze`], and if the hints are of another rig.
pub fn analyze_hinted(rig: &Rig, hints: &Hints) -> Result<RigAnalysis, NoSkin> {
    plain(analyze_bound(rig, Bound::of(rig).ok_or(NoSkin)?, &[], hints))
}

/// [`analyze_hinted`] with the user's corrections: see [`Correction`].
///
/// # Errors
/// [`CorrectionError`]: no skin, none left, or roles that the rig cannot have.
///
/// # Panics
/// As [`analyze`], and if the correction names a joint that the rig does not have.
pub fn analyze_corrected(
    rig: &Rig,
    hints: &Hints,
    correction: &Correction,
) -> Result<RigAnalysis, CorrectionError> {
    let seen = correction.seen(rig);
    let Some(bound) = Bound::of(&seen) else {
        return Err(if correction.ignored.is_empty() { NoSkin.into() } else { CorrectionError::NothingLeft });
    };
    let mut analysis = analyze_bound(&seen, bound, &correction.roles, hints)?;
    // Ignored joints still follow the body: the root, if they have no parent with a body.
    let mut moves_skin: Vec<JointIdx> = rig.skins.iter().flat_map(|skin| skin.joints.clone()).collect();
    moves_skin.sort_unstable();
    moves_skin.dedup();
    let is_ignored = |joint: JointIdx| {
        let mut line = core::iter::successors(Some(joint), |&at| rig.joints[at].parent);
        line.any(|at| correction.ignored.contains(&at))
    };
    let Some(root) = analysis.kept.first().map(|bone| bone.joint) else { return Ok(analysis) };
    for joint in moves_skin {
        if analysis.merge_into[joint].is_none() && joint != root && is_ignored(joint) {
            analysis.merge_into[joint] = Some(root);
            analysis.kept[0].merged.push(joint);
        }
    }
    analysis.kept[0].merged.sort_unstable();
    Ok(analysis)
}

/// Converts the error: without a correction only missing skin is possible.
fn plain(analyzed: Result<RigAnalysis, CorrectionError>) -> Result<RigAnalysis, NoSkin> {
    analyzed.map_err(|_| NoSkin)
}

/// Finds roles, axes and unit of a skeleton without skin, as in motion capture, that stands in `pose`: best with
/// straight legs and the arms away from the body. Unnamed joints at the ends of chains only mark bone ends. The "bind
/// pose" of the result is `pose`, heights are those of the joints, and bone lengths replace skin areas.
///
/// # Errors
/// [`NoSkin`] if no bone has a length.
///
/// # Panics
/// If `pose` is not as long as the rig has joints.
pub fn analyze_skeleton(rig: &Rig, pose: &[LocalTransform]) -> Result<RigAnalysis, NoSkin> {
    plain(analyze_bound(rig, Bound::of_bones(rig, pose).ok_or(NoSkin)?, &[], &Hints::default()))
}

fn analyze_bound(
    rig: &Rig,
    bound: Bound,
    known: &[(Role, JointIdx)],
    hints: &Hints,
) -> Result<RigAnalysis, CorrectionError> {
    let anatomy = Anatomy::of(rig, &bound, known, hints)?;
    let body = anatomy.measured(&bound, species::named(rig, &hints.name));
    let Anatomy { graph, roles, humanoid, up, left, mut notes, .. } = anatomy;
    let animal = match body.species {
        Some(Species::Animal(name, _)) if !humanoid => Animal::of(name, body.size),
        _ => None,
    };
    let stance = Stance::new(&bound, up);
    let (unit_scale, unit_guess) = units::unit_scale(&body, hints);
    let named = axes::name;
    match hints.up {
        Some(of_file) if up.dot(of_file) < 0.9 => notes.push(format!(
            "the character lies in its file: from hips to head it points along {}, but up is {}; --up {} stands it up",
            named(up),
            named(of_file),
            named(up)
        )),
        None if up.dot(Vec3::Y) < 0.9 => {
            notes.push(format!("the body stands along {up} of the file, not along +Y"));
        }
        _ => {}
    }
    let carrier = keep::carriers(rig, &bound, &graph, &roles);
    let selection =
        Selection { rig, bound: &bound, graph: &graph, roles: &roles, height: stance.height, carrier };
    let mut kept = if humanoid { selection.humanoid() } else { selection.creature() };
    let mut roles = roles;
    props::keep_props(rig, &bound, &mut kept, &mut roles);
    let Kept { bones: kept, merge_into } = kept;
    let mut dropped: Vec<JointIdx> = rig.skins.iter().flat_map(|skin| skin.joints.iter().copied()).collect();
    dropped.sort_unstable();
    dropped.dedup();
    dropped.retain(|joint| kept.iter().all(|bone| bone.joint != *joint));
    Ok(RigAnalysis {
        unit_scale,
        up_axis: up,
        character_from_model: Transform::new(Vec3::ZERO, axes::character_from_model(left, up)),
        floor: stance.floor * unit_scale,
        height: stance.height * unit_scale,
        humanoid,
        roles,
        kept,
        merge_into,
        bind_model: bound.model,
        dropped,
        unit_guess: Some(unit_guess),
        animal,
        notes,
        hints: hints.clone(),
    })
}
