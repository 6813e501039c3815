//! One repair per finding.

use super::exam::{Exam, anchors, beyond};
use super::geometry::{depth, full_size, longest, scaled};
use super::limits::{head_of_rig, is_narrow, turning_inertia};
use super::{Code, Finding, Repair, anatomy, masses, mirror, missing_bodies, shapes};
use crate::def::{RagdollDef, RagdollJointDef};
use crate::doctor::tuning::{CHAIN_RATIO, NEIGHBOUR_RATIO, STRAIN, THIN, WIDENED_MARGIN};
use crate::ragdoll::fitted;
use core::f32::consts::PI;
use sinew_math::{Mat3, Range, Rotation, SwingTwistLimit, Transform, Vec3, max, min};
use sinew_physics::{JointKind, Shape, Softness};

/// Repairs a finding; returns false if nothing could be done.
pub(super) fn mend(repair: &mut Repair, finding: &Finding) -> bool {
    let Some(&body) = finding.bodies.first() else { return false };
    let other = finding.bodies.get(1).copied().unwrap_or(body);
    match finding.code {
        // Numbers that are not finite cannot be recovered, and only a person can confirm a guess.
        Code::NotFinite | Code::UnitInferred | Code::RoleUncertain => false,
        Code::WrongUnit => {
            *repair = anatomy::repair_in_metres(repair);
            true
        }
        Code::HeadWithoutBody | Code::LimbWithoutBody => {
            missing_bodies::add_missing(repair, &finding.bones[0])
        }
        Code::StiffnessAboveNyquist => soften(repair, body - 1),
        _ => {
            let changed = remedied(&Exam::new(repair), finding, body, other);
            let is_new = changed.as_ref().is_some_and(|def| *def != repair.def);
            if let Some(def) = changed {
                repair.def = def;
            }
            is_new
        }
    }
}

/// Returns the definition with one finding repaired.
fn remedied(exam: &Exam<'_>, finding: &Finding, body: usize, other: usize) -> Option<RagdollDef> {
    let mut def = exam.def.clone();
    let joint = body.checked_sub(1);
    match finding.code {
        Code::MassNotPositive => {
            def.bodies[body].mass = natural(exam, body);
            def.total_mass = def.bodies.iter().map(|body| body.mass.mass).sum();
        }
        Code::IdentityFrames | Code::AnchorsApart | Code::PivotOffBone => {
            def.joints[joint?] = moved(exam, joint?, finding.code);
        }
        Code::LimitViolatedAtBind => def.joints[joint?] = holding_bind(exam, joint?),
        Code::LimitsMissing | Code::BendsBothWays => {
            def.joints[joint?] = exam.anatomical(joint?).def;
        }
        Code::LimitsAllAlike => {
            for &body in &finding.bodies {
                def.joints[body - 1] = exam.anatomical(body - 1).def;
            }
        }
        Code::LimitTooNarrow => def.joints[joint?] = locked(exam, joint?),
        Code::LimitsNotMirrored => mirror_joint(exam, &mut def, body, other),
        Code::SidesDiffer => mirror_shape(exam, &mut def, body, other),
        Code::OverlapAtStart | Code::CollisionFightsLimit => disable(&mut def, body, other),
        Code::MovesByItself => settle(exam, &mut def, body)?,
        Code::NoSelfCollision => {
            let clear = shapes::limbs_and_trunk(exam);
            let is_clear = |&(a, b): &(usize, usize)| clear.contains(&(a, b)) || clear.contains(&(b, a));
            def.disabled_pairs.retain(|pair| !is_clear(pair));
        }
        Code::TinyShape | Code::HugeShape => resize(exam, &mut def, body),
        Code::MassRatio => {
            let is_neighbour = exam.bones.list[body].parent == Some(other);
            let most = if is_neighbour { NEIGHBOUR_RATIO } else { CHAIN_RATIO };
            masses::limit_mass_ratio(&mut def, [body, other], 0.9 * most);
        }
        Code::MassImplausible => {
            let sum: f32 = def.bodies.iter().map(|body| body.mass.mass).sum();
            masses::scale_all(&mut def, masses::natural_mass(exam) / sum);
        }
        Code::InertiaOutOfProportion => {
            let center = def.bodies[body].mass.center;
            let mass = masses::of_shape(&def.bodies[body].shape, def.bodies[body].mass.mass);
            def.bodies[body].mass = sinew_physics::MassProperties { center, ..mass };
        }
        Code::NotFinite
        | Code::UnitInferred
        | Code::RoleUncertain
        | Code::WrongUnit
        | Code::HeadWithoutBody
        | Code::LimbWithoutBody
        | Code::SkinUncovered
        | Code::SkinTorn
        | Code::SkinLopsided
        | Code::LimbApart
        | Code::DrawnResized
        | Code::SkinOffFloor
        | Code::RestsInAir
        | Code::StiffnessAboveNyquist => return None,
    }
    Some(def)
}

