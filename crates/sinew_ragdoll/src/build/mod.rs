//! Rig → ragdoll: roles (from animation) → shapes → masses → limits → filter → definition, each a function of its own.
//!
//! ```
//! # let rig = sinew::mannequin::mannequin().rig;
//! # let analysis = sinew_anim::analyze(&rig)?;
//! use sinew_ragdoll::{BuildOptions, build};
//!
//! let (def, report) = build(&rig, &analysis, &BuildOptions { mass: Some(70.0), ..BuildOptions::default() })?;
//! assert_eq!(def.joints.len(), def.bodies.len() - 1);
//! assert!((def.total_mass - 70.0).abs() < 1e-3);
//! assert!(report.mean_error < 0.02, "metres between skin and shapes");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod bones;
pub mod part;
mod report;
mod takes;

pub use report::{BodyReport, BuildReport};
pub use takes::takes;

use crate::def::{RagdollBodyDef, RagdollDef};
use crate::filter::filter_pairs;
use crate::filter::poses::{Frames, Poses, of_clips, within_limits};
use crate::fit::surface::{BindPose, share_surface, skin_triangles};
use crate::fit::{Fit, ShapeChoice, fit_shapes};
use crate::limits::friction::friction_torques;
use crate::limits::learned::learned;
use crate::limits::{JointPlan, LimitSource, joints};
use crate::masses::de_leva::Sex;
use crate::masses::{MassOptions, distribute, volume};
use bones::{Anatomy, Bone, Bones};
use sinew_anim::roles::RigAnalysis;
use sinew_anim::{Animal, JointIdx, Rig, Take};
use sinew_math::{Transform, Vec3};

/// Options of a build.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BuildOptions {
    /// Kind of shapes. Default auto.
    pub shapes: ShapeChoice,
    /// Total mass, kg; `None`: from the height for humans, from the volume for creatures.
    pub mass: Option<f32>,
    /// Sex for the mass distribution. Default male.
    pub sex: Sex,
    /// Source of joint limits. Default: the anatomy tables.
    pub limits: LimitSource,
}

/// Error returned when no ragdoll can be built.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// The file has meshes or bones but no skin that connects them.
    #[error("no skin: nothing to build a ragdoll from")]
    NoSkin,
    /// The rig has no bone that gets a body.
    #[error("no bones: nothing to build a ragdoll from")]
    NoBones,
    /// Numbers of the rig are not finite, or too large or small.
    #[error("the bind pose is not finite")]
    NotFinite,
    /// The requested mass is not a positive number.
    #[error("a mass of {0} kg: it must be positive")]
    Mass(f32),
    /// The options ask for learned limits, but no clip moves a joint.
    #[error("no clip moves a joint: there are no limits to learn")]
    NoClips,
}

/// Builds a ragdoll from a rig and its analysis.
///
/// # Errors
/// See [`BuildError`].
pub fn build(
    rig: &Rig,
    analysis: &RigAnalysis,
    options: &BuildOptions,
) -> Result<(RagdollDef, BuildReport), BuildError> {
    build_overridden(rig, analysis, options, &Overrides::none())
}

/// Function from a body's index, its fit, and a function that fits another kind of shape, to the new fit.
type Refit<'a> = dyn Fn(usize, Fit, &dyn Fn(ShapeChoice) -> Fit) -> Fit + 'a;

/// Changes that settings make to a ragdoll during the build.
pub(crate) struct Overrides<'a> {
    /// Replaces a body's shape.
    pub shape: &'a Refit<'a>,
    /// Pairs of bodies that shall not collide, the smaller index first.
    pub disable: Vec<(usize, usize)>,
    /// Pairs of bodies that shall collide, the smaller index first.
    pub enable: Vec<(usize, usize)>,
    /// Clips of the character as takes.
    pub takes: &'a [Take],
}

impl Overrides<'_> {
    fn none() -> Self {
        Overrides { shape: &|_, fit, _| fit, disable: Vec::new(), enable: Vec::new(), takes: &[] }
    }

    /// Returns the pairs that do not collide: `disabled`, changed by the overrides.
    fn pairs(&self, disabled: Vec<(usize, usize)>) -> Vec<(usize, usize)> {
        let mut pairs: Vec<_> = disabled.into_iter().filter(|pair| !self.enable.contains(pair)).collect();
        pairs.extend(&self.disable);
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }
}

