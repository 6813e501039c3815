//! Bodies attached to a character's bodies: a sword in a hand, a lantern on a belt. Hit bodies and ragdoll are the same
//! bodies, so a body stays attached in every state.

use super::CharacterEvent;
use super::event::Events;
use super::grasp::Grasp;
use crate::owner::together;
use sinew_math::{Transform, Vec3};
use sinew_physics::{
    BodyId, BodyKind, ContactRule, JointDef, JointId, JointKind, MoverId, Strength, Velocity, World, Yields,
};

/// Settings of a hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip {
    /// Transform from the frame of the held body to the frame of the bone's body. Default: identity.
    pub bone_from_held: Transform,
    /// Force and torque beyond which the held body is torn off. Default: unbreakable.
    pub strength: Strength,
    /// True if the character drops the held body when it goes limp. Default false.
    pub drops: bool,
}

impl Default for Grip {
    fn default() -> Self {
        Self { bone_from_held: Transform::IDENTITY, strength: Strength::UNBREAKABLE, drops: false }
    }
}

/// A held body, and the connection by which one of the character's bodies holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hold {
    pub held: BodyId,
    pub joint: JointId,
    /// Index of the body that holds `held`.
    pub body: u32,
    pub drops: bool,
    /// State of a grip that pulls; `None` if the joint is fixed.
    pub grasp: Option<Grasp>,
}

/// Bodies that a character holds or has released, and the body on which it stands. The character's own bodies pass
/// through all of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Grips {
    pub holds: Vec<Hold>,
    /// Released limbs, whose bodies the character's own bodies pass through until they have separated.
    pub freed: Vec<BodyId>,
    /// Dynamic body on which the mover stands.
    pub bearer: Option<BodyId>,
}

impl Grips {
    /// Moves a body to one of the character's bodies, `ids[body]`, gives it that body's motion, and attaches it with a
    /// fixed joint.
    pub fn hold(
        &mut self,
        (ids, own): (&[BodyId], &[BodyId]),
        body: usize,
        held: BodyId,
        grip: &Grip,
        world: &mut World,
    ) -> JointId {
        let holder = ids[body];
        let Velocity { linear, angular } = world.velocity(holder);
        let place = world.transform(holder) * grip.bone_from_held;
        let arm: Vec3 = place.translation - world.center_of_mass(holder);
        world.set_transform(held, place);
        world.set_velocity(held, Velocity { linear: linear + angular.cross(arm), angular });
        self.set_passes(own, held, true, world);
        let joint = world.add_joint(&JointDef {
            strength: grip.strength,
            ..JointDef::between(holder, held, grip.bone_from_held, Transform::IDENTITY, JointKind::Fixed)
        });
        self.holds.push(Hold { held, joint, body: body as u32, drops: grip.drops, grasp: None });
        joint
    }

    /// Releases a held body; returns false if the character does not hold it.
    pub fn release(&mut self, own: &[BodyId], held: BodyId, world: &mut World, events: &mut Events) -> bool {
        let Some(index) = self.holds.iter().position(|hold| hold.held == held) else { return false };
        let hold = self.holds.remove(index);
        if world.contains_joint(hold.joint) {
            world.remove_joint(hold.joint);
        }
        if world.contains(held) {
            self.set_passes(own, held, false, world);
        }
        events.push(CharacterEvent::LetGo { body: hold.body as usize, held });
        true
    }

    /// Returns the held bodies, in the order in which the character took them.
    pub fn held(&self) -> impl Iterator<Item = BodyId> {
        self.holds.iter().map(|hold| hold.held)
    }

    /// Releases held bodies that were torn off or removed, and lets the grips pull in the next step.
    pub fn mind(&mut self, own: &[BodyId], world: &mut World, events: &mut Events) {
        while let Some(lost) = self.torn(world) {
            self.release(own, lost, world, events);
        }
        while let Some(lost) = self.pull(world) {
            self.release(own, lost, world, events);
        }
    }

    fn torn(&self, world: &World) -> Option<BodyId> {
        let is_lost = |hold: &&Hold| {
            !world.contains(hold.held)
                || !world.contains_joint(hold.joint)
                || world.events().broken.contains(&hold.joint)
        };
        Some(self.holds.iter().find(is_lost)?.held)
    }

    /// Releases all held bodies, or only those that the character drops when it goes limp.
    pub fn release_all(
        &mut self,
        own: &[BodyId],
        only_dropped: bool,
        world: &mut World,
        events: &mut Events,
    ) {
        let next = |hold: &&Hold| hold.drops || !only_dropped;
        while let Some(hold) = self.holds.iter().find(next).copied() {
            self.release(own, hold.held, world, events);
        }
    }

    /// Releases the bodies that are held by the bodies with the indices `parts`.
    pub fn drop_from(&mut self, own: &[BodyId], parts: &[usize], world: &mut World, events: &mut Events) {
        let holds = self.holds.iter();
        let dropped: Vec<BodyId> =
            holds.filter(|hold| parts.contains(&(hold.body as usize))).map(|hold| hold.held).collect();
        for held in dropped {
            self.release(own, held, world, events);
        }
    }

    /// Sets whether a body passes through the character's bodies and through movers. For a body of another character
    /// this applies to all of that character's bodies; after a release the two characters collide again once they have
    /// separated.
    pub fn set_passes(&mut self, own: &[BodyId], other: BodyId, passes: bool, world: &mut World) {
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
        for &own in own {
            for &other in &whole {
                if passes {
                    world.disable_pair(own, other);
                } else {
                    world.enable_pair(own, other);
                }
            }
        }
    }

    /// Lets the character's bodies pass through the dynamic body under its mover, so that this body gets only the
    /// mover's weight. Otherwise feet that kick the crate on which their character rides would accelerate both without
    /// end.
    pub fn spare_bearer(&mut self, own: &[BodyId], mover: Option<MoverId>, world: &mut World) {
        let ground = mover.and_then(|mover| world.mover_ground(mover));
        let bearer = ground.and_then(|ground| ground.shape).map(|shape| shape.body);
        let bearer = bearer.filter(|&body| world.kind(body) == BodyKind::Dynamic);
        let bearer = bearer.filter(|&body| self.held().all(|held| held != body));
        if self.bearer == bearer {
            return;
        }
        let before = core::mem::replace(&mut self.bearer, bearer).filter(|&body| world.contains(body));
        let before = before.filter(|&body| !self.passes_through(world, body));
        for &own in own {
            if let Some(before) = before {
                world.enable_pair(own, before);
            }
            if let Some(bearer) = bearer {
                world.disable_pair(own, bearer);
            }
        }
    }
}
