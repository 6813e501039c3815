//! Checks of shapes: overlaps, proportions, and collision pairs.

use super::exam::Exam;
use super::geometry::{depth, depth_at, longest};
use super::limits::is_unlimited;
use super::{Code, Finding};
use crate::build::bones::Anatomy;
use crate::build::part::Part;
use crate::doctor::tuning::{FIGHT, LONG, LONG_CREATURE, THIN};
use crate::ragdoll::colliding_pairs;
use crate::tuning::TOLERATED;
use sinew_math::{Range, Rotation, Transform, Vec3, max, min};
use sinew_physics::JointKind;

/// Returns findings about shapes and pairs of shapes.
pub(super) fn findings(exam: &Exam<'_>) -> Vec<Finding> {
    let mut findings: Vec<Finding> =
        (0..exam.def.bodies.len()).filter_map(|body| out_of_size(exam, body)).collect();
    let is_sound = |body: usize| !findings.iter().any(|f: &Finding| f.bodies.contains(&body));
    let pairs: Vec<(usize, usize)> =
        colliding_pairs(exam.def).into_iter().filter(|&(a, b)| is_sound(a) && is_sound(b)).collect();
    let overlaps: Vec<Finding> = pairs.iter().filter_map(|&pair| overlap(exam, pair)).collect();
    let apart: Vec<(usize, usize)> = pairs
        .into_iter()
        .filter(|&(a, b)| !overlaps.iter().any(|f| f.bodies.contains(&a) && f.bodies.contains(&b)))
        .collect();
    findings.extend(overlaps);
    findings.extend(colliding_neighbours(exam, &apart));
    findings.extend(no_self_collision(exam));
    findings
}

/// Returns the tolerated overlap, metres.
pub(super) fn tolerated(exam: &Exam<'_>) -> f32 {
    max(TOLERATED, 0.002 * exam.size) * 1.02
}

fn out_of_size(exam: &Exam<'_>, body: usize) -> Option<Finding> {
    let shape = &exam.def.bodies[body].shape;
    let (thin, long) = (shape.smallest_extent(), longest(shape));
    let millimetres = |length: f32| 1000.0 * length;
    if thin < THIN * exam.size {
        let evidence = format!(
            "{} is {:.1} mm thin, {:.2} % of a height of {:.2} m",
            exam.who(body),
            millimetres(thin),
            100.0 * thin / exam.size,
            exam.size
        );
        return Some(exam.finding(Code::TinyShape, &[body], evidence));
    }
    let most = longest_allowed(exam);
    // A spear may be longer than its carrier.
    (long > most && !exam.bones.list[body].is_prop).then(|| {
        let evidence = format!(
            "{} is {:.2} m long, {:.0} % of a height of {:.2} m",
            exam.who(body),
            long,
            100.0 * long / exam.size,
            exam.size
        );
        exam.finding(Code::HugeShape, &[body], evidence)
    })
}

fn longest_allowed(exam: &Exam<'_>) -> f32 {
    if exam.bones.anatomy == Anatomy::Human {
        return LONG * exam.size;
    }
    let points = exam.bones.list.iter().map(|bone| bone.head);
    let points = points.chain(exam.def.bodies.iter().map(|body| body.character_from_body.translation));
    let (lo, hi) = points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| {
        (sinew_math::min3(lo, p), sinew_math::max3(hi, p))
    });
    max(LONG_CREATURE * (hi - lo).length(), 2.0 * exam.size)
}

fn overlap(exam: &Exam<'_>, (a, b): (usize, usize)) -> Option<Finding> {
    let depth = depth(exam, a, b);
    (depth > tolerated(exam)).then(|| {
        let evidence = format!(
            "{} and {} collide and overlap by {:.0} mm in the bind pose",
            exam.who(a),
            exam.who(b),
            1000.0 * depth
        );
        exam.finding(Code::OverlapAtStart, &[b, a], evidence)
    })
}

/// Returns a finding if all pairs of hands, feet and other limb ends with the trunk are disabled, although they do not
/// overlap.
fn no_self_collision(exam: &Exam<'_>) -> Option<Finding> {
    let pairs = limbs_and_trunk(exam);
    let is_disabled = |&(a, b): &(usize, usize)| {
        exam.def.disabled_pairs.contains(&(a, b)) || exam.def.disabled_pairs.contains(&(b, a))
    };
    if pairs.len() < 4 || !pairs.iter().all(is_disabled) {
        return None;
    }
    let (limb, trunk) = pairs[0];
    let evidence = format!(
        "all {} pairs of limbs and trunk are left out, such as {} and {}, which are clear of each other in the bind pose",
        pairs.len(),
        exam.who(limb),
        exam.who(trunk)
    );
    Some(exam.finding(Code::NoSelfCollision, &[limb, trunk], evidence))
}

