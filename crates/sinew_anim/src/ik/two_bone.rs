//! Two-bone IK by the law of cosines, in one step.

use super::{parent_model, turn, update_from};
use crate::pose::smoothstep;
use crate::rig::{JointIdx, LocalTransform, Rig};
use sinew_math::{
    Affine, Mat3, Rotation, Vec3, any_orthonormal, clamp, direction, max, min, normalize_or, trig,
};

/// The three joints of a limb, from the trunk outward. Other joints between them move along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TwoBone {
    /// Start of the first bone: hip, shoulder.
    pub upper: JointIdx,
    /// Start of the second bone: knee, elbow.
    pub lower: JointIdx,
    /// Joint at which the second bone ends: ankle, wrist.
    pub end: JointIdx,
}

/// Side to which the middle joint bends; the target determines the rest of the rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pole {
    /// The current side. A straight limb bends toward this direction, of any length.
    Keep(Vec3),
    /// The middle joint bends toward this direction, of any length.
    Toward(Vec3),
}

/// Goal for the end of a limb: lengths in the unit of the model pose, directions in the space of that pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoBoneGoal {
    /// Target position of the end joint.
    pub target: Vec3,
    /// Side to which the middle joint bends.
    pub pole: Pole,
    /// Share of the limb's length, 0..=0.5, over which the limb slows down before it is straight, so that the knee does
    /// not snap. 0: no slowing.
    pub softness: f32,
    /// Largest stretch factor of the bones, at least 1. 1: no stretch.
    pub stretch: f32,
    /// Weight of the goal, 0..=1: the share of the motion that is applied.
    pub weight: f32,
}

impl TwoBoneGoal {
    /// A goal with full weight, no softness and no stretch.
    pub fn at(target: Vec3, pole: Pole) -> Self {
        Self { target, pole, softness: 0.0, stretch: 1.0, weight: 1.0 }
    }
}

/// Rotations and stretch that bring the end of a limb to its goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoBoneSolution {
    /// Rotation of the first bone about the first joint, in the axes of the space.
    pub upper: Rotation,
    /// Rotation of the second bone in the axes of the space, from its old orientation (not on top of `upper`).
    pub lower: Rotation,
    /// Stretch factor of both bones, at least 1.
    pub stretch: f32,
    /// Distance of the end from the target at full weight. Infinite for a target that is not finite.
    pub miss: f32,
}

impl TwoBoneSolution {
    const NONE: Self =
        Self { upper: Rotation::IDENTITY, lower: Rotation::IDENTITY, stretch: 1.0, miss: f32::INFINITY };
}

/// Bends a limb, given by its three joint positions in any space and unit, so that its end reaches the target, or
/// points toward a target out of reach. Zero-length bones and targets that are not finite cause no rotation.
///
/// With bones a and b and the distance d of the target, the middle joint is `(a² − b² + d²) / 2d` along the line to the
/// target, offset sideways by Pythagoras. Rotations are computed from frames of bone and plane, so that a knee bends
/// about its own axis.
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

/// Aims a limb whose first or second bone has no length at the target; such a limb cannot bend.
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

/// Returns the distance of the limb's end from its start for a target at distance `far`, for a limb of length `full`.
/// It equals `far` until only the share `softness` of the length is left, and then approaches `full`. Its first
/// derivative is continuous.
fn soft_reach(far: f32, full: f32, softness: f32) -> f32 {
    let slow = clamp(softness, 0.0, 0.5) * full;
    let hard = full - slow;
    if far <= hard || slow <= 0.0 {
        return min(far, full);
    }
    hard + slow * (1.0 - trig::exp((hard - far) / slow))
}

/// Normals of the current and the wanted bending plane: `normal × way` points to the middle joint's side. A nearly
/// straight limb has no reliable plane, so the pole's plane is blended in.
fn planes(root: Vec3, middle: Vec3, end: Vec3, along: Vec3, pole: Pole) -> (Vec3, Vec3) {
    /// Sines of the angle between first bone and target line: below the first number a limb counts as straight, above
    /// the second as bent.
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

/// Moves the end of a limb to a goal. The end joint keeps its rotation relative to the second bone. `local` and `model`
/// have one entry per joint; both are updated. The goal is in the space of `model`. Returns the rotations at full
/// weight.
///
/// # Panics
/// If a slice does not have one entry per joint of the rig, or a joint is not in the rig.
pub fn two_bone_ik(
    rig: &Rig,
    limb: TwoBone,
    goal: &TwoBoneGoal,
    local: &mut [LocalTransform],
    model: &mut [Affine],
) -> TwoBoneSolution {
    assert_eq!(
        (local.len(), model.len()),
        (rig.joints.len(), rig.joints.len()),
        "the poses must be of one rig"
    );
    let place = |joint: JointIdx| model[joint].translation;
    let solution = solve_two_bone(place(limb.upper), place(limb.lower), place(limb.end), goal);
    let weight = clamp(goal.weight, 0.0, 1.0);
    if weight <= 0.0 {
        return solution;
    }
    let part = |turned: Rotation| Rotation::IDENTITY.slerp(turned, weight);
    let (upper, lower) = (part(solution.upper), part(solution.lower));
    turn(rig, limb.upper, upper, local, model);
    // The first rotation has already moved the second bone.
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
