//! Riders: skinned joints that belong to a body part but are not below it in the rig.

use crate::clip::Clip;
use crate::pose::{local_to_model, rest_pose};
use crate::rig::{JointIdx, LocalTransform, Rig};
use crate::roles::RigAnalysis;
use crate::{Wrap, sample};
use sinew_math::{Affine, Transform};

/// A joint, the body joint that it follows, and the joint's transform relative to the body joint.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rider {
    joint: JointIdx,
    carrier: JointIdx,
    /// Rigid transform in file units, because the scale of a pose may differ from the bind pose's.
    carrier_from_joint: Transform,
}

/// Joints of a rig that move skin of a body part without being below it: a second bone of the trunk above the hips,
/// halves of a pelvis, the root of a coat, eyes with their own skeleton, a hat beside the skeleton.
///
/// The file's clips move riders as authored. Motions from other bodies do not include them: [`carry`](Self::carry)
/// moves them with their body part, as a ragdoll does.
///
/// ```
/// use sinew_anim::{LocalTransform, Rig, RigAnalysis, riders::Riders};
///
/// fn carry_all(rig: &Rig, analysis: &RigAnalysis, poses: &mut [Vec<LocalTransform>]) {
///     let (riders, mut model) = (Riders::of(rig, analysis), Vec::new());
///     poses.iter_mut().for_each(|pose| riders.carry(rig, pose, &mut model));
/// }
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Riders {
    /// Riders by joint, ascending.
    list: Vec<Rider>,
    /// For each joint of the rig, true if it has a body.
    has_body: Vec<bool>,
}

impl Riders {
    /// Finds the riders of a rig, with their transforms in the bind pose.
    ///
    /// # Panics
    /// If the analysis does not fit the rig.
    pub fn of(rig: &Rig, analysis: &RigAnalysis) -> Self {
        assert_eq!(analysis.bind_model.len(), rig.joints.len(), "the analysis must belong to the rig");
        let mut has_body = vec![false; rig.joints.len()];
        analysis.kept.iter().for_each(|bone| has_body[bone.joint] = true);
        let body_above = |joint: JointIdx| {
            let mut line = core::iter::successors(rig.joints[joint].parent, |&at| rig.joints[at].parent);
            line.find(|&at| has_body[at])
        };
        let rider = |(joint, carrier): (JointIdx, &Option<JointIdx>)| {
            let carrier = (*carrier)?;
            let [from, to] = [carrier, joint].map(|at| analysis.bind_model[at].to_rigid());
            let carrier_from_joint = from.inverse() * to;
            // A foot outside the hierarchy of its limb has a role, so the clip animates it.
            let rides = body_above(joint) != Some(carrier) && analysis.roles[joint].is_none();
            (rides && carrier_from_joint.is_finite()).then_some(Rider { joint, carrier, carrier_from_joint })
        };
        let mut list: Vec<Rider> = analysis.merge_into.iter().enumerate().filter_map(rider).collect();
        // Props have their own bodies, which no motion places if their parent is elsewhere: a hat beside the skeleton.
        list.extend(analysis.kept.iter().filter(|bone| bone.is_prop).filter_map(|bone| {
            let carrier = analysis.kept[bone.parent?].joint;
            let carrier_from_joint =
                analysis.bind_model[carrier].to_rigid().inverse() * bone.bind_model.to_rigid();
            let rides = body_above(bone.joint) != Some(carrier) && carrier_from_joint.is_finite();
            rides.then_some(Rider { joint: bone.joint, carrier, carrier_from_joint })
        }));
        list.sort_by_key(|rider| rider.joint);
        Self { list, has_body }
    }

    /// Uses the transforms at the start of a clip: an author who moves a hat only by clips may have left it anywhere
    /// in the bind pose.
    ///
    /// # Panics
    /// If the clip or the riders are not of the rig.
    pub fn as_in(mut self, rig: &Rig, clip: &Clip) -> Self {
        let (mut pose, mut model) = (rest_pose(rig), Vec::new());
        sample(clip, rig, 0.0, Wrap::Clamp, &mut pose);
        local_to_model(rig, &pose, &Affine::IDENTITY, &mut model);
        let mut bears = self.has_body.clone();
        let is_rider = |joint: JointIdx| self.list.iter().any(|rider| rider.joint == joint);
        for joint in (0..rig.joints.len()).rev().filter(|&joint| !is_rider(joint)) {
            if let Some(parent) = rig.joints[joint].parent.filter(|_| bears[joint]) {
                bears[parent] = true;
            }
        }
        let moves = |joint: JointIdx| clip.channels.iter().any(|channel| channel.joint == joint);
        for rider in &mut self.list {
            let line = core::iter::successors(Some(rider.joint), |&at| rig.joints[at].parent);
            let mut own = line.take_while(|&at| at == rider.joint || !bears[at]);
            let held = model[rider.carrier].to_rigid().inverse() * model[rider.joint].to_rigid();
            if own.any(moves) && held.is_finite() {
                rider.carrier_from_joint = held;
            }
        }
        self
    }

    /// True if every skinned joint is below its own body part.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Moves the riders with their body parts, as in the bind pose; joints with bodies keep their model transform.
    /// Lengths and scales of bones stay. `model` is a buffer.
    ///
    /// # Panics
    /// If the pose does not fit the rig.
    pub fn carry(&self, rig: &Rig, local: &mut [LocalTransform], model: &mut Vec<Affine>) {
        if self.is_empty() {
            return;
        }
        local_to_model(rig, local, &Affine::IDENTITY, model);
        let mut list = self.list.iter().peekable();
        let mut carried: Vec<Affine> = Vec::with_capacity(rig.joints.len());
        for (joint, node) in rig.joints.iter().enumerate() {
            let parent = node.parent.map_or(Affine::IDENTITY, |parent| carried[parent]);
            let rider = list.next_if(|rider| rider.joint == joint);
            let wanted = rider.map(|rider| model[rider.carrier].to_rigid() * rider.carrier_from_joint);
            let has_moved = node.parent.is_some_and(|parent| carried[parent] != model[parent]);
            if let Some(wanted) =
                wanted.or((self.has_body[joint] && has_moved).then(|| model[joint].to_rigid()))
            {
                let rotation = parent.to_rigid().rotation.inverse() * wanted.rotation;
                let translation = parent.inverse().point(wanted.translation);
                if translation.is_finite() {
                    local[joint].translation = translation;
                    local[joint].rotation = rotation.normalize().toward(local[joint].rotation);
                }
            }
            carried.push(parent * local[joint].to_affine());
        }
        *model = carried;
    }
}
