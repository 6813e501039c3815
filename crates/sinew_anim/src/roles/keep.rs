//! Which joints become bodies, what they take with them, and what they hang on.

use super::bind::Bound;
use super::graph::{Graph, ancestors};
use super::role::Role;
use super::{KeptBone, RoleGuess};
use crate::rig::{JointIdx, Rig};

/// Least share of all skin for a creature's body, or for a part of the spine of its own.
const LEAST_SHARE: f32 = 0.004;

/// A clavicle shorter than this share of the height is no body.
const LEAST_CLAVICLE: f32 = 0.05;

/// What selection works on.
pub(super) struct Selection<'a> {
    pub rig: &'a Rig,
    pub bound: &'a Bound,
    pub graph: &'a Graph,
    /// Role per joint.
    pub roles: &'a [Option<RoleGuess>],
    /// From floor to crown, file units.
    pub height: f32,
    /// Per joint what carries it, by geometry where the rig's own parent does not.
    pub carrier: Vec<Option<JointIdx>>,
}

/// The bodies, and per joint the body's joint it follows.
pub(super) struct Kept {
    pub bones: Vec<KeptBone>,
    pub merge_into: Vec<Option<JointIdx>>,
}

/// What carries each joint: the rig's parent, or for strays what they were adopted by; for a stray without skin the
/// bone at whose end it sits.
pub(super) fn carriers(rig: &Rig, bound: &Bound, graph: &Graph) -> Vec<Option<JointIdx>> {
    let mut carrier: Vec<Option<JointIdx>> = rig.joints.iter().map(|joint| joint.parent).collect();
    let mut in_body = vec![false; rig.joints.len()];
    let mut above = vec![false; rig.joints.len()];
    for node in &graph.nodes {
        in_body[node.joint] = true;
        ancestors(rig, node.joint).for_each(|ancestor| above[ancestor] = true);
    }
    for &stray in &graph.adopted {
        let node = &graph.nodes[stray];
        carrier[node.joint] = node.parent.map(|parent| graph.nodes[parent].joint);
    }
    let hangs: Vec<bool> = (0..rig.joints.len())
        .map(|joint| in_body[joint] || ancestors(rig, joint).any(|ancestor| in_body[ancestor]))
        .collect();
    for joint in 0..rig.joints.len() {
        if hangs[joint] || above[joint] {
            continue;
        }
        let place = bound.model[joint].translation;
        let sits = |&end: &JointIdx| {
            hangs[end]
                && !in_body[end]
                && (bound.model[end].translation - place).length() < 0.01 * bound.size()
        };
        if let Some(end) = (0..rig.joints.len()).find(sits) {
            carrier[joint] = Some(end);
        }
    }
    carrier
}

