//! A limb of two bones whose end is brought to a target: by the law of cosines, in one step.

use super::{parent_model, turn, update_from};
use crate::pose::smoothstep;
use crate::rig::{JointIdx, LocalTransform, Rig};
use sinew_math::{
    Affine, Mat3, Rotation, Vec3, any_orthonormal, clamp, direction, max, min, normalize_or, trig,
};

/// The joints of a limb, from the trunk outward. Others may lie between them; they go along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TwoBone {
    /// Joint at which the first bone begins: hip, shoulder.
    pub upper: JointIdx,
    /// Joint at which the second bone begins: knee, elbow.
    pub lower: JointIdx,
    /// Joint at which the second bone ends: ankle, wrist.
    pub end: JointIdx,
}

/// To which side the middle joint goes. The target fixes it but for a turn about the line from the first joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pole {
    /// The side on which it is. A limb that is straight bends toward this direction, any length.
    Keep(Vec3),
    /// Toward this direction, any length.
    Toward(Vec3),
}

/// Goal for the end of a limb: lengths in the unit of the model pose, directions in its space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoBoneGoal {
    /// Place of the end joint.
    pub target: Vec3,
    /// Side of the middle joint.
    pub pole: Pole,
    /// Share of the limb's length, 0..=0.5, over which it slows down before it is straight, so that the knee does not
    /// snap. 0: none.
    pub softness: f32,
    /// Largest factor by which the bones may grow to reach the target, at least 1. 1: not at all.
    pub stretch: f32,
    /// Weight of the goal, 0..=1: the share of the way to it that is gone.
    pub weight: f32,
}

impl TwoBoneGoal {
    /// All the way to `target`, not soft, without stretch.
    pub fn at(target: Vec3, pole: Pole) -> Self {
        Self { target, pole, softness: 0.0, stretch: 1.0, weight: 1.0 }
    }
}

/// Turns and stretch that bring the end of a limb to its goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoBoneSolution {
    /// Turn of the first bone about the first joint, in the axes of the space.
    pub upper: Rotation,
    /// Turn of the second bone in the axes of the space, from how it was before (not on top of `upper`).
    pub lower: Rotation,
    /// Factor by which both bones grow, at least 1.
    pub stretch: f32,
    /// Distance of the end from the target, at full weight. Infinite for a target that is not finite.
    pub miss: f32,
}

impl TwoBoneSolution {
    const NONE: Self =
        Self { upper: Rotation::IDENTITY, lower: Rotation::IDENTITY, stretch: 1.0, miss: f32::INFINITY };
}

/// Bends a limb, given by the places of its three joints in any one space and unit, so that its end reaches the goal; one that is too far or too
/// near is reached for in its direction. Bones of no length and targets that are not finite turn nothing they need not.
///
/// With bones a and b and the distance d, the middle joint is `(a² − b² + d²) / 2d` along the way and as far to the side
/// as Pythagoras leaves. Turns are taken from frames of bone and plane, so that a knee bends about its own axis.
pub fn solve_two_bone(root: Vec3, middle: Vec3, end: Vec3, goal: &TwoBoneGoal) -> TwoBoneSolution {
    let way = goal.target - root;
    let (Some(first), Some(second)) = (direction(middle - root), direction(end - middle)) else {
        return aim_one_bone(root, middle, end, goal);
    };
    if !way.is_finite() {
        return TwoBoneSolution::NONE;
    }
    let (a, b) = ((middle - root).length(), (end - middle).length());
    let far = way.length();
    let reached = soft_reach(far, a + b, goal.softness);
    let stretch = clamp(far / max(reached, 1e-6 * (a + b)), 1.0, max(goal.stretch, 1.0));
    let (a, b) = (a * stretch, b * stretch);
    let d = clamp(min(reached * stretch, far), max((a - b).abs(), 1e-5 * (a + b)), a + b);
    let along = direction(way).or_else(|| direction(end - root)).unwrap_or(first);
    let (from, to) = planes(root, middle, end, along, goal.pole);
    let x = clamp((a * a - b * b + d * d) / (2.0 * d), -a, a);
    let aside = to.cross(along);
    let bent = (along * x + aside * max(a * a - x * x, 0.0).sqrt()) / a;
    let rest = normalize_or(along * d - bent * a, along);
    let frame = |bone: Vec3, normal: Vec3| {
        let normal = normalize_or(normal - bone * normal.dot(bone), any_orthonormal(bone));
        Mat3::from_cols(bone, normal, bone.cross(normal))
    };
    let onto =
        |new: Vec3, old: Vec3| Rotation::from_mat3_lossy(&(frame(new, to) * frame(old, from).transpose()));
    TwoBoneSolution {
        upper: onto(bent, first),
        lower: onto(rest, second),
        stretch,
        miss: (way - along * d).length(),
    }
}

