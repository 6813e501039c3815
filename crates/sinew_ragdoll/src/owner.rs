//! Names of the owners that a world reports for bodies and joints of characters, ragdolls and severed limbs.

use crate::def::RagdollDef;
use sinew_physics::{BodyId, BodyKind, Owner, World};

/// Name of the owner of severed limbs.
const LIMB: &str = "limb";

/// Kinds of owner of bodies in a world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OwnerKind {
    Character,
    Ragdoll,
    Limb,
}

/// Returns the owner of the bodies of a ragdoll; its parts are the bodies, in order.
pub(crate) fn owner(def: &RagdollDef, kind: OwnerKind) -> Owner {
    let (name, calls) = match kind {
        OwnerKind::Character => {
            ("character", "`Character::detach` cuts a limb off, `Character::despawn` takes all of it out")
        }
        OwnerKind::Ragdoll => {
            ("ragdoll", "`World::set_joint_state` cuts a joint, `Ragdoll::despawn` takes all of it out")
        }
        OwnerKind::Limb => {
            (LIMB, "`Limb::detach` cuts a part of it off, `Limb::despawn` takes all of it out")
        }
    };
    let part = |body: &crate::RagdollBodyDef| {
        if body.role.is_empty() { body.bone.clone() } else { body.role.clone() }
    };
    Owner { name: name.into(), calls: calls.into(), parts: def.bodies.iter().map(part).collect() }
}

/// Returns true if a body belongs to a severed limb.
pub(crate) fn is_limb(world: &World, body: BodyId) -> bool {
    world.body_owner(body).is_some_and(|(owner, _)| owner.name == LIMB)
}

/// Returns a dynamic body and all dynamic bodies connected to it by ragdoll joints, in order of distance.
pub(crate) fn together(world: &World, body: BodyId) -> Vec<BodyId> {
    let (mut found, mut next) = (vec![body], 0);
    while let Some(&body) = found.get(next) {
        next += 1;
        for joint in world.joints_of(body).filter(|&joint| world.joint_owner(joint).is_some()) {
            let (a, b) = world.joint_bodies(joint);
            for other in [a, b] {
                if world.kind(other) == BodyKind::Dynamic && !found.contains(&other) {
                    found.push(other);
                }
            }
        }
    }
    found
}