/// Returns mass and inertia by the body's share of the volume of all bodies.
fn natural(exam: &Exam<'_>, body: usize) -> sinew_physics::MassProperties {
    let volume = |body: &crate::def::RagdollBodyDef| body.shape.volume();
    let all: f32 = exam.def.bodies.iter().map(volume).sum();
    let shape = &exam.def.bodies[body].shape;
    masses::of_shape(shape, masses::natural_mass(exam) * shape.volume() / all)
}

/// Returns the joint with both frames at one pivot; with `IdentityFrames` also with the anatomical axes and range.
fn moved(exam: &Exam<'_>, index: usize, code: Code) -> RagdollJointDef {
    let joint = exam.def.joints[index];
    let [on_parent, on_child] = exam.anchors(index);
    let end = near_end(exam, index);
    let pivot = head_of_rig(exam, joint.child).unwrap_or_else(|| match code {
        // Use the anchor nearer to the start of the child.
        Code::AnchorsApart if (on_parent - end).length() < (on_child - end).length() => on_parent,
        Code::AnchorsApart => on_child,
        Code::IdentityFrames if (on_parent - on_child).length() < 0.003 * exam.size => on_child,
        _ => end,
    });
    let place = |body: usize, rotation: Rotation| {
        exam.def.bodies[body].character_from_body.inverse() * Transform::new(pivot, rotation)
    };
    let world =
        |body: usize, frame: Transform| exam.def.bodies[body].character_from_body.rotation * frame.rotation;
    let mut new = joint;
    new.frame_parent = place(joint.parent, world(joint.parent, joint.frame_parent));
    new.frame_child = place(joint.child, world(joint.child, joint.frame_child));
    if code == Code::IdentityFrames {
        let mut def = exam.def.clone();
        def.joints[index] = new;
        let repair = Repair { def, ..exam.repair.clone() };
        new = Exam::new(&repair).anatomical(index).def;
    }
    new
}

/// Returns the end of the child's shape nearer to the parent, character space, which is where the bone must begin.
fn near_end(exam: &Exam<'_>, index: usize) -> Vec3 {
    let joint = &exam.def.joints[index];
    let child = &exam.def.bodies[joint.child];
    let half = full_size(&child.shape) * 0.5;
    // Put the point slightly inside the shape, where a bone begins.
    let along = if half.y >= half.x && half.y >= half.z {
        Vec3::Y * (0.9 * half.y)
    } else if half.x >= half.z {
        Vec3::X * (0.9 * half.x)
    } else {
        Vec3::Z * (0.9 * half.z)
    };
    let ends = [along, -along].map(|end| child.character_from_body.point(end));
    let parent = &exam.def.bodies[joint.parent];
    let [a, b] = ends.map(|end| parent.shape.signed_distance(&parent.character_from_body, end).0);
    if a < b { ends[0] } else { ends[1] }
}

