//! Checks of the body as a whole: finite, of plausible size, with a head and limbs.

use super::exam::{Exam, bones_of};
use super::{Code, Finding, Repair, Severity};
use crate::build::bones::Anatomy;
use crate::build::part::{Part, Side, part_of_role};
use crate::def::RagdollDef;
use crate::doctor::tuning::{UNCERTAIN, USUAL_HEIGHT};
use crate::masses::de_leva::Sex;
use crate::masses::default_mass;
use sinew_anim::roles::Role;
use sinew_math::{Transform, max};
use sinew_physics::JointKind;

/// Heights of characters that fall like people, metres.
const HEIGHTS: core::ops::RangeInclusive<f32> = 0.3..=5.0;
/// Heights of creatures, from a mouse to an upright whale, metres.
const CREATURES: core::ops::RangeInclusive<f32> = 0.05..=30.0;
/// Heights that a human may have, metres.
const HUMAN: core::ops::RangeInclusive<f32> = 0.5..=3.0;
/// Lengths of units that files get wrong, metres, with their names.
const UNITS: [(f32, &str); 6] = [
    (0.01, "centimetres"),
    (0.0254, "inches"),
    (0.001, "millimetres"),
    (0.3048, "feet"),
    (100.0, "hundreds of metres"),
    (39.37, "metres taken as inches"),
];

/// Returns findings about bodies and joints with numbers that are not finite.
pub(super) fn not_finite(def: &RagdollDef) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut find = |body: usize, what: String| {
        findings.push(Finding {
            code: Code::NotFinite,
            severity: Severity::Error,
            bodies: vec![body],
            bones: vec![def.bodies[body].bone.clone()],
            evidence: what,
            fix: Code::NotFinite.fix().to_owned(),
            fixed: false,
        });
    };
    for (index, body) in def.bodies.iter().enumerate() {
        let name = &body.role;
        if !body.character_from_body.is_finite() {
            find(index, format!("the pose of {name} is not finite"));
        }
        if let Err(what) = body.shape.check() {
            find(index, format!("the shape of {name}: {what}"));
        }
    }
    for joint in &def.joints {
        let names = format!("{} and {}", def.bodies[joint.parent].role, def.bodies[joint.child].role);
        if !(joint.frame_parent.is_finite() && joint.frame_child.is_finite()) {
            find(joint.child, format!("a frame of the joint between {names} is not finite"));
        }
        if !limits_are_numbers(&joint.kind) {
            find(joint.child, format!("a limit between {names} is not finite, or its ends are exchanged"));
        }
    }
    if !(def.height.is_finite() && def.height > 0.0) {
        find(0, format!("a height of {} m", def.height));
    }
    findings
}

fn limits_are_numbers(kind: &JointKind) -> bool {
    match kind {
        JointKind::Ball { limit } | JointKind::Universal { limit } => limit.is_none_or(|limit| {
            [limit.swing_y, limit.swing_z].iter().all(|range| range.lo <= 0.0 && range.hi >= 0.0)
                && limit.twist.lo <= limit.twist.hi
        }),
        JointKind::Hinge { limit } => limit.is_none_or(|range| range.lo <= range.hi),
        _ => true,
    }
}

/// Returns a finding about a height that no character has.
pub(super) fn wrong_unit(def: &RagdollDef) -> Vec<Finding> {
    if heights(def).contains(&def.height) {
        return Vec::new();
    }
    let (factor, unit) = unit_of(def);
    let evidence = format!(
        "{} is {:.4} m high; {unit} would make it {:.2} m",
        def.bodies[0].bone,
        def.height,
        def.height * factor
    );
    vec![Finding {
        code: Code::WrongUnit,
        severity: Severity::Error,
        bodies: vec![0],
        bones: vec![def.bodies[0].bone.clone()],
        evidence,
        fix: Code::WrongUnit.fix().to_owned(),
        fixed: false,
    }]
}

fn heights(def: &RagdollDef) -> core::ops::RangeInclusive<f32> {
    if bones_of(def).anatomy == Anatomy::Human { HEIGHTS } else { CREATURES }
}

/// Converts the ragdoll to metres, and also its rig if it was read in the same unit.
pub(super) fn repair_in_metres(repair: &Repair) -> Repair {
    let def = in_metres(&repair.def);
    let is_same = |rig: &RagdollDef| (0.5..2.0).contains(&(rig.height / repair.def.height));
    let reference =
        repair.reference.as_ref().map(|rig| if is_same(rig) { in_metres(rig) } else { rig.clone() });
    Repair { def, reference, ..repair.clone() }
}

/// Returns the factor on all lengths, and the name of the assumed unit.
fn unit_of(def: &RagdollDef) -> (f32, String) {
    // Choose the unit whose height is closest to a person's; for a creature use any that gives a plausible size.
    let human = bones_of(def).anatomy == Anatomy::Human;
    let heights = if human { HUMAN } else { HEIGHTS };
    let ratio = |factor: f32| max(def.height * factor / USUAL_HEIGHT, USUAL_HEIGHT / (def.height * factor));
    let known = UNITS.iter().filter(|(factor, _)| heights.contains(&(def.height * factor)));
    let nearest = known.reduce(|best, one| if ratio(one.0) < ratio(best.0) { one } else { best });
    nearest.map_or_else(
        || (USUAL_HEIGHT / def.height, format!("a unit of {:.3} mm", 1000.0 * USUAL_HEIGHT / def.height)),
        |&(factor, name)| (factor, name.to_owned()),
    )
}

