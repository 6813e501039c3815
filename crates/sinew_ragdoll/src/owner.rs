//! Names by which a world tells of bodies and joints that a character, a ragdoll or a limb keeps.

use crate::def::RagdollDef;
use sinew_physics::{BodyId, BodyKind, Owner, World};

/// Name of a limb that was cut off.
const LIMB: &str = "limb";

/// Kind of what keeps bodies in a world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OwnerKind {
    Character,
    Ragdoll,
    Limb,
}

/// Owner of the bodies of a ragdoll; its parts are the bodies, in their order.
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

/// True if a body is one of a limb that was cut off.
pub(crate) fn is_limb(world: &World, body: BodyId) -> bool {
    world.body_owner(body).is_some_and(|(owner, _)| owner.name == LIMB)
}

/// A body that forces move and all such bodies that hang together with it by joints of ragdolls, in order of their distance.
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