impl Selection<'_> {
    /// Bodies of a humanoid: one per role, less toes, tiny clavicles, and what has too little skin.
    pub fn humanoid(&self) -> Kept {
        let mut joints: Vec<JointIdx> = Vec::new();
        for role in super::role::HUMANOID_ROLES {
            joints.extend(self.joint_of(role).filter(|_| !matches!(role, Role::Toes(_))));
        }
        self.drop_short_clavicles(&mut joints);
        self.join_thin_spine(&mut joints);
        self.drop_bare(&mut joints);
        let parent = |joint: JointIdx, kept: &[JointIdx]| {
            let parents = self.role(joint).anatomical_parents().iter();
            parents.filter_map(|&role| self.joint_of(role)).find_map(|p| kept.iter().position(|&k| k == p))
        };
        self.bones(&joints, parent)
    }

    /// Bodies of a creature: every joint with a fair share of skin.
    pub fn creature(&self) -> Kept {
        let total: f32 = self.bound.area.iter().sum();
        let fair = |&&i: &&usize| i == self.graph.root || self.graph.nodes[i].area >= LEAST_SHARE * total;
        let joints: Vec<JointIdx> =
            self.graph.order.iter().filter(fair).map(|&i| self.graph.nodes[i].joint).collect();
        let parent = |joint: JointIdx, kept: &[JointIdx]| {
            let carried = self.carried_by(joint, |ancestor| kept.contains(&ancestor))?;
            kept.iter().position(|&k| k == carried)
        };
        self.bones(&joints, parent)
    }

    fn role(&self, joint: JointIdx) -> Role {
        self.roles[joint].as_ref().expect("kept joints have roles").role
    }

    fn joint_of(&self, role: Role) -> Option<JointIdx> {
        self.roles.iter().position(|guess| guess.as_ref().is_some_and(|guess| guess.role == role))
    }

    /// The nearest carrier that passes. Adoption cannot make a circle, but the walk is bounded all the same.
    fn carried_by(&self, joint: JointIdx, wanted: impl Fn(JointIdx) -> bool) -> Option<JointIdx> {
        let chain = core::iter::successors(self.carrier[joint], |&i| self.carrier[i]);
        chain.take(self.rig.joints.len()).find(|&i| wanted(i))
    }

    fn drop_short_clavicles(&self, joints: &mut Vec<JointIdx>) {
        joints.retain(|&joint| match self.role(joint) {
            Role::Shoulder(side) => self.joint_of(Role::UpperArm(side)).is_some_and(|arm| {
                let bone = self.bound.model[arm].translation - self.bound.model[joint].translation;
                bone.length() >= LEAST_CLAVICLE * self.height
            }),
            _ => true,
        });
    }

    /// Parts of the spine with hardly any skin are joined with the part above, which then turns at the lower joint.
    fn join_thin_spine(&self, joints: &mut Vec<JointIdx>) {
        let total: f32 = self.bound.area.iter().sum();
        let spine = [Role::Spine, Role::Chest, Role::UpperChest];
        let parts: Vec<JointIdx> =
            joints.iter().copied().filter(|&j| spine.contains(&self.role(j))).collect();
        let mut open = false;
        let mut sum = 0.0;
        for part in parts {
            if open {
                joints.retain(|&joint| joint != part);
            } else {
                sum = 0.0;
            }
            sum += self.bound.area[part];
            open = sum < LEAST_SHARE * total;
        }
    }

    /// Removes joints that would have no skin even with what they take along; the root stays.
    fn drop_bare(&self, joints: &mut Vec<JointIdx>) {
        loop {
            let area = |joint: JointIdx| -> f32 {
                let follows = |&j: &JointIdx| {
                    j == joint
                        || !joints.contains(&j) && self.carried_by(j, |i| joints.contains(&i)) == Some(joint)
                };
                (0..self.rig.joints.len()).filter(follows).map(|j| self.bound.area[j]).sum()
            };
            let Some(bare) = joints.iter().skip(1).position(|&joint| area(joint) <= 0.0) else { return };
            joints.remove(bare + 1);
        }
    }

    fn bones(&self, joints: &[JointIdx], parent: impl Fn(JointIdx, &[JointIdx]) -> Option<usize>) -> Kept {
        let mut bones: Vec<KeptBone> = Vec::with_capacity(joints.len());
        for (i, &joint) in joints.iter().enumerate() {
            let guess = self.roles[joint].as_ref().expect("kept joints have roles");
            bones.push(KeptBone {
                joint,
                role: guess.role,
                confidence: guess.confidence,
                // All but the first hang on something; on the first where nothing nearer is kept.
                parent: parent(joint, joints).or((i > 0).then_some(0)),
                merged: Vec::new(),
                bind_model: self.bound.model[joint],
            });
        }
        let mut merge_into = vec![None; self.rig.joints.len()];
        for joint in 0..self.rig.joints.len() {
            if joints.contains(&joint) {
                continue;
            }
            let carried = self.carried_by(joint, |i| joints.contains(&i));
            // Skin must go somewhere; a joint without skin and without a carrier keeps its own motion.
            let target = carried.or((self.bound.area[joint] > 0.0).then(|| joints[0]));
            if let Some(bone) = target.and_then(|t| joints.iter().position(|&k| k == t)) {
                bones[bone].merged.push(joint);
                merge_into[joint] = target;
            }
        }
        Kept { bones, merge_into }
    }
}
