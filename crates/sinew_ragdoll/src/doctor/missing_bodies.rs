//! Bodies that a definition lacks, taken from a build of its rig.

use super::Repair;
use super::exam::anchors;
use crate::def::{RagdollDef, RagdollJointDef};
use sinew_math::Transform;

/// Adds the body of a role, and its missing descendants in the rig; returns false without the rig or such a bone.
pub(super) fn add_missing(repair: &mut Repair, role: &str) -> bool {
    let Some(rig) = repair.reference.clone() else { return false };
    let Some(found) = rig.bodies.iter().position(|body| body.role == role) else { return false };
    let mut added = false;
    for body in found..rig.bodies.len() {
        let hangs_there = body == found || is_below(&rig, body, found);
        if hangs_there && !repair.def.bodies.iter().any(|own| own.bone == rig.bodies[body].bone) {
            add(&mut repair.def, &rig, body);
            added = true;
        }
    }
    if added {
        put_in_order(&mut repair.def, &mut repair.springs);
    }
    added
}

fn is_below(rig: &RagdollDef, body: usize, above: usize) -> bool {
    let mut at = body;
    while at > above {
        let Some(joint) = at.checked_sub(1).and_then(|joint| rig.joints.get(joint)) else { return false };
        at = joint.parent;
    }
    at == above
}

/// Appends one body of the rig's build, and reattaches its children.
fn add(def: &mut RagdollDef, rig: &RagdollDef, body: usize) {
    let new = def.bodies.len();
    let own_of =
        |def: &RagdollDef, body: usize| def.bodies.iter().position(|own| own.bone == rig.bodies[body].bone);
    let Some(joint) = body.checked_sub(1).map(|joint| &rig.joints[joint]) else { return };
    // Find the nearest existing body above.
    let mut above = joint.parent;
    let parent = loop {
        match own_of(def, above) {
            Some(own) => break own,
            None if above == 0 => break 0,
            None => above = rig.joints[above - 1].parent,
        }
    };
    def.bodies.push(rig.bodies[body].clone());
    let carried = hung(def, rig, joint, parent, new);
    def.joints.push(carried);
    for below in rig.joints.iter().filter(|joint| joint.parent == body) {
        let Some(own) = own_of(def, below.child) else { continue };
        if own > 0 && own != new {
            def.joints[own - 1] = hung(def, rig, below, new, own);
        }
    }
    for &(a, b) in &rig.disabled_pairs {
        if (a == body || b == body)
            && let (Some(a), Some(b)) = (own_of(def, a), own_of(def, b))
        {
            def.disabled_pairs.push((usize::min(a, b), usize::max(a, b)));
        }
    }
    def.total_mass = def.bodies.iter().map(|body| body.mass.mass).sum();
    def.dropped_bones.retain(|bone| *bone != rig.bodies[body].bone);
}

/// Returns a joint of the rig's build between two bodies of the definition, whose frames may differ.
fn hung(
    def: &RagdollDef,
    rig: &RagdollDef,
    joint: &RagdollJointDef,
    parent: usize,
    child: usize,
) -> RagdollJointDef {
    let [pivot, _] = anchors(rig, joint);
    let onto = |own: usize, of: usize, frame: Transform| {
        let turned = rig.bodies[of].character_from_body.rotation * frame.rotation;
        def.bodies[own].character_from_body.inverse() * Transform::new(pivot, turned)
    };
    RagdollJointDef {
        parent,
        child,
        frame_parent: onto(parent, joint.parent, joint.frame_parent),
        frame_child: onto(child, joint.child, joint.frame_child),
        ..*joint
    }
}

/// Restores the order of parents before children, with joints in the order of the bodies. If that fails, the order
/// stays.
fn put_in_order<T: Clone>(def: &mut RagdollDef, springs: &mut Vec<Option<T>>) {
    let parent_of = |body: usize| body.checked_sub(1).map(|joint| def.joints[joint].parent);
    let mut order: Vec<usize> = Vec::with_capacity(def.bodies.len());
    while order.len() < def.bodies.len() {
        let is_next = |&body: &usize| {
            !order.contains(&body) && parent_of(body).is_none_or(|parent| order.contains(&parent))
        };
        let Some(next) = (0..def.bodies.len()).find(is_next) else { return };
        order.push(next);
    }
    let place = |body: usize| order.iter().position(|&old| old == body).unwrap_or(body);
    let bodies = order.iter().map(|&old| def.bodies[old].clone()).collect();
    let joints = order[1..].iter().map(|&old| {
        let joint = def.joints[old - 1];
        RagdollJointDef { parent: place(joint.parent), child: place(joint.child), ..joint }
    });
    let new_springs = order[1..].iter().map(|&old| springs.get(old - 1).cloned().flatten());
    let joints = joints.collect();
    let new_springs = new_springs.collect();
    let mut pairs: Vec<(usize, usize)> = def
        .disabled_pairs
        .iter()
        .map(|&(a, b)| {
            let (a, b) = (place(a), place(b));
            (usize::min(a, b), usize::max(a, b))
        })
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    (def.bodies, def.joints, def.disabled_pairs, *springs) = (bodies, joints, pairs, new_springs);
}