/// Returns the joint with limits that contain the bind pose, and frames that agree in the bind pose along locked
/// directions.
fn holding_bind(exam: &Exam<'_>, index: usize) -> RagdollJointDef {
    let joint = exam.def.joints[index];
    let pose = |body: usize| exam.def.bodies[body].character_from_body;
    let mut new = fitted(&joint, pose(joint.parent), pose(joint.child));
    let wider =
        |range: Range| Range::new(max(range.lo - WIDENED_MARGIN, -PI), min(range.hi + WIDENED_MARGIN, PI));
    let cone = |limit: SwingTwistLimit, old: SwingTwistLimit| {
        let side = |new: Range, old: Range| if new == old { new } else { wider(new) };
        SwingTwistLimit {
            swing_y: side(limit.swing_y, old.swing_y),
            swing_z: side(limit.swing_z, old.swing_z),
            twist: side(limit.twist, old.twist),
        }
    };
    new.kind = match (new.kind, joint.kind) {
        (JointKind::Ball { limit: Some(l) }, JointKind::Ball { limit: Some(old) }) => {
            JointKind::Ball { limit: Some(cone(l, old)) }
        }
        (JointKind::Universal { limit: Some(l) }, JointKind::Universal { limit: Some(old) }) => {
            JointKind::Universal { limit: Some(cone(l, old)) }
        }
        (JointKind::Hinge { limit: Some(r) }, JointKind::Hinge { limit: Some(old) }) if r != old => {
            JointKind::Hinge { limit: Some(wider(r)) }
        }
        (kind, _) => kind,
    };
    debug_assert!(anchors(exam.def, &new)[1].is_finite());
    new
}

/// Returns the joint with its narrow directions locked: a ball becomes a hinge, a universal joint or a weld.
fn locked(exam: &Exam<'_>, index: usize) -> RagdollJointDef {
    let joint = exam.def.joints[index];
    let turned_x_to = |axis: Vec3| {
        let (y, z) = if axis == Vec3::Y { (Vec3::Z, Vec3::X) } else { (Vec3::X, Vec3::Y) };
        Rotation::from_mat3(&Mat3::from_cols(axis, y, z))
    };
    let shut = Range::new(0.0, 0.0);
    let open = |range: Range| !is_narrow(range) && range.hi - range.lo > 0.01;
    let kind = match joint.kind {
        JointKind::Ball { limit: Some(l) } => match [l.swing_y, l.swing_z, l.twist].map(open) {
            [false, false, false] => JointKind::Fixed,
            [false, false, true] => JointKind::Hinge { limit: Some(l.twist) },
            [true, true, _] => JointKind::Universal { limit: Some(SwingTwistLimit { twist: shut, ..l }) },
            [true, false, false] => return hinge_about(exam, index, turned_x_to(Vec3::Y), l.swing_y),
            [false, true, false] => return hinge_about(exam, index, turned_x_to(Vec3::Z), l.swing_z),
            // No joint kind swings about only one axis and also twists, so the narrow swing is widened until it is
            // stable.
            [true, false, true] => {
                JointKind::Ball { limit: Some(SwingTwistLimit { swing_z: quiet(l.swing_z), ..l }) }
            }
            [false, true, true] => {
                JointKind::Ball { limit: Some(SwingTwistLimit { swing_y: quiet(l.swing_y), ..l }) }
            }
        },
        JointKind::Universal { limit: Some(l) } => match [l.swing_y, l.swing_z].map(open) {
            [false, false] => JointKind::Fixed,
            [true, false] => return hinge_about(exam, index, turned_x_to(Vec3::Y), l.swing_y),
            [false, true] => return hinge_about(exam, index, turned_x_to(Vec3::Z), l.swing_z),
            [true, true] => joint.kind,
        },
        JointKind::Hinge { .. } => JointKind::Fixed,
        kind => kind,
    };
    at_bind(exam, RagdollJointDef { kind, ..joint })
}

/// Widens a range to at least ±5°, because narrower limits make the joint unstable.
fn quiet(range: Range) -> Range {
    Range::new(min(range.lo, -0.09), max(range.hi, 0.09))
}

/// Changes a joint into a hinge about another of its axes.
fn hinge_about(exam: &Exam<'_>, index: usize, axes: Rotation, range: Range) -> RagdollJointDef {
    let joint = exam.def.joints[index];
    let turned = |frame: Transform| Transform { rotation: frame.rotation * axes, ..frame };
    at_bind(
        exam,
        RagdollJointDef {
            frame_parent: turned(joint.frame_parent),
            frame_child: turned(joint.frame_child),
            kind: JointKind::Hinge { limit: Some(range) },
            ..joint
        },
    )
}