/// Like [`build`], but applies overrides between its stages.
pub(crate) fn build_overridden(
    rig: &Rig,
    analysis: &RigAnalysis,
    options: &BuildOptions,
    overrides: &Overrides<'_>,
) -> Result<(RagdollDef, BuildReport), BuildError> {
    if rig.skins.is_empty() {
        return Err(BuildError::NoSkin);
    }
    if let Some(mass) = options.mass.filter(|mass| !(mass.is_finite() && *mass > 0.0)) {
        return Err(BuildError::Mass(mass));
    }
    // Move the origin so that the soles are at y = 0 in character space.
    let character_from_model =
        Transform::from_translation(Vec3::Y * -analysis.floor) * analysis.character_from_model;
    let bind =
        BindPose { model: &analysis.bind_model, unit_scale: analysis.unit_scale, character_from_model };
    let bones = kept_bones(analysis, bind)?;
    let surface = share_surface(rig, &bones, bind);
    let mut fits = fit_shapes(&bones, &surface, options.shapes);
    fits = (0..fits.len())
        .map(|body| {
            let other = |kind| fit_shapes(&bones, &surface, kind)[body].clone();
            (overrides.shape)(body, fits[body].clone(), &other)
        })
        .collect();
    let Planned { mut plans, limits, poses } = planned(rig, &bones, bind, &fits, options, overrides.takes)?;
    let filter = filter_pairs(&bones, &mut fits, &poses);
    let enclosed = Enclosed::of(rig, &bones, bind);
    let mass = enclosed.as_ref().map(Enclosed::mass);
    let animal = analysis.animal.filter(|_| bones.anatomy == Anatomy::Creature);
    let usual = animal.map(|animal| animal.mass_at(analysis.unit_scale));
    let weighs = MassOptions { total: options.mass, sex: options.sex, enclosed: mass, usual };
    let masses = distribute(&bones, &fits, weighs);
    let total_mass = masses.iter().map(|mass| mass.mass).sum();
    // Friction depends on the mass, which depends on the shapes.
    let heavy = joints(&bones, &fits, total_mass);
    for (plan, torque) in plans.iter_mut().zip(friction_torques(&bones, &fits, &masses, &heavy)) {
        plan.def.friction_torque = torque;
    }
    let mut report = BuildReport::new(rig, &bones, &fits, &filter, (&plans, &limits));
    let flesh = enclosed.as_ref().and_then(|enclosed| enclosed.note(total_mass));
    let kept = || mass_of_kind(animal?, analysis.unit_scale, total_mass, mass?);
    report.notes.extend(flesh.or_else(|| kept().filter(|_| options.mass.is_none())));
    let name = |joint: JointIdx| joint_name(rig, joint);
    let bodies = bones.list.into_iter().zip(fits).zip(masses).map(|((bone, fit), mass)| RagdollBodyDef {
        bone: name(bone.joint),
        joint: bone.joint,
        merged: bone.merged,
        role: bone.role.name(),
        confidence: bone.confidence,
        shape: fit.shape,
        character_from_body: fit.character_from_body,
        mass,
    });
    let dropped = analysis.dropped.iter().filter(|&&joint| analysis.merge_into[joint].is_none());
    let def = RagdollDef {
        bodies: bodies.collect(),
        joints: plans.iter().map(|plan| plan.def).collect(),
        disabled_pairs: overrides.pairs(filter.disabled),
        dropped_bones: dropped.map(|&joint| name(joint)).collect(),
        total_mass,
        height: analysis.height,
        unit_scale: analysis.unit_scale,
        up_axis: analysis.up_axis,
        character_from_model,
    };
    Ok((def, report))
}

/// Returns a note if the mass was limited to the usual range of such an animal, otherwise `None`. `flesh` is the mass
/// that the skin encloses, kg.
fn mass_of_kind(animal: Animal, unit_scale: f32, total_mass: f32, flesh: f32) -> Option<String> {
    let [least, most] = animal.mass_at(unit_scale);
    let is_kept = |end: f32| (total_mass / end - 1.0).abs() < 1e-3;
    let name = animal.name;
    (is_kept(least) || is_kept(most)).then(|| {
        format!(
            "the mass is {total_mass:.1} kg: a {name} of that size weighs {least:.1} to {most:.1} kg, and the skin encloses {flesh:.1} kg"
        )
    })
}

