//! Symmetry of left and right: they should be mirror images of each other.

use super::exam::{Exam, beyond};
use super::geometry::longest;
use super::limits::is_marked;
use super::{Code, Finding};
use crate::def::RagdollJointDef;
use crate::doctor::tuning::{ENDS_APART, LENGTHS_APART, VOLUMES_APART, WIDTH_APART};
use sinew_math::{Mat3, Range, Rotation, SwingTwistLimit, Transform, Vec3, max, min};
use sinew_physics::{JointKind, Shape};

/// Step of the search for a joint's reach, radians (2.5°).
const STEP: f32 = 0.043_633;

/// Adds findings about asymmetric sides.
pub(super) fn findings(exam: &Exam<'_>, findings: &mut Vec<Finding>) {
    for right in 1..exam.def.bodies.len() {
        let Some(left) = exam.bones.twin(right).filter(|&left| left != 0) else { continue };
        if !exam.bones.list[right].role.is_right() {
            continue;
        }
        let is_known = |body: usize| is_marked(findings, body - 1);
        let found = if is_known(left) || is_known(right) { None } else { ranges(exam, left, right) };
        let sized = findings.iter().any(|f| {
            matches!(f.code, Code::TinyShape | Code::HugeShape)
                && (f.bodies.contains(&left) || f.bodies.contains(&right))
        });
        findings.extend(found);
        if !sized {
            findings.extend(shapes(exam, left, right));
        }
    }
}

/// Mirrors a rotation axis in x: rotations about the mirrored line are reversed.
fn mirrored_axis(axis: Vec3) -> Vec3 {
    Vec3::new(axis.x, -axis.y, -axis.z)
}

/// Returns the angle by which the child of a joint can rotate about `axis` (character axes) from the bind pose,
/// radians.
fn reach(exam: &Exam<'_>, joint: usize, axis: Vec3) -> f32 {
    let kind = &exam.def.joints[joint].kind;
    if let JointKind::Hinge { .. } = kind {
        let along = (exam.axes(joint) * Vec3::X).dot(axis);
        if along.abs() < 0.9 {
            return 0.0;
        }
    }
    let is_free = |step: &usize| {
        let turn = Rotation::from_axis_angle(axis, *step as f32 * STEP);
        let beyond = beyond(kind, exam.turned(joint, turn));
        // A slightly wrong axis rotates a hinge slightly in a locked direction, which is not a stop.
        let locked = if matches!(kind, JointKind::Fixed) { beyond.locked } else { 0.0 };
        max(beyond.limit, locked) <= 1e-3
    };
    (1..72).take_while(is_free).last().unwrap_or(0) as f32 * STEP
}

fn ranges(exam: &Exam<'_>, left: usize, right: usize) -> Option<Finding> {
    let axes = exam.axes(left - 1);
    let is_hinge = matches!(exam.def.joints[left - 1].kind, JointKind::Hinge { .. });
    for axis in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().take(if is_hinge { 1 } else { 3 }) {
        let sides = [axes * axis, axes * -axis];
        let l = sides.map(|axis| reach(exam, left - 1, axis));
        let r = sides.map(|axis| reach(exam, right - 1, mirrored_axis(axis)));
        let ends = max((l[0] - r[0]).abs(), (l[1] - r[1]).abs());
        if (l[0] + l[1] - r[0] - r[1]).abs() <= WIDTH_APART && ends <= ENDS_APART {
            continue;
        }
        let [a, b, c, d] = [l[1], l[0], r[1], r[0]].map(f32::to_degrees);
        let evidence = format!(
            "from the bind pose {} turns {a:.0}° and {b:.0}° where {} turns {c:.0}° and {d:.0}°",
            exam.who(left),
            exam.who(right),
        );
        return Some(exam.finding(Code::LimitsNotMirrored, &[right, left], evidence));
    }
    None
}

fn shapes(exam: &Exam<'_>, left: usize, right: usize) -> Option<Finding> {
    let shape = |body: usize| &exam.def.bodies[body].shape;
    let ratio = |of: fn(&Shape) -> f32| {
        let (l, r) = (of(shape(left)), of(shape(right)));
        max(l, r) / max(min(l, r), 1e-9)
    };
    let (volume, length) = (ratio(Shape::volume), ratio(longest));
    if volume <= VOLUMES_APART && length <= LENGTHS_APART {
        return None;
    }
    let cm = |body: usize| 100.0 * longest(shape(body));
    let litres = |body: usize| 1000.0 * shape(body).volume();
    let evidence = format!(
        "{} is {:.1} cm long and has {:.2} l, {} {:.1} cm and {:.2} l",
        exam.who(left),
        cm(left),
        litres(left),
        exam.who(right),
        cm(right),
        litres(right)
    );
    Some(exam.finding(Code::SidesDiffer, &[right, left], evidence))
}

/// Returns the mirror image of a frame in the plane x = `plane`: x axes keep their meaning, y and z are reversed.
pub(super) fn mirrored(frame: Transform, plane: f32) -> Transform {
    let m = frame.rotation.to_mat3();
    let turned = |v: Vec3| Vec3::new(-v.x, v.y, v.z);
    let axes = Mat3::from_cols(-turned(m.x_axis), turned(m.y_axis), turned(m.z_axis));
    let t = frame.translation;
    let translation = Vec3::new(2.0 * plane - t.x, t.y, t.z);
    Transform::new(translation, Rotation::from_mat3(&axes).normalize())
}

/// Returns the joint of a body as the mirror image of its counterpart's joint, about the body's own pivot.
pub(super) fn mirrored_joint(exam: &Exam<'_>, body: usize, twin: usize) -> RagdollJointDef {
    let def = exam.def;
    let (own, other) = (&def.joints[body - 1], &def.joints[twin - 1]);
    let plane = exam.bones.plane_of_symmetry();
    let pivot = exam.bones.list[body].head;
    let frame = |of: usize, frame: Transform, onto: usize| {
        let seen = mirrored(def.bodies[of].character_from_body * frame, plane);
        def.bodies[onto].character_from_body.inverse() * Transform::new(pivot, seen.rotation)
    };
    // With these axes a rotation about x keeps its sign in the mirror image; a rotation about y or z changes its sign.
    let turned = |range: Range| Range::new(-range.hi, -range.lo);
    let cone = |limit: SwingTwistLimit| SwingTwistLimit {
        swing_y: turned(limit.swing_y),
        swing_z: turned(limit.swing_z),
        twist: limit.twist,
    };
    let kind = match other.kind {
        JointKind::Ball { limit } => JointKind::Ball { limit: limit.map(cone) },
        JointKind::Universal { limit } => JointKind::Universal { limit: limit.map(cone) },
        kind => kind,
    };
    RagdollJointDef {
        frame_parent: frame(other.parent, other.frame_parent, own.parent),
        frame_child: frame(other.child, other.frame_child, own.child),
        kind,
        ..*own
    }
}
