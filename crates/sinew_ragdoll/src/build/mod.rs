//! Rig → ragdoll: roles (from animation) → shapes → masses → limits → filter → definition, each a function of its own.

pub mod bones;
pub mod part;
mod report;

pub use report::{BodyReport, BuildReport};

use crate::def::{RagdollBodyDef, RagdollDef};
use crate::filter::{FilterReport, Remedy, filter_pairs};
use crate::fit::patch::Selection;
use crate::fit::surface::{BindPose, share_surface};
use crate::fit::{Fit, ShapeChoice, fit_shapes};
use crate::limits::{JointPlan, joints};
use crate::masses::de_leva::Sex;
use crate::masses::{MassOptions, distribute};
use bones::{Anatomy, Bone, Bones};
use sinew_anim::roles::RigAnalysis;
use sinew_anim::{JointIdx, Rig};
use sinew_math::{Transform, Vec3};

/// A widening of limits below this is not worth a note, radians (1°).
const NOTEWORTHY: f32 = 0.017;

/// What kind of ragdoll is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BuildOptions {
    /// Kind of shapes. Default auto.
    pub shapes: ShapeChoice,
    /// Mass of the whole, kg; `None`: from the height for humans, from the volume for creatures.
    pub mass: Option<f32>,
    /// Whose mass distribution. Default male.
    pub sex: Sex,
}

/// Why there is no ragdoll.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// The file has meshes or bones but no skin that ties them.
    #[error("no skin: nothing to build a ragdoll from")]
    NoSkin,
    /// No bone was worth keeping.
    #[error("no bones: nothing to build a ragdoll from")]
    NoBones,
    /// Numbers of the rig are not finite or out of all proportion.
    #[error("the bind pose is not finite")]
    NotFinite,
    /// The mass asked for is not a positive number.
    #[error("a mass of {0} kg: it must be positive")]
    Mass(f32),
}

/// Builds a ragdoll from a rig and what its analysis found.
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

/// A body's index, its fit, and a way to fit a shape of another kind, to the fit that is wanted.
type Refit<'a> = dyn Fn(usize, Fit, &dyn Fn(ShapeChoice) -> Fit) -> Fit + 'a;

/// What settings change within the build.
pub(crate) struct Overrides<'a> {
    /// Another shape of a body.
    pub shape: &'a Refit<'a>,
    /// Pairs of bodies that shall not collide, the smaller index first.
    pub disable: Vec<(usize, usize)>,
    /// Pairs of bodies that shall.
    pub enable: Vec<(usize, usize)>,
}

impl Overrides<'_> {
    fn none() -> Self {
        Overrides { shape: &|_, fit, _| fit, disable: Vec::new(), enable: Vec::new() }
    }

    /// The pairs that do not collide after all.
    fn pairs(&self, disabled: Vec<(usize, usize)>) -> Vec<(usize, usize)> {
        let mut pairs: Vec<_> = disabled.into_iter().filter(|pair| !self.enable.contains(pair)).collect();
        pairs.extend(&self.disable);
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }
}

/// [`build`] with changes between its stages.
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
    // Character space has the soles at y = 0.
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
    let filter = filter_pairs(&bones, &mut fits);
    let masses = distribute(&bones, &fits, MassOptions { total: options.mass, sex: options.sex });
    let total_mass = masses.iter().map(|mass| mass.mass).sum();
    let plans = joints(&bones, &fits, total_mass);
    let report = report(rig, &bones, &fits, &filter, &plans);
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

/// The joint's name in the file, or `joint N`.
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
            Bone { merged: kept.merged.clone(), confidence: kept.confidence, ..bone }
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

fn report(rig: &Rig, bones: &Bones, fits: &[Fit], filter: &FilterReport, plans: &[JointPlan]) -> BuildReport {
    let bodies: Vec<_> = (0..fits.len())
        .map(|body| BodyReport {
            error: fits[body].error,
            selection: fits[body].selection,
            scale: filter.scale[body],
            widened: body.checked_sub(1).map_or(0.0, |joint| plans[joint].widened),
        })
        .collect();
    let mut notes = Vec::new();
    let name = |body: usize| {
        format!("{} ({})", bones.list[body].role.name(), joint_name(rig, bones.list[body].joint))
    };
    for (index, body) in bodies.iter().enumerate() {
        if body.selection == Selection::Nothing {
            notes.push(format!("{} moves no skin: a thin capsule along the bone stands in", name(index)));
        }
        if body.selection == Selection::Twin {
            notes.push(format!("{} fits worse than its twin: it has the twin's shape", name(index)));
        }
        if body.widened > NOTEWORTHY {
            let degrees = body.widened.to_degrees();
            notes
                .push(format!("{} is bound {degrees:.0}° beyond its limits: they were widened", name(index)));
        }
    }
    for overlap in filter.overlaps.iter().filter(|overlap| overlap.remedy == Remedy::Disabled) {
        let (a, b) = overlap.pair;
        let depth = 1000.0 * overlap.depth;
        notes.push(format!("{} and {} overlap by {depth:.0} mm: they do not collide", name(a), name(b)));
    }
    let area: f32 = fits.iter().map(|fit| fit.area).sum();
    let mean_error = fits.iter().map(|fit| fit.error * fit.area).sum::<f32>() / sinew_math::max(area, 1e-9);
    let shape_volume = fits.iter().map(|fit| fit.shape.volume()).sum();
    BuildReport { bodies, overlaps: filter.overlaps.clone(), mean_error, shape_volume, notes }
}
