//! Legs that a body stands on, with pelvis and soles, and the joints that a rig hangs elsewhere.

use crate::ik::{TwoBone, set_rotation, shift};
use crate::rig::{JointIdx, LocalTransform, Rig};
use crate::roles::{HUMANOID_ROLES, RigAnalysis, Role, Side};
use crate::tuning::BALL_AHEAD;
use sinew_math::{Affine, Rotation, Vec3};

/// A leg and the two points of the sole that it stands on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Whose.
    pub side: Side,
    /// Hip, knee and ankle.
    pub leg: TwoBone,
    /// Under the ankle, and under the ball (where the toes begin): from the ankle in the axes of its joint without scale,
    /// metres.
    pub sole: [Vec3; 2],
    /// From hip to knee to ankle to the floor, metres.
    pub length: f32,
    /// From the axes of the ankle's joint to the body's own, as it stands.
    pub stance: Rotation,
    /// Forward in the axes of the thigh's joint: where a straight knee bends to. Unit.
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

    /// Heel and ball in a pose, in the space of `model` (one transform per joint), whose unit is the metre.
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
    /// Left, right.
    pub feet: [Foot; 2],
    /// Joints that anatomy hangs on others than the rig does. Rigs baked from inverse kinematics leave feet beside the body.
    strays: Vec<Stray>,
}

/// A joint, what carries it by anatomy, and where it sits in the axes of that, file units.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stray {
    joint: JointIdx,
    carrier: JointIdx,
    at: Vec3,
}

impl Legs {
    /// The legs of a humanoid as they stand in its bind pose; `None` without hips, or where a side lacks thigh, shank or
    /// foot.
    ///
    /// # Panics
    /// If the analysis is not one of the rig's.
    pub fn of(rig: &Rig, analysis: &RigAnalysis) -> Option<Self> {
        assert_eq!(analysis.bind_model.len(), rig.joints.len(), "an analysis of this rig");
        let pelvis = analysis.joint_with(Role::Hips)?;
        let feet = [Foot::of(analysis, Side::Left)?, Foot::of(analysis, Side::Right)?];
        Some(Self { pelvis, feet, strays: strays(rig, analysis) })
    }

    /// Puts the joints that the rig hangs elsewhere where anatomy has them; rotations stay. To be called when what carries
    /// them has moved.
    pub fn gather(&self, rig: &Rig, local: &mut [LocalTransform], model: &mut [Affine]) {
        for stray in &self.strays {
            let by = model[stray.carrier].point(stray.at) - model[stray.joint].translation;
            shift(rig, stray.joint, by, local, model);
        }
    }

    /// Shifts the whole body, in the axes of the model pose.
    pub fn carry(&self, rig: &Rig, by: Vec3, local: &mut [LocalTransform], model: &mut [Affine]) {
        shift(rig, self.pelvis, by, local, model);
        self.gather(rig, local, model);
    }

    /// Gives a foot back a rotation that moving its leg has changed.
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
    // Parents come first, so that what a stray carries follows it.
    HUMANOID_ROLES.into_iter().filter_map(stray).collect()
}
