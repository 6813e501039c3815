//! Grips on limbs and other dynamic bodies. A grip holds the touched point with bounded force, and releases it if this
//! force does not suffice.

use super::grasp::{Grab, Grasp};
use super::hold::{Grips, Hold};
use super::physique::Physique;
use super::tuning::PARTED;
use crate::owner::together;
use sinew_math::Vec3;
use sinew_physics::boxes::Overlap;
use sinew_physics::{Aabb, BodyId, BodyKind, JointId, JointState, World};

impl Grips {
    /// Makes one of the character's bodies, by index, grab another body where the two touch.
    pub fn grab(
        &mut self,
        physique: &Physique,
        body: usize,
        held: BodyId,
        grab: &Grab,
        world: &mut World,
    ) -> Option<JointId> {
        let hand = *physique.ids().get(body).filter(|_| physique.has(body))?;
        let moves = |body: BodyId| world.kind(body) == BodyKind::Dynamic;
        let is_own = physique.index_of(held).is_some() || self.held().any(|other| other == held);
        if is_own || !(moves(hand) || moves(held)) {
            return None;
        }
        let point = Grasp::touch(world, held, world.center_of_mass(hand), grab.reach)?;
        self.set_passes(physique.own(), held, true, world);
        let to = match grab.to {
            Some(to) => world.transform(hand).point(to),
            None => Grasp::touch(world, hand, point, f32::INFINITY).unwrap_or(point),
        };
        let (grasp, joint) = Grasp::take(world, [hand, held], [point, to], grab);
        self.holds.push(Hold { held, joint, body: body as u32, drops: grab.drops, grasp: Some(grasp) });
        Some(joint)
    }

    /// Returns true if one of the character's bodies is held: see [`gripped`](Self::gripped).
    pub fn is_gripped(&self, physique: &Physique, world: &World) -> bool {
        self.gripped(physique, world).is_some()
    }

    /// Returns the index of the first of the character's bodies that is held by a hand, a grip or a joint of another
    /// object: another character, a body that is not dynamic, or a body connected to one of these by joints.
    pub fn gripped(&self, physique: &Physique, world: &World) -> Option<usize> {
        let own = physique.own();
        let is_own_joint =
            |joint| physique.drives.is_pin(joint) || self.holds.iter().any(|hold| hold.joint == joint);
        let is_held = |&body: &BodyId| {
            // Joints of ragdolls have owners.
            world.joints_of(body).filter(|&joint| world.joint_owner(joint).is_none()).any(|joint| {
                let other = across(world, joint, body);
                let is_others = !own.contains(&other) && !is_own_joint(joint);
                is_others && world.joint(joint).state == JointState::Enabled && is_anchored(world, other, own)
            })
        };
        own.iter().find(|body| is_held(body)).and_then(|&body| physique.index_of(body))
    }

    /// Returns true if the character's own bodies pass through a body: it is held or was released, or is connected to
    /// such a body.
    pub fn passes_through(&self, world: &World, body: BodyId) -> bool {
        let mut all = self.held().chain(self.freed.iter().copied()).filter(|&held| world.contains(held));
        all.any(|held| held == body || together(world, held).contains(&body))
    }

    /// Enables collision with released bodies that have separated from the character's own bodies.
    pub fn mind_freed(&mut self, own: &[BodyId], world: &mut World) {
        if self.freed.is_empty() {
            return;
        }
        let mut freed = core::mem::take(&mut self.freed);
        freed.retain(|&body| {
            if !world.contains(body) || self.held().any(|held| held == body) {
                return false;
            }
            let whole = together(world, body);
            let (Some(of_own), Some(of_other)) = (around(world, own), around(world, &whole)) else {
                return false;
            };
            let is_near = of_own.overlaps(&of_other);
            for (&own, &other) in own.iter().flat_map(|own| whole.iter().map(move |other| (own, other))) {
                if !is_near {
                    world.enable_pair(own, other);
                }
            }
            is_near
        });
        self.freed = freed;
    }

    /// Sets the motors of all grips for the next step; returns the first body that a grip releases.
    pub(super) fn pull(&mut self, world: &mut World) -> Option<BodyId> {
        for hold in &mut self.holds {
            if let Some(grasp) = &mut hold.grasp
                && !grasp.pull(world, hold.joint, false)
            {
                return Some(hold.held);
            }
        }
        None
    }
}

/// Returns the body of a joint that is not `body`.
fn across(world: &World, joint: JointId, body: BodyId) -> BodyId {
    let (a, b) = world.joint_bodies(joint);
    if a == body { b } else { a }
}

/// Returns true for a body that is not dynamic or belongs to another character, and for a body that joints connect to
/// one of these, like the hook of a crane. The search does not continue through the bodies `own`.
fn is_anchored(world: &World, body: BodyId, own: &[BodyId]) -> bool {
    let (mut found, mut next) = (vec![body], 0);
    while let Some(&body) = found.get(next) {
        next += 1;
        if world.kind(body) != BodyKind::Dynamic || world.body_owner(body).is_some() {
            return true;
        }
        for joint in world.joints_of(body) {
            let other = across(world, joint, body);
            let holds = world.joint(joint).state == JointState::Enabled;
            if holds && !own.contains(&other) && !found.contains(&other) {
                found.push(other);
            }
        }
    }
    false
}

/// Returns true if a mover overlaps these bodies, for instance the mover of a character that dragged them.
pub(super) fn is_entered(world: &World, own: &[BodyId]) -> bool {
    let Some(own) = around(world, own) else { return false };
    world.mover_ids().any(|id| {
        let mover = world.mover(id);
        let (radius, height) = (mover.def().radius, mover.def().height);
        let out = Vec3::new(radius, 0.0, radius);
        let feet = mover.position();
        own.overlaps(&Aabb { min: feet - out, max: feet + out + Vec3::Y * height })
    })
}

/// Returns the bounds of bodies, enlarged by [`PARTED`].
fn around(world: &World, bodies: &[BodyId]) -> Option<Aabb> {
    let bounds = bodies.iter().map(|&body| world.bounds(body)).reduce(|a, b| a.merge(&b))?;
    let room = Vec3::splat(PARTED);
    Some(Aabb { min: bounds.min - room, max: bounds.max + room })
}
