//! Particles attached to bodies or to fixed points of the world.

use super::contact::{Obstacle, ObstacleBody};
use super::hub::{Hub, Share};
use super::system::Freedom;
use super::{AddedMass, AttachmentTarget, Part, ParticleGroup};
use crate::id::BodyId;
use sinew_math::{Sym3, Vec3, max};

/// Point that an attached particle follows in one substep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Anchor {
    /// Position at the end of the substep, world, metres.
    pub position: Vec3,
    /// Velocity of the anchor, m/s.
    pub velocity: Vec3,
    /// Velocity change of the body from other forces in the next substep, m/s. The springs are solved for the coming
    /// interval, so they must include it; otherwise a hanging body would hang lower by `g h²`.
    pub gained: Vec3,
    /// Index of the body in the slice of bodies; a body of inverse mass 0 is not moved. `None` for a fixed point of the
    /// world.
    pub body: Option<u32>,
}

impl ParticleGroup {
    /// Places attached particles at their anchors' old positions, with the velocity that moves them to the new ones,
    /// and with the anchors' inertia.
    pub(super) fn hold(&mut self, part: Part, anchors: &[Anchor]) {
        let [from, to] = part.shares();
        let in_trees = self.forest.has_trees();
        for k in 0..anchors.len() {
            let (anchor, i) = (&anchors[k], self.attachments[k].particle as usize);
            let before = anchor.position - anchor.velocity * (part.whole * (1.0 - from));
            self.positions[i] = before;
            self.previous[i] = before;
            let body =
                anchor.body.map(|body| self.holders[body as usize]).filter(|body| body.inverse_mass > 0.0);
            let Some(body) = body else {
                self.system.freedom[i] = Freedom::Fixed;
                self.velocities[i] = anchor.velocity;
                self.weights[i] = 0.0;
                continue;
            };
            let gained = anchor.gained * to;
            let hub = self.forest.hub_of(i);
            let added = self.added[hub];
            if in_trees {
                self.system.points[i] = anchor.position;
                self.system.hubs[hub].take(&body, gained, &added);
            }
            // Rows of the net use a share of the inertia, so that the sum of their impulses is not too large.
            let of_body = added.response_at(&body, anchor.position).inverse()
                * (1.0 / self.forest.hubs()[hub].len() as f32);
            let inertia = self.system.inertia[i] + of_body;
            if !in_trees {
                self.system.momentum[i] += of_body * (body.velocity_at(anchor.position) + gained);
                self.system.inertia[i] = inertia;
            }
            let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z];
            let inverse = inertia.inverse();
            self.weights[i] = (x.dot(inverse * x) + y.dot(inverse * y) + z.dot(inverse * z)) / 3.0;
        }
    }

    /// Adds the impulse of each attachment: the sum of all impulses on its particle that do not change the particle's
    /// momentum. Moves the particle to its anchor.
    pub(super) fn let_go(&mut self, part: Part, anchors: &[Anchor]) {
        let (h, [_, to]) = (part.h(), part.shares());
        for (k, (a, anchor)) in self.attachments.iter().zip(anchors).enumerate() {
            let i = a.particle as usize;
            let lost = self.begun[i] + self.accelerations[i] * h - self.velocities[i];
            let impulse = self.reactions[i] + lost * self.masses[i];
            self.attachment_impulses[k] += impulse;
            if let Some(body) = anchor.body {
                let hub = self.forest.hub_of(i);
                let added = self.added[hub];
                added.push(&mut self.holders[body as usize], anchor.position, impulse);
            }
            self.positions[i] = anchor.position - anchor.velocity * (part.whole * (1.0 - to));
        }
    }

    /// Makes the velocities of an attached particle and its anchor equal after the substep, by an inelastic impact, if
    /// others have pushed the body since; returns the impulse on the body, N·s.
    pub(crate) fn join_held(&mut self, k: usize, anchor: &Anchor, body: &mut ObstacleBody) -> Vec3 {
        let i = self.attachments[k].particle as usize;
        let own = 1.0 / self.masses[i];
        let apart = self.velocities[i] - body.velocity_at(anchor.position) - anchor.gained;
        let added = self.added[self.forest.hub_of(i)];
        let impulse = (added.response_at(body, anchor.position) + Sym3::IDENTITY * own).inverse() * apart;
        self.velocities[i] -= impulse * own;
        self.attachment_impulses[k] += impulse;
        added.push(body, anchor.position, impulse);
        impulse
    }

    /// True if the group can be solved together with others attached to the same body: trees of springs, one iteration.
    pub(crate) fn is_joinable(&self) -> bool {
        self.forest.has_trees() && self.iterations == 1
    }

    /// Bodies that particles of the group are attached to.
    pub(crate) fn bodies(&self) -> impl Iterator<Item = BodyId> {
        self.forest.hubs().iter().filter_map(|hub| self.holder(hub[0]))
    }

    /// Target of a particle's attachment, if it has one.
    pub(crate) fn holder_of(&self, i: usize) -> Option<AttachmentTarget> {
        self.attachments.get(self.attachment_of[i] as usize).map(|attachment| attachment.target)
    }

    /// Body that an attached particle is attached to; `None` for a point of the world.
    fn holder(&self, particle: u32) -> Option<BodyId> {
        match self.attachments[self.attachment_of[particle as usize] as usize].target {
            AttachmentTarget::Body { body, .. } => Some(body),
            AttachmentTarget::World(_) => None,
        }
    }

    /// Clears the contributions of this group and of others to bodies.
    pub(crate) fn forget_shares(&mut self) {
        for hub in &mut self.system.hubs {
            (hub.others, hub.own) = (Share::NONE, Share::NONE);
        }
    }

    /// Adds another group's contributions to shared bodies.
    pub(crate) fn add_shares_of(&mut self, other: &Self) {
        for k in 0..self.forest.hubs().len() {
            let body = self.holder(self.forest.hubs()[k][0]);
            for (hub, held) in other.system.hubs.iter().zip(other.forest.hubs()) {
                if other.holder(held[0]) == body {
                    self.system.hubs[k].others.add(&hub.own);
                }
            }
        }
    }

    /// Clears the contributions of other groups to bodies.
    pub(crate) fn forget_others(&mut self) {
        self.system.hubs.iter_mut().for_each(|hub| hub.others = Share::NONE);
    }

    /// Repeats the first half of the substep with other groups' current contributions to bodies. Returns the largest
    /// relative change of a body's velocity change.
    pub(crate) fn solve_again(&mut self, h: f32, obstacles: &[Obstacle], bodies: &[ObstacleBody]) -> f32 {
        self.system.hubs.iter_mut().for_each(Hub::remember);
        self.settle_contacts(h, obstacles, bodies);
        self.system.hubs.iter().map(Hub::change).fold(0.0, max)
    }

    /// Bodies that particles of the group are attached to, each with its added mass.
    pub(crate) fn holders(&mut self) -> impl Iterator<Item = (BodyId, &mut AddedMass)> {
        let Self { added, forest, attachments, attachment_of, .. } = self;
        let first = |hub: &Vec<u32>| attachments[attachment_of[hub[0] as usize] as usize].target;
        forest.hubs().iter().map(first).zip(added).filter_map(|(target, added)| match target {
            AttachmentTarget::Body { body, .. } => Some((body, added)),
            AttachmentTarget::World(_) => None,
        })
    }
}
