//! World methods for sleep: queries and control.

use crate::body::def::{Quality, Sleeping};
use crate::boxes::Overlap;
use crate::contact::Contact;
use crate::id::BodyId;
use crate::world::World;
use sinew_math::Vec3;
use std::collections::BTreeSet;

impl World {
    /// False while the body sleeps.
    #[track_caller]
    pub fn is_awake(&self, id: BodyId) -> bool {
        self.expect(id).is_awake()
    }

    /// Wakes a body and its island. Restarts the time at rest of a body that is awake.
    #[track_caller]
    #[doc(alias = "wake_up")]
    #[doc(alias = "activate")]
    pub fn wake(&mut self, id: BodyId) {
        self.expect(id);
        self.wake_body(id.index);
    }

    /// Puts a body and its island (by joints and by contacts of the last step) to sleep immediately, even if a body has
    /// no permission to sleep. The usual causes wake the bodies: a moving kinematic body that touches one of them wakes
    /// it in the next step. No effect on sleeping or non-dynamic bodies.
    #[track_caller]
    #[doc(alias = "sleep")]
    #[doc(alias = "deactivate")]
    pub fn put_to_sleep(&mut self, id: BodyId) {
        if self.expect(id).is_active() {
            let island = self.island_of(id.index);
            self.activity.sleep(&mut self.bodies, &island, self.sleepers);
            self.sleepers = self.sleepers.wrapping_add(1);
            // The contacts after the motion of the last step are not known yet.
            island.into_iter().for_each(|index| self.look_anew(self.bodies.id(index)));
        }
    }

    /// Permission of a body to fall asleep.
    #[track_caller]
    pub fn sleeping(&self, id: BodyId) -> Sleeping {
        self.expect(id).sleeping
    }

    /// Sets a body's permission to fall asleep; the body wakes if the permission is revoked.
    #[track_caller]
    pub fn set_sleeping(&mut self, id: BodyId, sleeping: Sleeping) {
        self.expect_mut(id).sleeping = sleeping;
        if sleeping == Sleeping::Off {
            self.wake_body(id.index);
        }
    }

    /// Step quality of a body and its island; `None` for the quality of the world.
    #[track_caller]
    pub fn quality(&self, id: BodyId) -> Option<Quality> {
        self.expect(id).quality
    }

    /// Sets the step quality of a body and its island from the next step on; `None` for the quality of the world.
    #[track_caller]
    pub fn set_quality(&mut self, id: BodyId, quality: Option<Quality>) {
        self.expect_mut(id).quality = quality;
    }

    /// Sets the step quality of all bodies without a quality of their own, from the next step on.
    pub fn set_world_quality(&mut self, quality: Quality) {
        self.def.quality = quality;
    }

    /// Sets the world's gravity, m/s²; all bodies and particle groups wake if it changes.
    ///
    /// # Panics
    /// If the gravity is not finite.
    pub fn set_gravity(&mut self, gravity: Vec3) {
        assert!(gravity.is_finite(), "gravity must be finite, not {gravity:?}");
        if gravity != core::mem::replace(&mut self.def.gravity, gravity) {
            for id in self.body_ids().collect::<Vec<_>>() {
                self.wake_body(id.index);
            }
            self.groups.iter_mut().for_each(|(_, group)| group.wake());
        }
    }

    pub(crate) fn wake_body(&mut self, index: u32) {
        self.activity.disturb(&mut self.bodies, index);
    }

    /// Returns the active bodies of a body's island, ascending.
    fn island_of(&self, index: u32) -> Vec<u32> {
        let pushing = self.contacts.iter().chain(self.activity.contacts()).filter(|contact| contact.pushes());
        let holding = self.joints.iter().filter(|(_, joint)| joint.is_enabled());
        let mut ties: Vec<(u32, u32)> = pushing.map(|contact| (contact.key.a, contact.key.b)).collect();
        ties.extend(holding.map(|(_, joint)| (joint.a, joint.b)));
        ties.retain(|&(a, b)| self.bodies.at(a).is_active() && self.bodies.at(b).is_active());
        let back: Vec<(u32, u32)> = ties.iter().map(|&(a, b)| (b, a)).collect();
        ties.extend(back);
        ties.sort_unstable();
        let mut island = BTreeSet::from([index]);
        let mut edge = vec![index];
        while let Some(body) = edge.pop() {
            let of_body = &ties[ties.partition_point(|tie| tie.0 < body)..];
            let others = of_body.iter().take_while(|tie| tie.0 == body).map(|tie| tie.1);
            edge.extend(others.filter(|&other| island.insert(other)));
        }
        island.into_iter().collect()
    }

    /// Wakes a body with its touching and jointed bodies, before a change that may affect them.
    pub(crate) fn wake_neighbors(&mut self, index: u32) {
        let mut others = core::mem::take(&mut self.around);
        others.clear();
        let touching = self.contacts_at(index).filter(|contact| contact.pushes());
        others.extend(touching.map(|contact| contact.key.other(index)));
        for &joint in self.activity.joints_of.body(index) {
            let joint = self.joints.at(joint);
            others.extend([joint.a, joint.b]);
        }
        self.wake_body(index);
        others.iter().for_each(|&other| self.wake_body(other));
        self.around = others;
        self.wake_groups_around(index);
    }

    /// Wakes particle groups that sleep at a body or are attached to it.
    fn wake_groups_around(&mut self, index: u32) {
        let (id, body) = (self.bodies.id(index), self.bodies.at(index));
        for (_, group) in self.groups.iter_mut() {
            let Some(support) = group.sleep_support() else { continue };
            let shapes = 0..body.shapes.len();
            let bounds = |shape: usize| body.shapes[shape].shape.aabb(&body.world_from_shape(shape));
            if shapes.into_iter().any(|shape| bounds(shape).overlaps(&support.bounds))
                || group.carriers().any(|body| body == id)
            {
                group.wake();
            }
        }
    }

    /// Iterates over the contacts of a body, in unspecified order.
    pub(crate) fn contacts_at(&self, index: u32) -> impl Iterator<Item = &Contact> {
        let own = self.contacts.iter().filter(move |contact| contact.key.has(index));
        own.chain(self.activity.contacts_of(index))
    }

    /// Iterates over all contacts, in order of their keys. Those of the step are sorted; the few others are sorted and
    /// merged in.
    pub(crate) fn contacts_in_order(&self) -> impl Iterator<Item = &Contact> {
        let mut aside: Vec<&Contact> = self.activity.contacts().collect();
        aside.sort_unstable_by_key(|contact| contact.key);
        let (mut awake, mut aside) = (self.contacts.iter().peekable(), aside.into_iter().peekable());
        core::iter::from_fn(move || match (awake.peek(), aside.peek()) {
            (Some(one), Some(other)) if other.key < one.key => aside.next(),
            (None, _) => aside.next(),
            _ => awake.next(),
        })
    }
}
