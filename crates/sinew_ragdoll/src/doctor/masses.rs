//! Checks of masses and inertias.

use super::exam::Exam;
use super::{Code, Finding};
use crate::build::bones::Anatomy;
use crate::def::RagdollDef;
use crate::doctor::tuning::{CHAIN_RATIO, MOMENT_RATIO, NEIGHBOUR_RATIO};
use crate::masses::de_leva::Sex;
use crate::masses::default_mass;
use sinew_math::{Vec3, max, min};
use sinew_physics::{MassProperties, Shape};

/// Body mass indices that a human may have, kg/m².
const BODY_MASS_INDEX: core::ops::RangeInclusive<f32> = 11.0..=50.0;
/// Densities that the shapes of a creature may have, kg/m³.
const DENSITY: core::ops::RangeInclusive<f32> = 60.0..=4000.0;
/// Plausible ratios of a body's moment to the moment of its shape at its mass.
const INERTIA: core::ops::RangeInclusive<f32> = 0.1..=10.0;

pub(super) fn findings(exam: &Exam<'_>) -> Vec<Finding> {
    let mut findings: Vec<Finding> =
        (0..exam.def.bodies.len()).filter_map(|b| not_positive(exam, b)).collect();
    if findings.is_empty() {
        findings.extend(total(exam));
        findings.extend(ratios(exam));
        findings.extend((0..exam.def.bodies.len()).filter_map(|body| inertia(exam, body)));
    }
    findings
}

/// Returns true if a world accepts a body of this mass.
pub(super) fn is_positive(mass: &MassProperties) -> bool {
    mass.mass > 0.0
        && mass.mass.is_finite()
        && mass.center.is_finite()
        && mass.inertia.is_finite()
        && mass.inertia.eigen().0.z > 0.0
}

fn not_positive(exam: &Exam<'_>, body: usize) -> Option<Finding> {
    let mass = &exam.def.bodies[body].mass;
    let evidence = || {
        let moments = if mass.inertia.is_finite() { mass.inertia.eigen().0 } else { Vec3::NAN };
        format!("{} has {} kg and moments of {} kg·m²", exam.who(body), mass.mass, moments)
    };
    (!is_positive(mass)).then(|| exam.finding(Code::MassNotPositive, &[body], evidence()))
}

/// Returns the natural mass of a body of this size, kg.
pub(super) fn natural_mass(exam: &Exam<'_>) -> f32 {
    match exam.bones.anatomy {
        Anatomy::Human => default_mass(exam.size, Sex::Male),
        Anatomy::Creature => 700.0 * volume(exam.def),
    }
}

fn volume(def: &RagdollDef) -> f32 {
    def.bodies.iter().map(|body| body.shape.volume()).sum()
}

fn total(exam: &Exam<'_>) -> Option<Finding> {
    let mass: f32 = exam.def.bodies.iter().map(|body| body.mass.mass).sum();
    let (is_plausible, measure) = match exam.bones.anatomy {
        Anatomy::Human => {
            let index = mass / (exam.size * exam.size);
            (BODY_MASS_INDEX.contains(&index), format!("a body mass index of {index:.1} kg/m²"))
        }
        Anatomy::Creature => {
            let density = mass / max(volume(exam.def), 1e-9);
            (DENSITY.contains(&density), format!("{density:.0} kg/m³ of its shapes"))
        }
    };
    if is_plausible {
        return None;
    }
    let evidence = format!(
        "{mass:.1} kg at {:.2} m: {measure}; a body of this size has {:.0} kg",
        exam.size,
        natural_mass(exam)
    );
    Some(exam.finding(Code::MassImplausible, &[0], evidence))
}

fn ratios(exam: &Exam<'_>) -> Vec<Finding> {
    let mass = |body: usize| exam.def.bodies[body].mass.mass;
    let ratio = |a: usize, b: usize| max(mass(a) / mass(b), mass(b) / mass(a));
    let mut findings = Vec::new();
    // A prop moves as one rigid piece with its carrier.
    let is_held = |body: usize| exam.bones.list[body].is_prop;
    for joint in exam.def.joints.iter().filter(|joint| !is_held(joint.child)) {
        let found = ratio(joint.parent, joint.child);
        if found > NEIGHBOUR_RATIO {
            let evidence = format!(
                "{} has {:.3} kg and {} {:.3} kg: {found:.0} to 1 across a joint",
                exam.who(joint.parent),
                mass(joint.parent),
                exam.who(joint.child),
                mass(joint.child),
            );
            findings.push(exam.finding(Code::MassRatio, &[joint.child, joint.parent], evidence));
        }
    }
    if findings.is_empty() {
        findings.extend(chain(exam));
    }
    findings
}

