//! Legs with pelvis and soles, and joints whose parent in anatomy differs from that in the rig.

use crate::ik::{TwoBone, set_rotation, shift};
use crate::rig::{Joint, JointIdx, LocalTransform, Rig};
use crate::roles::{Basis, Bound, HUMANOID_ROLES, RigAnalysis, Role, RoleGuess, Side};
use crate::tuning::{ANKLE_HEIGHT, BALL_AHEAD, MADE_UP};
use sinew_math::{Affine, Rotation, Vec3};

/// A leg with two points of its sole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Side of the foot.
    pub side: Side,
    /// Joints of hip, knee and ankle.
    pub leg: TwoBone,
    /// Points of the sole under the ankle and under the ball (where the toes begin), relative to the ankle, in the axes
    /// of its joint without scale, metres.
    pub sole: [Vec3; 2],
    /// Length from hip to knee to ankle to the floor, metres.
    pub length: f32,
    /// Rotation from the axes of the ankle's joint to the body's axes, in the standing pose.
    pub stance: Rotation,
    /// Forward direction in the axes of the thigh's joint, to which a straight knee bends. Unit vector.
    pub forward: Vec3,
}

impl Foot {
    fn of(analysis: &RigAnalysis, side: Side) -> Option<Self> {
        let joint = |role: Role| analysis.joint_with(role);
        let leg = TwoBone {
            upper: joint(Role::UpperLeg(side))?,
            lower: joint(Role::LowerLeg(side))?,
            end: joint(Role::Foot(side))?,
        };
        let character = analysis.character_from_file();
        let stands = |joint: JointIdx| (character * analysis.bind_model[joint]).to_rigid();
        let (hip, knee, ankle) = (stands(leg.upper), stands(leg.lower), stands(leg.end));
        let bones =
            (knee.translation - hip.translation).length() + (ankle.translation - knee.translation).length();
        let at = ankle.translation;
        let ball = joint(Role::Toes(side))
            .map_or(at + Vec3::Z * (BALL_AHEAD * bones), |toes| stands(toes).translation);
        let on_floor = |p: Vec3| Vec3::new(p.x, analysis.floor, p.z) - at;
        Some(Self {
            side,
            leg,
            sole: [at, ball].map(|p| ankle.rotation.inverse() * on_floor(p)),
            length: bones + (at.y - analysis.floor),
            stance: ankle.rotation,
            forward: hip.rotation.inverse() * Vec3::Z,
        })
    }

    /// Returns heel and ball in a pose, in the space of `model` (one transform per joint), whose unit is the metre.
    pub fn points(&self, model: &[Affine]) -> [Vec3; 2] {
        let ankle = model[self.leg.end].to_rigid();
        self.sole.map(|point| ankle.translation + ankle.rotation * point)
    }
}

/// Pelvis and legs of a humanoid.
#[derive(Clone, Debug, PartialEq)]
pub struct Legs {
    /// The joint that carries the body.
    pub pelvis: JointIdx,
    /// Left and right foot.
    pub feet: [Foot; 2],
    /// Joints with another parent in anatomy than in the rig. Rigs baked from inverse kinematics parent feet to the
    /// root.
    strays: Vec<Stray>,
}

/// A joint, its anatomical parent, and its position in that parent's axes, file units.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stray {
    joint: JointIdx,
    carrier: JointIdx,
    at: Vec3,
}

impl Legs {
    /// Returns the legs of a humanoid in its bind pose; `None` without hips, or if a side lacks thigh, shank or foot.
    ///
    /// # Panics
    /// If the analysis does not fit the rig.
    pub fn of(rig: &Rig, analysis: &RigAnalysis) -> Option<Self> {
        assert_eq!(analysis.bind_model.len(), rig.joints.len(), "the analysis must belong to the rig");
        let pelvis = analysis.joint_with(Role::Hips)?;
        let feet = [Foot::of(analysis, Side::Left)?, Foot::of(analysis, Side::Right)?];
        Some(Self { pelvis, feet, strays: strays(rig, analysis) })
    }

    /// True if the legs' knees were [added](add_ankles), because each leg is one bone; such legs do not bend.
    pub fn are_stiff(&self, rig: &Rig) -> bool {
        self.feet.iter().any(|foot| rig.joints[foot.leg.lower].source == usize::MAX)
    }

    /// Moves stray joints to their anatomical place; rotations stay. Call it after moving their anatomical parents.
    pub fn gather(&self, rig: &Rig, local: &mut [LocalTransform], model: &mut [Affine]) {
        for stray in &self.strays {
            let by = model[stray.carrier].point(stray.at) - model[stray.joint].translation;
            shift(rig, stray.joint, by, local, model);
        }
    }

    /// Moves the whole body by `by`, in the axes of the model pose.
    pub fn carry(&self, rig: &Rig, by: Vec3, local: &mut [LocalTransform], model: &mut [Affine]) {
        shift(rig, self.pelvis, by, local, model);
        self.gather(rig, local, model);
    }

    /// Sets a foot's rotation after its leg moved.
    pub fn plant(
        &self,
        rig: &Rig,
        foot: &Foot,
        rotation: Rotation,
        local: &mut [LocalTransform],
        model: &mut [Affine],
    ) {
        self.gather(rig, local, model);
        set_rotation(rig, foot.leg.end, rotation, local, model);
    }
}