/// Volume that a creature's skin encloses, and its density.
struct Enclosed {
    /// Volume, m³.
    volume: f32,
    /// Density, kg/m³.
    density: f32,
    matter: &'static str,
}

impl Enclosed {
    /// Returns the volume of a creature's skin; `None` for humans, whose mass follows their height, and if the skin is
    /// too open.
    fn of(rig: &Rig, bones: &Bones, bind: BindPose<'_>) -> Option<Self> {
        if bones.anatomy == Anatomy::Human {
            return None;
        }
        let volume = volume::enclosed(&skin_triangles(rig, bones, bind))?;
        let (density, matter) = volume::density(rig);
        Some(Self { volume, density, matter })
    }

    /// Returns the mass of the enclosed volume, kg.
    fn mass(&self) -> f32 {
        self.density * self.volume
    }

    /// Returns a note on the source of the mass, if this build computed the mass.
    fn note(&self, total_mass: f32) -> Option<String> {
        let Self { volume, matter, .. } = self;
        let is_from_here = (self.mass() / total_mass - 1.0).abs() < 1e-3;
        is_from_here
            .then(|| format!("the mass is that of {volume:.3} m³ of {matter}, which the skin encloses"))
    }
}

/// Planned joints, and the poses in which shapes are compared.
struct Planned {
    plans: Vec<JointPlan>,
    /// Source of the limits of each joint.
    limits: Vec<LimitSource>,
    poses: Poses,
}

fn planned(
    rig: &Rig,
    bones: &Bones,
    bind: BindPose<'_>,
    fits: &[Fit],
    options: &BuildOptions,
    takes: &[Take],
) -> Result<Planned, BuildError> {
    // The mass is not known yet. Pass 1 kg, because only the joints' friction depends on it.
    let mut plans = joints(bones, fits, 1.0);
    let mut limits = vec![LimitSource::Anatomy; plans.len()];
    if options.limits == LimitSource::Clips {
        let frames = of_clips(rig, takes, bones, bind, fits, Frames::All);
        let table = plans.clone();
        for (index, (plan, source)) in plans.iter_mut().zip(&mut limits).enumerate() {
            let twin = bones.twin(table[index].def.child).map(|twin| &table[twin - 1]);
            if let Some(from_clips) = learned(&table[index], twin, fits, &frames, bones.anatomy) {
                (*plan, *source) = (from_clips, LimitSource::Clips);
            }
        }
        if !limits.contains(&LimitSource::Clips) {
            return Err(BuildError::NoClips);
        }
    }
    let poses = Poses {
        within_limits: within_limits(fits, &plans),
        of_clips: of_clips(rig, takes, bones, bind, fits, Frames::Some),
    };
    Ok(Planned { plans, limits, poses })
}

/// Returns the joint's name in the file, or `joint N`.
pub fn joint_name(rig: &Rig, joint: JointIdx) -> String {
    match rig.joints[joint].name.as_str() {
        "" => format!("joint {joint}"),
        name => name.to_owned(),
    }
}

fn kept_bones(analysis: &RigAnalysis, bind: BindPose<'_>) -> Result<Bones, BuildError> {
    let list: Vec<_> = analysis
        .kept
        .iter()
        .map(|kept| {
            let head = bind.character_point(kept.bind_model.translation);
            let bone = Bone::new(kept.joint, kept.role, kept.parent, head);
            let (merged, confidence, is_prop) = (kept.merged.clone(), kept.confidence, kept.is_prop);
            Bone { merged, confidence, is_prop, ..bone }
        })
        .collect();
    if list.is_empty() {
        return Err(BuildError::NoBones);
    }
    if !(analysis.height.is_finite() && analysis.height > 0.0 && list.iter().all(|b| b.head.is_finite())) {
        return Err(BuildError::NotFinite);
    }
    let anatomy = if analysis.humanoid { Anatomy::Human } else { Anatomy::Creature };
    Ok(Bones::new(list, anatomy, analysis.height))
}