/// Fits a joint to the bind pose, so that its locked directions are locked there.
fn at_bind(exam: &Exam<'_>, joint: RagdollJointDef) -> RagdollJointDef {
    let pose = |body: usize| exam.def.bodies[body].character_from_body;
    fitted(&joint, pose(joint.parent), pose(joint.child))
}

/// Gives a joint of one side of the body the range of its counterpart: the range that is further from the anatomical
/// one changes.
fn mirror_joint(exam: &Exam<'_>, def: &mut RagdollDef, a: usize, b: usize) {
    let strangeness = |body: usize| {
        let anatomical = exam.anatomical(body - 1).def.kind;
        span(&exam.def.joints[body - 1].kind, &anatomical)
    };
    let (wrong, right) = if strangeness(a) >= strangeness(b) { (a, b) } else { (b, a) };
    let joint = mirror::mirrored_joint(exam, wrong, right);
    let pose = |body: usize| exam.def.bodies[body].character_from_body;
    // If the two sides are bound differently the mirrored range must still contain the bind pose.
    let seen = {
        let parent = pose(joint.parent).rotation * joint.frame_parent.rotation;
        parent.inverse() * (pose(joint.child).rotation * joint.frame_child.rotation)
    };
    let out = beyond(&joint.kind, seen);
    def.joints[wrong - 1] = if max(out.limit, out.locked) > 0.01 { at_bind(exam, joint) } else { joint };
}

/// Returns the sum of the distances between the ends of two limits, radians; a large value for different kinds.
fn span(a: &JointKind, b: &JointKind) -> f32 {
    let apart = |a: Range, b: Range| (a.lo - b.lo).abs() + (a.hi - b.hi).abs();
    match (a, b) {
        (JointKind::Ball { limit: Some(a) }, JointKind::Ball { limit: Some(b) })
        | (JointKind::Universal { limit: Some(a) }, JointKind::Universal { limit: Some(b) }) => {
            apart(a.swing_y, b.swing_y) + apart(a.swing_z, b.swing_z) + apart(a.twist, b.twist)
        }
        (JointKind::Hinge { limit: Some(a) }, JointKind::Hinge { limit: Some(b) }) => apart(*a, *b),
        _ => 10.0,
    }
}

/// Gives a body of one side the mirror image of its counterpart's shape: the shape whose length differs more from that
/// of its bone changes.
fn mirror_shape(exam: &Exam<'_>, def: &mut RagdollDef, a: usize, b: usize) {
    let misfit = |body: usize| {
        let long = longest(&exam.def.bodies[body].shape);
        (long / exam.bones.length(body).unwrap_or(0.12 * exam.size) - 1.0).abs()
    };
    let (wrong, right) = if misfit(a) > misfit(b) { (a, b) } else { (b, a) };
    let plane = exam.bones.plane_of_symmetry();
    let source = &exam.def.bodies[right];
    reshape(exam, def, wrong, source.shape.clone(), mirror::mirrored(source.character_from_body, plane));
}

/// Changes a body's shape and position; its joints keep their positions in the character.
fn reshape(exam: &Exam<'_>, def: &mut RagdollDef, body: usize, shape: Shape, place: Transform) {
    let old = exam.def.bodies[body].character_from_body;
    let new_from_old = place.inverse() * old;
    for joint in &mut def.joints {
        if joint.parent == body {
            joint.frame_parent = new_from_old * joint.frame_parent;
        }
        if joint.child == body {
            joint.frame_child = new_from_old * joint.frame_child;
        }
    }
    let mass = def.bodies[body].mass.mass;
    def.bodies[body].mass = masses::of_shape(&shape, mass);
    def.bodies[body].shape = shape;
    def.bodies[body].character_from_body = place;
}

