//! Blows: what a blow lets give way, and how hard one must be to fell.

use crate::character::tuning::{LEGS_WEAKEN, LOW_STANDS, TRUNK_WEAKENS};
use crate::def::RagdollDef;
use crate::drive::{DriveMode, Drives, Muscle};

/// Muscles that hold a limb that was struck until it comes back.
const GIVING: Muscle = Muscle { hertz: 3.0, damping_ratio: 1.0, strength: 0.5 };

/// Impulse that fells a character which is so near the ground (0 upright, 1 lying) by a threshold, N·s.
pub(super) fn felling(least: f32, lowness: f32) -> f32 {
    least * (1.0 + lowness * (LOW_STANDS - 1.0))
}

/// Has the limb that was struck give way.
pub(super) fn give_way(def: &RagdollDef, body: usize, drives: &mut Drives) {
    for root in limb_of(def, body) {
        drives.set_from(def, root, DriveMode::Powered(GIVING), 0.0);
    }
}

/// Bodies that hang on the pelvis.
pub(super) fn pelvis_children(def: &RagdollDef) -> Vec<usize> {
    def.joints.iter().filter(|joint| joint.parent == 0).map(|joint| joint.child).collect()
}

/// Tenses the legs and the trunk of a character that stands: a blow takes less of their strength.
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

/// The bodies from which a blow to one makes all below give way: the limb that it is of, up to the trunk. Of the pelvis, what
/// hangs on it, since the pelvis itself is held.
fn limb_of(def: &RagdollDef, body: usize) -> Vec<usize> {
    let parent = |body: usize| body.checked_sub(1).map(|joint| def.joints[joint].parent);
    let children = |body: usize| def.joints.iter().filter(move |joint| joint.parent == body).count();
    if body == 0 {
        return pelvis_children(def);
    }
    let mut root = body;
    // Where several limbs branch off is the trunk.
    while let Some(above) = parent(root).filter(|&above| above != 0 && children(above) == 1) {
        root = above;
    }
    vec![root]
}