fn strays(rig: &Rig, analysis: &RigAnalysis) -> Vec<Stray> {
    let hangs = |joint: JointIdx, above: JointIdx| {
        core::iter::successors(rig.joints[joint].parent, |&i| rig.joints[i].parent).any(|i| i == above)
    };
    let stray = |role: Role| {
        let joint = analysis.joint_with(role)?;
        let carrier = role.anatomical_parents().iter().find_map(|&above| analysis.joint_with(above))?;
        let at = analysis.bind_model[carrier].inverse().point(analysis.bind_model[joint].translation);
        (!hangs(joint, carrier) && at.is_finite()).then_some(Stray { joint, carrier, at })
    };
    // Parents come first, so that descendants of a stray follow it.
    HUMANOID_ROLES.into_iter().filter_map(stray).collect()
}

/// Adds ankle joints to a humanoid whose legs end with the shank, and knees and ankles to one whose legs are one bone,
/// so that motions with feet fit low-poly figures.
///
/// An ankle is a new joint at the end of the rig, without skin, at the centre of the lowest skin of the leg; a knee is
/// one in the middle between hip and ankle. Their [`Joint::source`] is beyond the file's nodes. The analysis treats
/// them as shank and foot. A foot directly on the thigh becomes a part of that leg of one bone. Returns the number of
/// ankles added; a side without thigh gets none.
///
/// # Panics
/// If the analysis does not fit the rig.
pub fn add_ankles(rig: &mut Rig, analysis: &mut RigAnalysis) -> usize {
    assert_eq!(analysis.bind_model.len(), rig.joints.len(), "the analysis must belong to the rig");
    let mut added = 0;
    for side in [Side::Left, Side::Right] {
        let [thigh, shank, foot] = [Role::UpperLeg(side), Role::LowerLeg(side), Role::Foot(side)]
            .map(|role| analysis.joint_with(role));
        let (true, Some(thigh)) = (analysis.humanoid, thigh) else { continue };
        let low = match (shank, foot) {
            (Some(_), Some(_)) => continue,
            (Some(shank), None) => Some(shank).filter(|&shank| is_on_floor(rig, analysis, shank)),
            (None, foot) => foot,
        };
        let end = match low {
            Some(foot) => Some(analysis.bind_model[foot].translation),
            None => end_of_leg(rig, analysis, shank.unwrap_or(thigh)),
        };
        let Some(ankle) = end else { continue };
        low.into_iter().for_each(|foot| join(analysis, foot, thigh));
        let shank = shank.filter(|_| low.is_none());
        let knee = (analysis.bind_model[thigh].translation + ankle) * 0.5;
        let shank = shank.or_else(|| add_joint(rig, analysis, thigh, Role::LowerLeg(side), knee));
        let Some(shank) = shank else { continue };
        added += usize::from(add_joint(rig, analysis, shank, Role::Foot(side), ankle).is_some());
    }
    added
}

/// Adds a joint without skin at `at`, model space, that moves with the body of its parent; `None` if its place is not
/// finite.
fn add_joint(
    rig: &mut Rig,
    analysis: &mut RigAnalysis,
    parent: JointIdx,
    role: Role,
    at: Vec3,
) -> Option<JointIdx> {
    let translation = analysis.bind_model[parent].inverse().point(at);
    let local = LocalTransform { translation, ..LocalTransform::default() };
    let bind = analysis.bind_model[parent] * local.to_affine();
    if !bind.is_finite() {
        return None;
    }
    rig.joints.push(Joint { name: role.name(), parent: Some(parent), rest: local, source: usize::MAX });
    analysis.bind_model.push(bind);
    analysis.roles.push(Some(RoleGuess { role, confidence: MADE_UP, basis: Basis::Shape }));
    let body = analysis.merge_into[parent].unwrap_or(parent);
    analysis.merge_into.push(Some(body));
    Some(rig.joints.len() - 1)
}

/// Merges the body of a joint into the body of another joint.
fn join(analysis: &mut RigAnalysis, joint: JointIdx, other: JointIdx) {
    let body = analysis.merge_into[other].unwrap_or(other);
    analysis.roles[joint] = None;
    analysis.merge_into[joint] = Some(body);
    let merged = analysis.merge_into.iter_mut().filter(|into| **into == Some(joint));
    merged.for_each(|into| *into = Some(body));
}

/// True if a joint is a foot: at most as high above its lowest skin as an ankle.
fn is_on_floor(rig: &Rig, analysis: &RigAnalysis, bone: JointIdx) -> bool {
    let moves = |bound: Bound| bound.movers.contains(&bone);
    end_of_leg(rig, analysis, bone).is_none() && Bound::of(rig).is_some_and(moves)
}

/// Mean of the lowest skin that the last bone of a leg moves most, raised to ankle height; model space, file units.
fn end_of_leg(rig: &Rig, analysis: &RigAnalysis, bone: JointIdx) -> Option<Vec3> {
    let (character, bound) = (analysis.character_from_file(), Bound::of(rig)?);
    let skin = bound.vertices.iter().zip(&bound.movers).filter(|(_, mover)| **mover == bone);
    let own: Vec<Vec3> = skin.map(|(&vertex, _)| character.point(vertex)).collect();
    let lowest = own.iter().map(|at| at.y).reduce(sinew_math::min)?;
    let sole = lowest + ANKLE_HEIGHT * analysis.height;
    let (sum, count) = own
        .iter()
        .filter(|at| at.y <= sole)
        .fold((Vec3::ZERO, 0.0_f32), |(sum, count), &at| (sum + at, count + 1.0));
    let start = character.point(analysis.bind_model[bone].translation);
    // A foot extends forward from its ankle, which is under the knee.
    let middle = sum / count;
    let ankle = Vec3::new(middle.x, sole, sinew_math::min(middle.z, start.z));
    (start.y > sole).then(|| character.inverse().point(ankle))
}