fn disable(def: &mut RagdollDef, a: usize, b: usize) {
    let pair = (min_of(a, b), a + b - min_of(a, b));
    if !def.disabled_pairs.contains(&pair) {
        def.disabled_pairs.push(pair);
        def.disabled_pairs.sort_unstable();
    }
}

fn min_of(a: usize, b: usize) -> usize {
    if a < b { a } else { b }
}

/// Removes possible causes of a push: limits that the bind pose slightly exceeds, each by too little for a finding.
/// Without any, it removes the deepest contact near `body`.
fn settle(exam: &Exam<'_>, def: &mut RagdollDef, body: usize) -> Option<()> {
    let strained = |joint: &usize| {
        let out = beyond(&exam.def.joints[*joint].kind, exam.turned(*joint, Rotation::IDENTITY));
        max(out.limit, out.locked) > STRAIN
    };
    let joints: Vec<usize> = (0..exam.def.joints.len()).filter(strained).collect();
    for &joint in &joints {
        def.joints[joint] = holding_bind(exam, joint);
    }
    if joints.is_empty() {
        let (a, b) = nearest_pair(exam, body)?;
        disable(def, a, b);
    }
    Some(())
}

/// Returns the touching pair that collides and contains this body or a neighbour of this body.
fn nearest_pair(exam: &Exam<'_>, body: usize) -> Option<(usize, usize)> {
    let pairs = crate::ragdoll::colliding_pairs(exam.def).into_iter();
    let near =
        |&(a, b): &(usize, usize)| exam.bones.distance(a, body) <= 1 || exam.bones.distance(b, body) <= 1;
    let deepest = pairs.filter(near).map(|(a, b)| (depth(exam, a, b), (a, b)));
    let best = deepest.fold(
        (0.0, None),
        |best, (depth, pair)| {
            if depth > best.0 { (depth, Some(pair)) } else { best }
        },
    );
    best.1
}

/// Gives a body's shape the size of the rig's shape, its counterpart's shape or the bone.
fn resize(exam: &Exam<'_>, def: &mut RagdollDef, body: usize) {
    let own = &exam.def.bodies[body];
    let rig = exam.repair.reference.as_ref();
    if let Some(found) = rig.and_then(|rig| rig.bodies.iter().find(|other| other.bone == own.bone)) {
        return reshape(exam, def, body, found.shape.clone(), found.character_from_body);
    }
    let wanted = exam.bones.length(body).unwrap_or(0.12 * exam.size);
    let plane = exam.bones.plane_of_symmetry();
    let twin = exam.bones.twin(body).map(|twin| &exam.def.bodies[twin]);
    if let Some(twin) = twin.filter(|twin| (0.5..2.0).contains(&(longest(&twin.shape) / wanted))) {
        return reshape(
            exam,
            def,
            body,
            twin.shape.clone(),
            mirror::mirrored(twin.character_from_body, plane),
        );
    }
    let long = longest(&own.shape);
    let factor = if long > wanted { wanted / long } else { max(wanted / long, 1.0) };
    let shape = scaled(&own.shape, factor);
    let shape = if shape.smallest_extent() < THIN * exam.size {
        // A very thin shape along its bone would stay thin when lengthened, so it becomes a capsule.
        let radius = max(0.1 * wanted, 2.0 * THIN * exam.size);
        Shape::Capsule { half_height: max(0.5 * wanted - radius, 0.0), radius }
    } else {
        shape
    };
    reshape(exam, def, body, shape, own.character_from_body);
}

/// Lowers a spring's frequency to half of the largest that the substep can follow.
fn soften(repair: &mut Repair, index: usize) -> bool {
    let nyquist = 0.5 / repair.substep;
    let wanted = 0.5 * nyquist;
    let inertia = turning_inertia(&Exam::new(repair), index);
    let Some(Some(softness)) = repair.springs.get_mut(index) else { return false };
    *softness = match *softness {
        Softness::Frequency { damping_ratio, .. } => Softness::Frequency { hertz: wanted, damping_ratio },
        Softness::Stiffness { damping, .. } => {
            let speed = 2.0 * PI * wanted;
            Softness::Stiffness { stiffness: inertia * speed * speed, damping }
        }
    };
    true
}
