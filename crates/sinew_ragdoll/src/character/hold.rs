//! Bodies that hang on a character's: a sword in a hand, a lantern on a belt. Hit bodies and ragdoll are the same bodies, so that what hangs
//! on them does in every state.

use super::memory::Hold;
use super::{Character, CharacterEvent};
use crate::owner::{is_limb, together};
use sinew_math::{Transform, Vec3};
use sinew_physics::{BodyId, ContactRule, JointDef, JointId, JointKind, Strength, Velocity, World, Yields};

/// A way to hold a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip {
    /// From the frame of what is held to the frame of the bone's body. Default: they are one.
    pub bone_from_held: Transform,
    /// Force and torque beyond which the held body is torn off. Default unbreakable.
    pub strength: Strength,
    /// It is dropped when the character goes limp. Default false.
    pub drops: bool,
}

impl Default for Grip {
    fn default() -> Self {
        Self { bone_from_held: Transform::IDENTITY, strength: Strength::UNBREAKABLE, drops: false }
    }
}

impl Character {
    /// Has one of its bodies (by role or bone) hold a dynamic body of the world, which is put there, on a fixed joint. As long as it
    /// is held it passes through the character's own bodies and through movers. For limbs of others there is [`grab`](Self::grab).
    ///
    /// # Panics
    /// If no body is called so or it was [cut off](Self::detach), the character has none in the world, it holds that one already, or that is a part of a character or ragdoll.
    #[track_caller]
    pub fn hold(&mut self, world: &mut World, bone: &str, held: BodyId, grip: &Grip) -> JointId {
        let body = self.def.body_named(bone).unwrap_or_else(|| panic!("no body is called '{bone}'"));
        assert!(self.has_body(body), "it has lost '{bone}'");
        assert!(!self.bodies().is_empty(), "a character without bodies holds nothing");
        assert!(self.held().all(|other| other != held), "it holds that body already");
        if let Some((owner, part)) = world.body_owner(held).filter(|_| !is_limb(world, held)) {
            panic!("{held:?} is the {}'s {part}: `Character::grab` takes hold of it", owner.name);
        }
        let holder = self.bodies()[body];
        let Velocity { linear, angular } = world.velocity(holder);
        let place = world.transform(holder) * grip.bone_from_held;
        let arm: Vec3 = place.translation - world.center_of_mass(holder);
        world.set_transform(held, place);
        world.set_velocity(held, Velocity { linear: linear + angular.cross(arm), angular });
        self.set_passes(world, held, true);
        let joint = world.add_joint(&JointDef {
            strength: grip.strength,
            ..JointDef::between(holder, held, grip.bone_from_held, Transform::IDENTITY, JointKind::Fixed)
        });
        let presence = self.presence.as_mut().expect("a character with bodies is in the world");
        presence.holds.push(Hold { held, joint, body: body as u32, drops: grip.drops, grasp: None });
        joint
    }

    /// Lets go of what it holds; false if it does not hold that.
    pub fn release(&mut self, world: &mut World, held: BodyId) -> bool {
        let Some(presence) = &mut self.presence else { return false };
        let Some(index) = presence.holds.iter().position(|hold| hold.held == held) else { return false };
        let hold = presence.holds.remove(index);
        if world.contains_joint(hold.joint) {
            world.remove_joint(hold.joint);
        }
        if world.contains(held) {
            self.set_passes(world, held, false);
        }
        self.events.push(CharacterEvent::LetGo { body: hold.body as usize, held });
        true
    }

    /// Bodies that it holds, in the order in which it took them.
    pub fn held(&self) -> impl Iterator<Item = BodyId> {
        self.presence.iter().flat_map(|presence| &presence.holds).map(|hold| hold.held)
    }

    /// Lets go of what was torn off or is no longer there.
    pub(super) fn mind_holds(&mut self, world: &mut World) {
        while let Some(lost) = self.lost(world) {
            self.release(world, lost);
        }
        while let Some(lost) = self.pull_grips(world) {
            self.release(world, lost);
        }
    }

    fn lost(&self, world: &World) -> Option<BodyId> {
        let is_lost = |hold: &&Hold| {
            !world.contains(hold.held)
                || !world.contains_joint(hold.joint)
                || world.events().broken.contains(&hold.joint)
        };
        Some(self.presence.as_ref()?.holds.iter().find(is_lost)?.held)
    }

    /// Lets go of what it holds, or only of what it drops when it goes limp.
    pub(super) fn release_all(&mut self, world: &mut World, only_dropped: bool) {
        let next = |hold: &&Hold| hold.drops || !only_dropped;
        while let Some(hold) =
            self.presence.as_ref().and_then(|presence| presence.holds.iter().find(next)).copied()
        {
            self.release(world, hold.held);
        }
    }

    /// Lets a body pass through those of the character and through movers, or takes that back. One that a character keeps has rules of its own, and takes all of that
    /// along; the two collide again once they are apart.
    pub(super) fn set_passes(&mut self, world: &mut World, other: BodyId, passes: bool) {
        let rule = if passes { ContactRule::Yields(Yields::default()) } else { ContactRule::Push };
        let is_owned = world.body_owner(other).is_some();
        let shapes: Vec<_> = world.shape_ids(other).filter(|_| !is_owned).collect();
        for shape in shapes {
            world.set_contact_rule(shape, rule);
        }
        let whole = if is_owned { together(world, other) } else { vec![other] };
        if is_owned && !passes {
            self.freed.push(other);
            return;
        }
        for &own in self.own() {
            for &other in &whole {
                if passes {
                    world.disable_pair(own, other);
                } else {
                    world.enable_pair(own, other);
                }
            }
        }
    }
}
