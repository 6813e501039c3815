//! Matches a definition with its rig.
//!
//! ```
//! # let rig = sinew::mannequin::mannequin().rig;
//! # let analysis = sinew_anim::analyze(&rig)?;
//! # let (def, _) = sinew_ragdoll::build(&rig, &analysis, &sinew_ragdoll::BuildOptions::default())?;
//! // The file is exported anew, with a node before all others.
//! let mut again = rig.clone();
//! again.joints.insert(0, sinew_anim::Joint { name: "export".into(), ..again.joints[0].clone() });
//! for (index, joint) in again.joints.iter_mut().enumerate().skip(1) {
//!     joint.parent = Some(joint.parent.map_or(0, |parent| parent + 1));
//!     assert_eq!(joint.name, rig.joints[index - 1].name);
//! }
//! let matched = def.clone().for_rig(&again)?;
//! assert_eq!(matched.bodies[0].joint, def.bodies[0].joint + 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::build::joint_name;
use crate::def::RagdollDef;
use sinew_anim::{JointIdx, Rig};

/// Error for a body whose bone the rig does not have.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RigMismatch {
    /// The rig has no joint of this name, or several of them but none at the old index.
    #[error("the ragdoll's bone `{bone}` is not in this rig")]
    NoBone {
        /// Name of the bone in the definition.
        bone: String,
        /// Index of the body.
        body: usize,
    },
    /// Two bodies name one joint.
    #[error("two bodies of the ragdoll have the bone `{bone}`")]
    Twice {
        /// Name of the joint.
        bone: String,
        /// Index of the later body.
        body: usize,
    },
    /// A joint that moves with a body is not in the rig.
    #[error("the rig has no joint {joint}, which is to move with `{bone}`")]
    NoJoint {
        /// Index of the joint in the definition.
        joint: usize,
        /// Name of the body's bone.
        bone: String,
        /// Index of the body.
        body: usize,
    },
}

impl RigMismatch {
    /// Returns the index of the body concerned.
    pub fn body(&self) -> usize {
        match *self {
            Self::NoBone { body, .. } | Self::Twice { body, .. } | Self::NoJoint { body, .. } => body,
        }
    }
}

impl RagdollDef {
    /// Returns the definition with the joint indices of `rig`, matched by bone names: a re-exported file may order its
    /// joints differently. If a bone has another index, its merged joints are the joints below it.
    ///
    /// # Errors
    /// See [`RigMismatch`].
    pub fn for_rig(mut self, rig: &Rig) -> Result<Self, RigMismatch> {
        let mut taken: Vec<JointIdx> = Vec::new();
        let mut moved = Vec::new();
        for (index, body) in self.bodies.iter_mut().enumerate() {
            let is_here = |joint: JointIdx| joint < rig.joints.len() && joint_name(rig, joint) == body.bone;
            if !is_here(body.joint) {
                let mut named = (0..rig.joints.len()).filter(|&joint| is_here(joint));
                let (Some(joint), None) = (named.next(), named.next()) else {
                    return Err(RigMismatch::NoBone { bone: body.bone.clone(), body: index });
                };
                body.joint = joint;
                moved.push(index);
            }
            if taken.contains(&body.joint) {
                return Err(RigMismatch::Twice { bone: body.bone.clone(), body: index });
            }
            taken.push(body.joint);
        }
        for index in 0..self.bodies.len() {
            if moved.is_empty() {
                let body = &self.bodies[index];
                if let Some(&joint) = body.merged.iter().find(|&&joint| joint >= rig.joints.len()) {
                    return Err(RigMismatch::NoJoint { joint, bone: body.bone.clone(), body: index });
                }
            } else {
                // The old indices have no meaning in a reordered rig; joints below the bone follow it without being
                // listed.
                self.bodies[index].merged.clear();
            }
        }
        Ok(self)
    }
}
