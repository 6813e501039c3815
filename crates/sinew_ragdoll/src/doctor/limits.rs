//! Checks of joints: position, frames, ranges.

use super::exam::{Beyond, Exam, beyond, swing_excess};
use super::geometry::longest;
use super::{Code, Finding};
use crate::build::bones::Anatomy;
use crate::build::part::Part;
use crate::doctor::tuning::{
    BACKWARDS, BEYOND_AT_BIND, LOCKED, NARROW, NO_LIMIT, OTHER_ZERO, WIDENED_MARGIN,
};
use core::f32::consts::PI;
use sinew_math::limits::hinge_angle;
use sinew_math::{
    Mat3, Range, Rotation, SwingTwistLimit, Sym3, Transform, Vec3, any_orthonormal, max, normalize_or,
};
use sinew_physics::{JointKind, MassProperties, Softness};

/// Adds defects of joints to `findings`, which already contains the defects of their bodies.
pub(super) fn findings(exam: &Exam<'_>, findings: &mut Vec<Finding>) {
    let joints = 0..exam.def.joints.len();
    let checks: [fn(&Exam<'_>, usize) -> Option<Finding>; 4] = [frames, pivot, at_bind, missing];
    for joint in joints.clone() {
        // The first cause found explains the others.
        findings.extend(checks.iter().find_map(|check| check(exam, joint)));
    }
    let alike = all_alike(exam);
    let is_alike = |joint: usize| alike.as_ref().is_some_and(|f| f.bodies.contains(&(joint + 1)));
    for joint in joints.clone() {
        if !is_marked(findings, joint) {
            findings.extend(too_narrow(exam, joint));
            if !is_alike(joint) {
                findings.extend(both_ways(exam, joint));
            }
        }
    }
    findings.extend(alike);
    findings.extend(joints.filter_map(|joint| too_stiff(exam, joint)));
}

/// Returns true if `findings` contains a defect of the joint's frames or limits.
pub(super) fn is_marked(findings: &[Finding], joint: usize) -> bool {
    use Code::{
        AnchorsApart, BendsBothWays, IdentityFrames, LimitTooNarrow, LimitViolatedAtBind, LimitsAllAlike,
        LimitsMissing, PivotOffBone,
    };
    let of_joints = [
        IdentityFrames,
        AnchorsApart,
        PivotOffBone,
        LimitViolatedAtBind,
        LimitsMissing,
        LimitTooNarrow,
        BendsBothWays,
        LimitsAllAlike,
    ];
    findings.iter().any(|found| {
        of_joints.contains(&found.code)
            && (found.bodies.first() == Some(&(joint + 1))
                || found.code == LimitsAllAlike && found.bodies.contains(&(joint + 1)))
    })
}

/// Returns a finding about default frames or different anchors.
fn frames(exam: &Exam<'_>, index: usize) -> Option<Finding> {
    let joint = &exam.def.joints[index];
    let bodies = [joint.child, joint.parent];
    let is_identity = |frame: Transform| frame.rotation.angle_to(Rotation::IDENTITY) < 1e-3;
    let at_origin = |frame: Transform| frame.translation.length() < 1e-4 * exam.size;
    let [on_parent, on_child] = exam.anchors(index);
    let (gap, turn) = ((on_parent - on_child).length(), exam.turned(index, Rotation::IDENTITY));
    let angle = turn.angle_to(Rotation::IDENTITY);
    let both = |test: &dyn Fn(Transform) -> bool| test(joint.frame_parent) && test(joint.frame_child);
    let mut clauses = Vec::new();
    // A hinge may be bent in the bind pose: frames are wrong if they break a locked direction.
    let Beyond { limit, locked } = beyond(&joint.kind, turn);
    if both(&is_identity) && angle > OTHER_ZERO && max(limit, locked) > BEYOND_AT_BIND {
        clauses.push(format!("its zero is {:.0}° from the bind pose", angle.to_degrees()));
    }
    if both(&at_origin) && gap > 0.01 * exam.size {
        clauses.push(format!("both anchors are at the origins of the bodies, {:.0} mm apart", 1000.0 * gap));
    }
    let names = exam.between(index);
    if !clauses.is_empty() {
        let evidence =
            format!("the joint between {names} has frames without rotation: {}", clauses.join("; "));
        return Some(exam.finding(Code::IdentityFrames, &bodies, evidence));
    }
    (gap > 0.003 * exam.size).then(|| {
        let evidence = format!("the anchors on {names} are {:.0} mm apart in the bind pose", 1000.0 * gap);
        exam.finding(Code::AnchorsApart, &bodies, evidence)
    })
}

/// Returns a finding about a pivot away from the start of its bone: far from the rig's pivot, or at the parent's origin
/// and outside the child.
fn pivot(exam: &Exam<'_>, index: usize) -> Option<Finding> {
    let joint = &exam.def.joints[index];
    let (pivot, child) = (exam.bones.list[joint.child].head, &exam.def.bodies[joint.child]);
    let (outside, _) = child.shape.signed_distance(&child.character_from_body, pivot);
    let bodies = [joint.child, joint.parent];
    let names = exam.between(index);
    if let Some(head) = head_of_rig(exam, joint.child) {
        let off = (head - pivot).length();
        return (off > 0.03 * exam.size).then(|| {
            let evidence = format!(
                "the joint between {names} is {:.0} mm from the head of the rig's bone",
                1000.0 * off
            );
            exam.finding(Code::PivotOffBone, &bodies, evidence)
        });
    }
    let at_parent = joint.frame_parent.translation.length() < 0.005 * exam.size;
    let far = outside > 0.06 * exam.size + 0.5 * longest(&child.shape);
    (far || at_parent && outside > 0.01 * exam.size).then(|| {
        let at = if at_parent { ", at the middle of the parent" } else { "" };
        let evidence =
            format!("the joint between {names} is {:.0} mm outside the child{at}", 1000.0 * outside);
        exam.finding(Code::PivotOffBone, &bodies, evidence)
    })
}

/// Returns the start of a body's bone in the rig, character space; `None` without the rig or the joint.
pub(super) fn head_of_rig(exam: &Exam<'_>, body: usize) -> Option<Vec3> {
    let rig = exam.repair.reference.as_ref()?;
    let bone = &exam.def.bodies[body].bone;
    let found = rig.bodies.iter().position(|other| other.bone == *bone)?;
    let joint = rig.joints.get(found.checked_sub(1)?)?;
    Some(super::exam::anchors(rig, joint)[1])
}

fn at_bind(exam: &Exam<'_>, index: usize) -> Option<Finding> {
    let joint = &exam.def.joints[index];
    let Beyond { limit, locked } = beyond(&joint.kind, exam.turned(index, Rotation::IDENTITY));
    if max(limit, locked) <= BEYOND_AT_BIND {
        return None;
    }
    let what = if limit >= locked { "beyond its limits" } else { "turned where it does not turn" };
    let evidence = format!(
        "the joint between {} is {:.0}° {what} in the bind pose",
        exam.between(index),
        max(limit, locked).to_degrees()
    );
    Some(exam.finding(Code::LimitViolatedAtBind, &[joint.child, joint.parent], evidence))
}

fn width(range: Range) -> f32 {
    range.hi - range.lo
}

/// Returns true if some direction of a joint has no effective limit.
pub(super) fn is_unlimited(kind: &JointKind) -> bool {
    match kind {
        JointKind::Ball { limit: None }
        | JointKind::Universal { limit: None }
        | JointKind::Hinge { limit: None } => true,
        kind => ranges(kind).iter().any(|(_, range)| width(*range) > NO_LIMIT),
    }
}

fn missing(exam: &Exam<'_>, index: usize) -> Option<Finding> {
    let joint = &exam.def.joints[index];
    if !is_unlimited(&joint.kind) {
        return None;
    }
    let shown = |(what, range): &(&str, Range)| {
        let [lo, hi] = [range.lo, range.hi].map(f32::to_degrees);
        format!("{what} from {lo:.0} to {hi:.0}°")
    };
    let known = ranges(&joint.kind);
    let wide: Vec<String> = known.iter().filter(|(_, range)| width(*range) > NO_LIMIT).map(shown).collect();
    let clauses = if wide.is_empty() { "no limits".to_owned() } else { wide.join(", ") };
    let evidence = format!("the joint between {} has {clauses}", exam.between(index));
    Some(exam.finding(Code::LimitsMissing, &[joint.child, joint.parent], evidence))
}

/// Returns the name and range of each free direction of a joint.
fn ranges(kind: &JointKind) -> Vec<(&'static str, Range)> {
    match *kind {
        JointKind::Ball { limit: Some(l) } => {
            vec![("swing about y", l.swing_y), ("swing about z", l.swing_z), ("twist", l.twist)]
        }
        JointKind::Universal { limit: Some(l) } => {
            vec![("swing about y", l.swing_y), ("swing about z", l.swing_z)]
        }
        JointKind::Hinge { limit: Some(range) } => vec![("the hinge", range)],
        _ => Vec::new(),
    }
}

/// Returns true if a range is too narrow to move in but not locked.
pub(super) fn is_narrow(range: Range) -> bool {
    (LOCKED..NARROW).contains(&width(range))
}

fn too_narrow(exam: &Exam<'_>, index: usize) -> Option<Finding> {
    let joint = &exam.def.joints[index];
    let (what, range) = ranges(&joint.kind).into_iter().find(|(_, range)| is_narrow(*range))?;
    let evidence = format!(
        "{what} between {} has a range of {:.1}°, below {:.0}°",
        exam.between(index),
        width(range).to_degrees(),
        NARROW.to_degrees()
    );
    Some(exam.finding(Code::LimitTooNarrow, &[joint.child, joint.parent], evidence))
}

/// Returns a finding if most joints of a human have the same range.
fn all_alike(exam: &Exam<'_>) -> Option<Finding> {
    if exam.bones.anatomy != Anatomy::Human {
        return None;
    }
    let cones: Vec<(usize, SwingTwistLimit)> = exam
        .def
        .joints
        .iter()
        .filter_map(|joint| match joint.kind {
            // Unlimited joints have a finding of their own.
            JointKind::Ball { limit: Some(limit) } if width(limit.twist) <= NO_LIMIT => {
                Some((joint.child, limit))
            }
            _ => None,
        })
        .collect();
    let near = |a: Range, b: Range| (a.lo - b.lo).abs() + (a.hi - b.hi).abs() < 0.02;
    let same = |a: &SwingTwistLimit, b: &SwingTwistLimit| {
        near(a.swing_y, b.swing_y) && near(a.swing_z, b.swing_z) && near(a.twist, b.twist)
    };
    let alike = |limit: &SwingTwistLimit| -> Vec<usize> {
        cones.iter().filter(|(_, other)| same(limit, other)).map(|(body, _)| *body).collect()
    };
    let largest =
        cones.iter().map(|(_, limit)| (alike(limit), limit)).max_by_key(|(group, _)| group.len())?;
    let (bodies, limit) = largest;
    let is_hinge = |&body: &usize| matches!(exam.part(body), Part::Forearm | Part::Shank);
    let all = exam.def.joints.len();
    if bodies.len() < 5 || 10 * bodies.len() < 6 * all || !bodies.iter().any(is_hinge) {
        return None;
    }
    let half = |range: Range| 0.5 * width(range).to_degrees();
    let evidence = format!(
        "{} of {all} joints have the same cone of {:.0}° by {:.0}° and ±{:.0}° of twist, {} among them",
        bodies.len(),
        half(limit.swing_y),
        half(limit.swing_z),
        half(limit.twist),
        bodies.iter().copied().find(|body| is_hinge(body)).map_or(String::new(), |body| exam.who(body)),
    );
    Some(exam.finding(Code::LimitsAllAlike, &bodies, evidence))
}

/// Returns a finding about a knee or elbow that bends as far backwards as forwards.
fn both_ways(exam: &Exam<'_>, index: usize) -> Option<Finding> {
    let joint = &exam.def.joints[index];
    let parts = (exam.part(joint.parent), exam.part(joint.child));
    if !matches!(parts, (Part::UpperArm, Part::Forearm) | (Part::Thigh, Part::Shank)) {
        return None;
    }
    // A bind pose bent past straight needs that much of the range.
    let mut needed = 0.0;
    let mut fix = None;
    let (back, on) = match joint.kind {
        JointKind::Hinge { limit: Some(range) } => {
            let straight = straight_angle(exam, index);
            let bound = hinge_angle(exam.turned(index, Rotation::IDENTITY).swing_twist(Vec3::X).1);
            let is_forward = range.hi - straight >= straight - range.lo;
            needed = max(if is_forward { straight - bound } else { bound - straight }, 0.0) + WIDENED_MARGIN;
            let end = straight + if is_forward { -needed } else { needed };
            let (lo, hi) = if is_forward { (end, range.hi) } else { (range.lo, end) };
            let [lo, hi] = [lo.to_degrees().floor(), hi.to_degrees().ceil()];
            fix = Some(format!(
                "Let it bend one way only: `limits_deg` of {} with `\"twist\": [{lo:.0}, {hi:.0}]`, in which its bind pose lies.",
                exam.def.bodies[joint.child].bone
            ));
            (straight - range.lo, range.hi - straight)
        }
        JointKind::Ball { limit: Some(limit) } | JointKind::Universal { limit: Some(limit) } => {
            cone_both_ways(exam, index, &limit)
        }
        _ => return None,
    };
    // Ranges wider than half a turn come from wrapped angles.
    if sinew_math::min(back, on) <= max(BACKWARDS, needed + 0.5 * WIDENED_MARGIN) {
        return None;
    }
    let evidence = format!(
        "{} bends {:.0}° one way and {:.0}° the other from straight",
        exam.who(joint.child),
        max(back, on).to_degrees(),
        sinew_math::min(back, on).to_degrees()
    );
    let mut found = exam.finding(Code::BendsBothWays, &[joint.child, joint.parent], evidence);
    found.fix = fix.unwrap_or(found.fix);
    Some(found)
}

/// Returns the angle of a hinge at which its two bones are in line, radians.
pub(super) fn straight_angle(exam: &Exam<'_>, index: usize) -> f32 {
    let joint = &exam.def.joints[index];
    let axis = exam.axes(index) * Vec3::X;
    let now = hinge_angle(exam.turned(index, Rotation::IDENTITY).swing_twist(Vec3::X).1);
    let flat = |body: usize| {
        let along = exam.direction(body);
        along - axis * axis.dot(along)
    };
    let (from, to) = (flat(joint.child), flat(joint.parent));
    let turn = sinew_math::trig::atan2(axis.dot(from.cross(to)), from.dot(to));
    sinew_math::limits::wrap(now + turn)
}

/// Returns the angles by which a cone lets the bone bend to either side of straight, radians. The bend is about the
/// axis for which the smaller of the two angles is largest.
fn cone_both_ways(exam: &Exam<'_>, index: usize, limit: &SwingTwistLimit) -> (f32, f32) {
    let joint = &exam.def.joints[index];
    let [parent, child] = [joint.parent, joint.child].map(|body| exam.direction(body));
    let straight = Rotation::from_arc(child, parent);
    let (u, steps) = (any_orthonormal(parent), 12_usize);
    let reach = |axis: Vec3| {
        (1..=30_usize)
            .map(|step| step as f32 * PI / 36.0)
            .take_while(|&angle| {
                let turn = Rotation::from_axis_angle(axis, angle) * straight;
                swing_excess(limit, exam.turned(index, turn)) <= BEYOND_AT_BIND
            })
            .last()
            .unwrap_or(0.0)
    };
    let mut widest = (0.0, 0.0);
    for step in 0..steps {
        let around = Rotation::from_axis_angle(parent, step as f32 * PI / steps as f32);
        let axis = normalize_or(around * u, u);
        let found = (reach(-axis), reach(axis));
        if sinew_math::min(found.0, found.1) > sinew_math::min(widest.0, widest.1) {
            widest = found;
        }
    }
    widest
}

fn too_stiff(exam: &Exam<'_>, index: usize) -> Option<Finding> {
    let softness = (*exam.repair.springs.get(index)?)?;
    let joint = &exam.def.joints[index];
    let hertz = hertz(exam, index, softness);
    let nyquist = 0.5 / exam.repair.substep;
    // The comparison is written so that NaN is a finding.
    if hertz <= nyquist {
        return None;
    }
    let evidence = format!(
        "the spring between {} swings at {hertz:.0} Hz; a substep of {:.2} ms can follow {nyquist:.0} Hz",
        exam.between(index),
        1000.0 * exam.repair.substep
    );
    Some(exam.finding(Code::StiffnessAboveNyquist, &[joint.child, joint.parent], evidence))
}

/// Returns the frequency of a joint's spring, with each side of the joint as one rigid piece, Hz.
pub(super) fn hertz(exam: &Exam<'_>, index: usize, softness: Softness) -> f32 {
    let Softness::Stiffness { stiffness, .. } = softness else {
        let Softness::Frequency { hertz, .. } = softness else { return 0.0 };
        return hertz;
    };
    (stiffness / turning_inertia(exam, index)).sqrt() / (2.0 * PI)
}

/// Returns the least inertia of the relative motion of a joint's two bodies, kg·m².
pub(super) fn turning_inertia(exam: &Exam<'_>, index: usize) -> f32 {
    let child = exam.def.joints[index].child;
    let mut below = vec![false; exam.def.bodies.len()];
    below[child] = true;
    let mut sides = [MassProperties::default(); 2];
    for (body, def) in exam.def.bodies.iter().enumerate() {
        below[body] = below[body] || exam.bones.list[body].parent.is_some_and(|parent| below[parent]);
        let side = &mut sides[usize::from(below[body])];
        *side = side.combine(&def.mass.transformed(&def.character_from_body));
    }
    let pivot = exam.bones.list[child].head;
    // Use the axis with the least inertia: bodies in line with the pivot add no inertia about that line.
    let [above, below] = sides.map(|side| {
        let arm = side.center - pivot;
        let about_pivot = side.inertia.to_mat3()
            + (Mat3::from_diagonal(Vec3::splat(arm.dot(arm))) - Sym3::outer(arm).to_mat3()) * side.mass;
        Sym3::from_mat3(&about_pivot).eigen().0.z
    });
    above * below / (above + below)
}