/// Returns pairs of a forearm, hand, shank or foot and a trunk bone that do not overlap in the bind pose.
pub(super) fn limbs_and_trunk(exam: &Exam<'_>) -> Vec<(usize, usize)> {
    let is_end =
        |body: usize| matches!(exam.part(body), Part::Forearm | Part::Hand | Part::Shank | Part::Foot);
    let is_trunk = |body: usize| matches!(exam.part(body), Part::Pelvis | Part::Spine);
    let all = 0..exam.def.bodies.len();
    let ends: Vec<usize> = all.clone().filter(|&body| is_end(body)).collect();
    let trunk: Vec<usize> = all.filter(|&body| is_trunk(body)).collect();
    let is_far = |&(limb, trunk): &(usize, usize)| {
        exam.bones.distance(limb, trunk) > 1 && depth(exam, limb, trunk) <= 0.0
    };
    ends.iter().flat_map(|&limb| trunk.iter().map(move |&t| (limb, t))).filter(is_far).collect()
}

/// Returns findings about pairs with one body between them that collide over most of the range of the joint between
/// them.
fn colliding_neighbours(exam: &Exam<'_>, pairs: &[(usize, usize)]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for &(a, b) in pairs {
        if exam.bones.distance(a, b) != 2 {
            continue;
        }
        // The joint moves the child of the pair.
        let moved = [b, a].into_iter().find(|&body| body > 0 && body > other_of(exam, body, a, b));
        let Some(child) = moved else { continue };
        if is_unlimited(&exam.def.joints[child - 1].kind) {
            continue;
        }
        let other = a + b - child;
        let (share, worst) = share_of_range(exam, child - 1, other);
        if share > FIGHT {
            let evidence = format!(
                "{} and {} collide in {:.0} % of the range of the joint between {}, by up to {:.0} mm",
                exam.who(child),
                exam.who(other),
                100.0 * share,
                exam.between(child - 1),
                1000.0 * worst
            );
            findings.push(exam.finding(Code::CollisionFightsLimit, &[child, other], evidence));
        }
    }
    findings
}

/// Returns the body between a pair, given one of the two: its parent, which is also the parent or child of the other.
fn other_of(exam: &Exam<'_>, body: usize, a: usize, b: usize) -> usize {
    let other = a + b - body;
    let parent = exam.bones.list[body].parent;
    match parent {
        Some(parent) if exam.bones.list[parent].parent == Some(other) => parent,
        Some(parent) if exam.bones.list[other].parent == Some(parent) => parent,
        _ => usize::MAX,
    }
}

/// Returns the share of a joint's range in which its child overlaps a body, and the deepest overlap, metres.
fn share_of_range(exam: &Exam<'_>, index: usize, other: usize) -> (f32, f32) {
    let joint = &exam.def.joints[index];
    let parent = exam.def.bodies[joint.parent].character_from_body * joint.frame_parent;
    let poses = samples(&joint.kind);
    let mut deepest = 0.0;
    let mut hits = 0;
    for &pose in &poses {
        let place = parent * Transform::new(Vec3::ZERO, pose) * joint.frame_child.inverse();
        let depth = depth_at(exam, (joint.child, place), other);
        deepest = max(deepest, depth);
        hits += usize::from(depth > 2.0 * tolerated(exam));
    }
    (hits as f32 / max(poses.len() as f32, 1.0), deepest)
}

/// Returns rotations spread over the range of a joint.
fn samples(kind: &JointKind) -> Vec<Rotation> {
    let along = |range: Range, share: f32| range.center() + 0.5 * share * (range.hi - range.lo);
    match *kind {
        JointKind::Ball { limit: Some(limit) } | JointKind::Universal { limit: Some(limit) } => {
            let mut poses = vec![Rotation::IDENTITY];
            for step in 0..8_u8 {
                let angle = f32::from(step) * core::f32::consts::FRAC_PI_4;
                let (sin, cos) = sinew_math::trig::sin_cos(angle);
                for share in [0.5, 0.9] {
                    let swing = min(limit.cone_angle(cos, sin), 3.0) * share;
                    poses.push(Rotation::from_scaled_axis(Vec3::new(0.0, cos * swing, sin * swing)));
                }
            }
            poses
        }
        JointKind::Hinge { limit: Some(range) } => (-4..=4_i8)
            .map(|step| Rotation::from_axis_angle(Vec3::X, along(range, f32::from(step) * 0.23)))
            .collect(),
        _ => Vec::new(),
    }
}
