//! Finds why a ragdoll jitters, explodes or looks wrong: causes with evidence and repairs.
//!
//! The causes are common defaults of tools: identical limits, joints without limits, heads without bodies, frames whose
//! zero is not the bind pose, bodies that overlap at the start.
//!
//! ```
//! # let rig = sinew::mannequin::mannequin().rig;
//! # let analysis = sinew_anim::analyze(&rig)?;
//! # let (def, _) = sinew_ragdoll::build(&rig, &analysis, &sinew_ragdoll::BuildOptions::default())?;
//! use sinew_ragdoll::{Repair, cure, doctor};
//!
//! let mut repair = Repair::new(def);
//! repair.def.bodies[3].mass.mass = 1e-4; // a slip of the hand
//! let finding = &doctor(&repair)[0];
//! println!("{}\n{}", finding.evidence, finding.fix);
//! assert!(finding.bodies.contains(&3));
//! let (cured, findings) = cure(&repair);
//! assert!(findings[0].fixed && cured.def.bodies[3].mass.mass > 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod anatomy;
mod code;
mod exam;
mod finding;
mod geometry;
mod limits;
mod masses;
mod mend;
mod mirror;
mod missing_bodies;
mod motion;
mod shapes;
mod tuning;

pub use code::{Code, Severity};
pub(crate) use exam::beyond_at_bind;
pub(crate) use exam::bones_of;
pub use exam::limit_reach;
pub use finding::{Finding, Repair};
pub use geometry::scaled;

use crate::skin::{Flaw, FlawKind};
use exam::Exam;

/// Finds all defects of a ragdoll, the most severe first.
///
/// # Panics
/// If the definition has no bodies, or its joints are not in the order of the bodies (`joints[i].child == i + 1`, each
/// parent before its child).
pub fn doctor(repair: &Repair) -> Vec<Finding> {
    let def = &repair.def;
    assert!(
        def.joints.len() + 1 == def.bodies.len()
            && def.joints.iter().enumerate().all(|(i, joint)| joint.child == i + 1 && joint.parent <= i),
        "every body but the first has one joint, to a body before it"
    );
    let mut findings = anatomy::not_finite(def);
    if findings.is_empty() {
        findings = anatomy::wrong_unit(def);
        // Other defects are only visible at the right size.
        let sized;
        let repair = if findings.is_empty() {
            repair
        } else {
            sized = anatomy::repair_in_metres(repair);
            &sized
        };
        findings.extend(in_proportion(&Exam::new(repair)));
    }
    findings.extend(repair.skin.iter().map(of_skin));
    findings.sort_by_key(|finding| (finding.severity, finding.code));
    findings
}

/// Turns a flaw of the skin into a finding. It does not count as fixed, because repairs do not measure the skin again.
fn of_skin(flaw: &Flaw) -> Finding {
    let code = match flaw.kind {
        FlawKind::Uncovered => Code::SkinUncovered,
        FlawKind::Torn => Code::SkinTorn,
        FlawKind::Lopsided => Code::SkinLopsided,
        FlawKind::Apart => Code::LimbApart,
        FlawKind::Resized => Code::DrawnResized,
        FlawKind::OffFloor => Code::SkinOffFloor,
        FlawKind::Airborne => Code::RestsInAir,
    };
    Finding {
        code,
        severity: code.severity(),
        bodies: flaw.bodies.clone(),
        bones: flaw.bones.clone(),
        evidence: flaw.evidence.clone(),
        fix: flaw.remedy.clone(),
        fixed: false,
    }
}

/// Returns findings about a ragdoll with finite numbers and a plausible size.
fn in_proportion(exam: &Exam<'_>) -> Vec<Finding> {
    let mut findings = masses::findings(exam);
    findings.extend(anatomy::missing_bodies(exam));
    findings.extend(shapes::findings(exam));
    findings.extend(anatomy::inferred(exam));
    limits::findings(exam, &mut findings);
    mirror::findings(exam, &mut findings);
    // Motion of the bodies is an effect. If the cause is known, the motion is its consequence.
    let jitter = motion::Jitter::of(exam);
    if let Some(evidence) = jitter.is_notable(exam) {
        let cause = findings.iter_mut().find(|f| f.severity == Severity::Error || f.code == Code::HugeShape);
        match cause {
            Some(cause) => cause.evidence = format!("{}; {evidence}", cause.evidence),
            None => findings.push(jitter.finding(exam, evidence)),
        }
    }
    findings
}

/// Largest number of repair rounds; each round repairs defects uncovered by the previous one.
const ROUNDS: usize = 6;

/// Repairs all findings that can be repaired. Returns the ragdoll and the findings about the input; `fixed` is true for
/// the findings that are gone.
///
/// # Panics
/// As [`doctor`].
pub fn cure(repair: &Repair) -> (Repair, Vec<Finding>) {
    let mut findings = doctor(repair);
    let mut cured = repair.clone();
    let mut open = findings.clone();
    for _ in 0..ROUNDS {
        let mut changed = false;
        for finding in &open {
            changed |= mend::mend(&mut cured, finding);
        }
        open = doctor(&cured);
        if !changed || open.is_empty() {
            break;
        }
    }
    for finding in &mut findings {
        finding.fixed = !open.iter().any(|left| left.code == finding.code && left.bones == finding.bones);
    }
    // Report effects of a repair too that cannot be repaired.
    let known = |left: &Finding| findings.iter().any(|f| f.code == left.code && f.bones == left.bones);
    let new: Vec<Finding> = open.into_iter().filter(|left| !known(left)).collect();
    findings.extend(new);
    (cured, findings)
}