/// Returns a finding about the largest ratio along a chain, if it is too large.
fn chain(exam: &Exam<'_>) -> Option<Finding> {
    let mass = |body: usize| exam.def.bodies[body].mass.mass;
    let mut worst: Option<(f32, usize, usize)> = None;
    for body in (1..exam.def.bodies.len()).filter(|&body| !exam.bones.list[body].is_prop) {
        let mut above = exam.bones.list[body].parent;
        while let Some(at) = above {
            let ratio = max(mass(at) / mass(body), mass(body) / mass(at));
            if worst.is_none_or(|(most, ..)| ratio > most) {
                worst = Some((ratio, body, at));
            }
            above = exam.bones.list[at].parent;
        }
    }
    let (ratio, body, above) = worst.filter(|(ratio, ..)| *ratio > CHAIN_RATIO)?;
    let evidence = format!(
        "{} has {:.3} kg and {} {:.3} kg: {ratio:.0} to 1 along a chain",
        exam.who(above),
        mass(above),
        exam.who(body),
        mass(body),
    );
    Some(exam.finding(Code::MassRatio, &[body, above], evidence))
}

/// Returns the principal moments of the shape at this mass, largest first, kg·m².
fn moments_of(shape: &Shape, mass: f32) -> Vec3 {
    let unit = shape.mass_properties(1.0);
    unit.inertia.eigen().0 * (mass / unit.mass)
}

fn inertia(exam: &Exam<'_>, body: usize) -> Option<Finding> {
    let def = &exam.def.bodies[body];
    let moments = def.mass.inertia.eigen().0;
    let natural = moments_of(&def.shape, def.mass.mass);
    let ratio = moments.x / natural.x;
    let what = if moments.x > 1.01 * (moments.y + moments.z) {
        format!("moments of {} kg·m²: no solid has one larger than the sum of the others", shown(moments))
    } else if !INERTIA.contains(&ratio) {
        format!(
            "a largest moment of {:.2e} kg·m², {ratio:.2} times the {:.2e} of its shape at {:.2} kg",
            moments.x, natural.x, def.mass.mass
        )
    } else if moments.x > MOMENT_RATIO * moments.z {
        format!("moments of {} kg·m²: {:.0} to 1", shown(moments), moments.x / moments.z)
    } else {
        return None;
    };
    Some(exam.finding(Code::InertiaOutOfProportion, &[body], format!("{} has {what}", exam.who(body))))
}

fn shown(v: Vec3) -> String {
    format!("{:.2e}, {:.2e} and {:.2e}", v.x, v.y, v.z)
}

/// Returns mass, centre and inertia of a shape at a mass, suitable for a solver: no moment is below an eighth of the
/// largest.
pub(super) fn of_shape(shape: &Shape, mass: f32) -> MassProperties {
    let unit = shape.mass_properties(1.0);
    let factor = mass / max(unit.mass, 1e-9);
    let (moments, axes) = unit.inertia.eigen();
    let least = Vec3::splat(moments.x / 8.0);
    let moments = sinew_math::max3(moments, least) * factor;
    let inertia = sinew_math::Sym3::from_rotated_diagonal(axes, moments);
    MassProperties { mass, center: unit.center, inertia }
}

/// Multiplies every mass by `factor`.
pub(super) fn scale_all(def: &mut RagdollDef, factor: f32) {
    for body in &mut def.bodies {
        body.mass.mass *= factor;
        body.mass.inertia = body.mass.inertia * factor;
    }
    def.total_mass = def.bodies.iter().map(|body| body.mass.mass).sum();
}

/// Makes the lighter of two bodies heavy enough for the mass ratio `most`, and keeps the total mass.
pub(super) fn limit_mass_ratio(def: &mut RagdollDef, [a, b]: [usize; 2], most: f32) {
    let (light, heavy) = if def.bodies[a].mass.mass < def.bodies[b].mass.mass { (a, b) } else { (b, a) };
    let total = def.total_mass;
    let body = &mut def.bodies[light].mass;
    let (old, new) = (body.mass, min(def.bodies[heavy].mass.mass / most, 0.5 * total));
    let body = &mut def.bodies[light].mass;
    body.mass = new;
    body.inertia = body.inertia * (new / old);
    let sum: f32 = def.bodies.iter().map(|body| body.mass.mass).sum();
    scale_all(def, total / sum);
}
