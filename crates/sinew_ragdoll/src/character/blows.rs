//! Hits: the bodies that become weak, and the impulse that makes a character fall.

use crate::character::tuning::{LEGS_WEAKEN, LOW_STANDS, TRUNK_WEAKENS};
use crate::def::RagdollDef;
use crate::drive::{DriveMode, Drives, Muscle};

/// Drive of a struck limb until it starts to return.
const GIVING: Muscle = Muscle { hertz: 3.0, damping_ratio: 1.0, strength: 0.5 };

/// Returns the impulse that makes a character fall, N·s. `least` is the threshold of an upright character; `lowness` is
/// 0 for an upright character and 1 for one that lies.
pub(super) fn felling(least: f32, lowness: f32) -> f32 {
    least * (1.0 + lowness * (LOW_STANDS - 1.0))
}

/// Makes the struck limb weak.
pub(super) fn give_way(def: &RagdollDef, body: usize, drives: &mut Drives) {
    for root in limb_of(def, body) {
        drives.set_from(def, root, DriveMode::Powered(GIVING), 0.0);
    }
}

/// Returns the bodies whose parent is the pelvis.
pub(super) fn pelvis_children(def: &RagdollDef) -> Vec<usize> {
    def.joints.iter().filter(|joint| joint.parent == 0).map(|joint| joint.child).collect()
}

/// Limits how much a hit weakens the legs and the trunk of a standing character.
pub(super) fn tense(def: &RagdollDef, drives: &mut Drives) {
    for (index, body) in def.bodies.iter().enumerate() {
        let is_leg = ["Leg", "Foot", "Toes"].iter().any(|part| body.role.ends_with(part));
        let is_trunk = ["hips", "spine", "chest", "upperChest"].contains(&body.role.as_str());
        if index == 0 || is_leg {
            drives.steady(index, LEGS_WEAKEN);
        } else if is_trunk {
            drives.steady(index, TRUNK_WEAKENS);
        }
    }
}

/// Returns the bodies whose subtrees a hit weakens: the struck limb up to the trunk; for the pelvis its children,
/// because a pin holds the pelvis itself.
fn limb_of(def: &RagdollDef, body: usize) -> Vec<usize> {
    let parent = |body: usize| body.checked_sub(1).map(|joint| def.joints[joint].parent);
    let children = |body: usize| def.joints.iter().filter(move |joint| joint.parent == body).count();
    if body == 0 {
        return pelvis_children(def);
    }
    let mut root = body;
    // A body with several branches is the trunk.
    while let Some(above) = parent(root).filter(|&above| above != 0 && children(above) == 1) {
        root = above;
    }
    vec![root]
}