/// A limb with one bone of no length has only a direction.
fn aim_one_bone(root: Vec3, middle: Vec3, end: Vec3, goal: &TwoBoneGoal) -> TwoBoneSolution {
    let way = goal.target - root;
    if !way.is_finite() {
        return TwoBoneSolution::NONE;
    }
    let (old, new) = (direction(end - root), direction(way));
    let turned = old.zip(new).map_or(Rotation::IDENTITY, |(old, new)| Rotation::from_arc(old, new));
    let (upper, lower) = if middle == root { (Rotation::IDENTITY, turned) } else { (turned, turned) };
    let miss = (way.length() - (end - root).length()).abs();
    TwoBoneSolution { upper, lower, stretch: 1.0, miss }
}

/// Distance that a limb of length `full` goes for a target `far` away: equal up to `softness` before the end, then
/// nearing `full` without ever getting there. Once differentiable.
fn soft_reach(far: f32, full: f32, softness: f32) -> f32 {
    let slow = clamp(softness, 0.0, 0.5) * full;
    let hard = full - slow;
    if far <= hard || slow <= 0.0 {
        return min(far, full);
    }
    hard + slow * (1.0 - trig::exp((hard - far) / slow))
}

/// Normals of the planes in which the limb is bent now and shall be bent: `normal × way` points to the middle joint's
/// side. Of a limb that is nearly straight the bend is noise: there the pole's plane takes over, step by step.
fn planes(root: Vec3, middle: Vec3, end: Vec3, along: Vec3, pole: Pole) -> (Vec3, Vec3) {
    /// Sines of the angle between first bone and way: below the first a limb is straight, above the second it is bent.
    const BENT: [f32; 2] = [0.002, 0.08];
    let old_way = normalize_or(end - root, normalize_or(middle - root, along));
    let (Pole::Keep(side) | Pole::Toward(side)) = pole;
    let plane_of = |way: Vec3| {
        let across = direction(side).map_or(Vec3::ZERO, |side| way.cross(side));
        normalize_or(if across.length() > 1e-5 { across } else { Vec3::ZERO }, any_orthonormal(way))
    };
    let bend = old_way.cross(normalize_or(middle - root, old_way));
    let sine = bend.length();
    let share = smoothstep((sine - BENT[0]) / (BENT[1] - BENT[0]));
    let straight = plane_of(old_way);
    let from = normalize_or(straight * (1.0 - share) + normalize_or(bend, straight) * share, straight);
    let to = match pole {
        Pole::Keep(_) => Rotation::from_arc(old_way, along) * from,
        Pole::Toward(_) => plane_of(along),
    };
    (from, to)
}

/// Brings the end of a limb to a goal. The joint at the end keeps its rotation relative to the second bone. `local` and
/// `model` have one entry per joint and are both brought up to date; the goal is in the space of `model`. What is returned is
/// the turn at full weight, whatever the goal's.
///
/// # Panics
/// If the slices are not as long as the rig has joints, or a joint is not in it.
pub fn two_bone_ik(
    rig: &Rig,
    limb: TwoBone,
    goal: &TwoBoneGoal,
    local: &mut [LocalTransform],
    model: &mut [Affine],
) -> TwoBoneSolution {
    assert_eq!((local.len(), model.len()), (rig.joints.len(), rig.joints.len()), "two poses of one rig");
    let place = |joint: JointIdx| model[joint].translation;
    let solution = solve_two_bone(place(limb.upper), place(limb.lower), place(limb.end), goal);
    let weight = clamp(goal.weight, 0.0, 1.0);
    if weight <= 0.0 {
        return solution;
    }
    let part = |turned: Rotation| Rotation::IDENTITY.slerp(turned, weight);
    let (upper, lower) = (part(solution.upper), part(solution.lower));
    turn(rig, limb.upper, upper, local, model);
    // The first turn has carried the second bone along.
    turn(rig, limb.lower, lower * upper.inverse(), local, model);
    let stretch = 1.0 + (solution.stretch - 1.0) * weight;
    if stretch > 1.0 {
        for joint in [limb.lower, limb.end] {
            let parent = parent_model(rig, joint, local, model);
            local[joint].translation *= stretch;
            update_from(rig, joint, &parent, local, model);
        }
    }
    solution
}