/// Returns the definition in metres, with the natural mass of a body of that size if the old mass was not natural.
fn in_metres(def: &RagdollDef) -> RagdollDef {
    let (factor, _) = unit_of(def);
    let mut def = def.clone();
    let place = |at: Transform| Transform { translation: at.translation * factor, ..at };
    for body in &mut def.bodies {
        body.character_from_body = place(body.character_from_body);
        body.shape = super::geometry::scaled(&body.shape, factor);
        body.mass.center *= factor;
        body.mass.inertia = body.mass.inertia * (factor * factor);
    }
    for joint in &mut def.joints {
        joint.frame_parent = place(joint.frame_parent);
        joint.frame_child = place(joint.frame_child);
    }
    def.height *= factor;
    def.unit_scale *= factor;
    def.character_from_model = place(def.character_from_model);
    // A mass derived from the wrong height is wrong, too.
    let natural = default_mass(def.height, Sex::Male);
    let ratio = natural / def.total_mass;
    if !(0.2..5.0).contains(&ratio) {
        super::masses::scale_all(&mut def, ratio);
    }
    def
}

/// Returns findings about a head or limbs without a body. The rig decides which are expected, if it is given; otherwise
/// a human's are.
pub(super) fn missing_bodies(exam: &Exam<'_>) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (role, parent_is_there) in expected(exam) {
        let (part, _) = part_of_role(role);
        let code = if part == Part::Head { Code::HeadWithoutBody } else { Code::LimbWithoutBody };
        let known = exam.repair.reference.as_ref();
        let bone = known.and_then(|rig| rig.bodies.iter().find(|body| body.role == role.name()));
        if known.is_some() && bone.is_none() {
            // The rig has no bone for such a body.
            continue;
        }
        let above =
            parent_is_there.map_or(String::new(), |body| format!("; the chain ends at {}", exam.who(body)));
        let of_rig =
            bone.map_or(String::new(), |body| format!(", though the rig has the bone `{}`", body.bone));
        let evidence = format!("no body for {}{of_rig}{above}", role.name());
        let mut finding = exam.finding(code, &[], evidence);
        finding.bodies.extend(parent_is_there);
        finding.bones = vec![role.name()];
        findings.push(finding);
    }
    findings
}

/// Returns a human's roles without a body, each with its parent body; of a limb only the first.
fn expected(exam: &Exam<'_>) -> Vec<(Role, Option<usize>)> {
    use sinew_anim::roles::Side::{Left, Right};
    if exam.bones.anatomy != Anatomy::Human {
        return Vec::new();
    }
    let body = |role: Role| exam.bones.list.iter().position(|bone| bone.role == role);
    let middle = |part: Part| exam.bones.list.iter().rposition(|b| b.part == part && b.side == Side::Middle);
    let trunk = middle(Part::Spine).or(Some(0));
    let mut missing = Vec::new();
    if body(Role::Head).is_none() {
        missing.push((Role::Head, middle(Part::Neck).or(trunk)));
    }
    for side in [Left, Right] {
        let arm = [Role::UpperArm(side), Role::LowerArm(side), Role::Hand(side)];
        let leg = [Role::UpperLeg(side), Role::LowerLeg(side), Role::Foot(side)];
        for (chain, root) in [(arm, body(Role::Shoulder(side)).or(trunk)), (leg, Some(0))] {
            let mut above = root;
            for (at, role) in chain.into_iter().enumerate() {
                match body(role) {
                    Some(found) => above = Some(found),
                    // Hands and feet may lack bodies on both sides; on one side it is a mistake.
                    None if at == 2 && body(role.mirror()).is_none() && exam.repair.reference.is_none() => {}
                    None => {
                        missing.push((role, above));
                        break;
                    }
                }
            }
        }
    }
    missing
}

/// Returns findings about assumptions that may be wrong.
pub(super) fn inferred(exam: &Exam<'_>) -> Vec<Finding> {
    let mut findings = Vec::new();
    let unit = exam.def.unit_scale;
    if !(0.98..1.02).contains(&unit) {
        let evidence = format!(
            "{:.3} m high with a unit of {unit:.4} m: {:.1} units in the file",
            exam.size,
            exam.size / unit
        );
        findings.push(exam.finding(Code::UnitInferred, &[0], evidence));
    }
    for (index, body) in exam.def.bodies.iter().enumerate() {
        let is_human = exam.bones.anatomy == Anatomy::Human;
        if is_human && body.confidence < UNCERTAIN {
            let evidence = format!("{} with a confidence of {:.2}", exam.who(index), body.confidence);
            findings.push(exam.finding(Code::RoleUncertain, &[index], evidence));
        }
    }
    findings
}
