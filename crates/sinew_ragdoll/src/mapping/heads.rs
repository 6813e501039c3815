//! Joints that carry root motion: the children of the nodes that stay in their rest pose.

use super::{Mapping, with_scale_of};
use crate::def::RagdollDef;
use sinew_anim::{JointIdx, LocalTransform, Rig};
use sinew_math::{Affine, Transform, Vec3};

/// A joint that carries root motion.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Head {
    pub joint: JointIdx,
    /// Transform from the space of the joint's parent to model space, with all nodes above the joint at rest.
    model_from_parent: Affine,
    parent_from_model: Affine,
}

impl Head {
    fn new(rig: &Rig, joint: JointIdx) -> Self {
        let model_from_parent = rig.joints[joint]
            .parent
            .map_or(Affine::IDENTITY, |parent| chain(rig, parent, |joint| rig.joints[joint].rest));
        Self { joint, model_from_parent, parent_from_model: model_from_parent.inverse() }
    }
}

/// Returns the transform of a joint in model space, by the chain of local transforms above it.
fn chain(rig: &Rig, joint: JointIdx, local: impl Fn(JointIdx) -> LocalTransform) -> Affine {
    let mut model = local(joint).to_affine();
    let mut at = rig.joints[joint].parent;
    while let Some(parent) = at {
        model = local(parent).to_affine() * model;
        at = rig.joints[parent].parent;
    }
    model
}

/// Returns true for each joint that moves skin, is among `others`, or has such a descendant.
fn with_descendants(rig: &Rig, others: impl Iterator<Item = JointIdx>) -> Vec<bool> {
    let mut counts = vec![false; rig.joints.len()];
    let skinned = rig.skins.iter().flat_map(|skin| skin.joints.iter().copied());
    skinned.chain(others).for_each(|joint| counts[joint] = true);
    for joint in (0..rig.joints.len()).rev() {
        if let Some(parent) = rig.joints[joint].parent.filter(|_| counts[joint]) {
            counts[parent] = true;
        }
    }
    counts
}

/// Returns true for each joint that carries skin or an object that moves with a body; false for a floor, lamp or camera
/// in the file.
pub(crate) fn carries_character(rig: &Rig, def: &RagdollDef) -> Vec<bool> {
    let merged = def.bodies.iter().flat_map(|body| body.merged.iter().copied().chain([body.joint]));
    with_descendants(rig, merged)
}

/// Finds the heads: the pelvis, or its highest ancestor that moves skin with a body, and every other child of a node
/// above it that carries skin or objects that move with a body. Skin above the pelvis would stay behind if its joint
/// were at rest.
pub(super) fn find(rig: &Rig, def: &RagdollDef) -> Vec<Head> {
    let merged = |joint: JointIdx| def.bodies.iter().any(|body| body.merged.contains(&joint));
    let above = core::iter::successors(rig.joints[def.bodies[0].joint].parent, |&at| rig.joints[at].parent);
    let pelvis = above.filter(|&joint| merged(joint)).last().unwrap_or(def.bodies[0].joint);
    let mut above_pelvis = vec![false; rig.joints.len()];
    let mut at = rig.joints[pelvis].parent;
    while let Some(joint) = at {
        above_pelvis[joint] = true;
        at = rig.joints[joint].parent;
    }
    let counts = carries_character(rig, def);
    let is_head = |&joint: &JointIdx| {
        let hangs = rig.joints[joint].parent.is_none_or(|parent| above_pelvis[parent]);
        joint != pelvis && counts[joint] && !above_pelvis[joint] && hangs
    };
    core::iter::once(pelvis)
        .chain((0..rig.joints.len()).filter(is_head))
        .map(|joint| Head::new(rig, joint))
        .collect()
}

/// Returns all nodes above any head, ascending.
pub(super) fn carriers(rig: &Rig, heads: &[Head]) -> Vec<JointIdx> {
    let mut carriers = Vec::new();
    for head in heads {
        let mut at = rig.joints[head.joint].parent;
        while let Some(joint) = at {
            carriers.push(joint);
            at = rig.joints[joint].parent;
        }
    }
    carriers.sort_unstable();
    carriers.dedup();
    carriers
}

impl Mapping {
    /// Moves a clip's motion of the nodes above the pelvis into the heads. These nodes are then at rest, and every
    /// joint below them keeps its model-space transform.
    pub fn flatten(&self, rig: &Rig, pose: &mut [LocalTransform]) {
        if self.carriers.iter().all(|&joint| pose[joint] == rig.joints[joint].rest) {
            return;
        }
        for index in 0..self.heads.len() {
            let head = &self.heads[index];
            let local = head.parent_from_model * chain(rig, head.joint, |joint| pose[joint]);
            pose[head.joint] = rescaled(&pose[head.joint], &local);
        }
        for &joint in &self.carriers {
            pose[joint] = rig.joints[joint].rest;
        }
    }

    /// Converts a flat pose of a character at `from` (character to world) to a pose of the character at `to`: every
    /// joint keeps its world transform.
    pub fn reframe(&self, pose: &mut [LocalTransform], from: Transform, to: Transform) {
        if from == to {
            return;
        }
        let motion = self.in_model(to.inverse() * from);
        for head in &self.heads {
            let local =
                head.parent_from_model * motion * head.model_from_parent * pose[head.joint].to_affine();
            pose[head.joint] = with_scale_of(&pose[head.joint], &local);
        }
    }
}

/// Returns the local transform of `local`. Each axis keeps the scale of `like`, unless the length of the axis in
/// `local` differs.
fn rescaled(like: &LocalTransform, local: &Affine) -> LocalTransform {
    let m = &local.linear;
    let lengths = Vec3::new(m.x_axis.length(), m.y_axis.length(), m.z_axis.length());
    let mut scale = like.scale;
    for k in 0..3 {
        if (lengths[k] - scale[k].abs()).abs() > 1e-4 * lengths[k] {
            scale[k] = if scale[k] < 0.0 { -lengths[k] } else { lengths[k] };
        }
    }
    with_scale_of(&LocalTransform { scale, ..*like }, local)
}
