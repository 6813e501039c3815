//! Sleep as a user sees it: asked, and changed by hand.

use crate::body::def::{Quality, Sleeping};
use crate::boxes::Overlap;
use crate::contact::Contact;
use crate::id::BodyId;
use crate::world::World;
use sinew_math::Vec3;
use std::collections::BTreeSet;

impl World {
    /// False while it sleeps.
    #[track_caller]
    pub fn is_awake(&self, id: BodyId) -> bool {
        self.expect(id).is_awake()
    }

    /// Wakes a body and its island. One that is awake stays so for as long as if it had just woken.
    #[track_caller]
    #[doc(alias = "wake_up")]
    #[doc(alias = "activate")]
    pub fn wake(&mut self, id: BodyId) {
        self.expect(id);
        self.wake_body(id.index);
    }

    /// Puts a body to sleep at once, and with it all that it hangs together with by joints and by contacts of the last step,
    /// whether it may fall asleep by itself or not. What wakes sleepers wakes them as well: a moving kinematic body that
    /// one of them touches does so in the next step. Nothing happens to what sleeps already, or is not dynamic.
    #[track_caller]
    #[doc(alias = "sleep")]
    #[doc(alias = "deactivate")]
    pub fn put_to_sleep(&mut self, id: BodyId) {
        if self.expect(id).is_active() {
            let island = self.island_of(id.index);
            self.activity.sleep(&mut self.bodies, &island, self.sleepers);
            self.sleepers = self.sleepers.wrapping_add(1);
            // Where the last step has brought them nothing has looked yet.
            island.into_iter().for_each(|index| self.look_anew(self.bodies.id(index)));
        }
    }

    /// Permission of a body to fall asleep by itself.
    #[track_caller]
    pub fn sleeping(&self, id: BodyId) -> Sleeping {
        self.expect(id).sleeping
    }

    /// Says whether a body may fall asleep by itself; it wakes if it may not.
    #[track_caller]
    pub fn set_sleeping(&mut self, id: BodyId, sleeping: Sleeping) {
        self.expect_mut(id).sleeping = sleeping;
        if sleeping == Sleeping::Off {
            self.wake_body(id.index);
        }
    }

    /// Quality of the step for a body and what hangs together with it; `None`: as the world has it.
    #[track_caller]
    pub fn quality(&self, id: BodyId) -> Option<Quality> {
        self.expect(id).quality
    }

    /// Sets the quality of the step for a body and what hangs together with it, from the next step on; `None`: as the world has it.
    #[track_caller]
    pub fn set_quality(&mut self, id: BodyId, quality: Option<Quality>) {
        self.expect_mut(id).quality = quality;
    }

    /// Sets the quality of the step for all bodies that have none of their own, from the next step on.
    pub fn set_world_quality(&mut self, quality: Quality) {
        self.def.quality = quality;
    }

    /// Sets the world's gravity, m/s²; everything wakes, if it is another than before.
    ///
    /// # Panics
    /// If it is not finite.
    pub fn set_gravity(&mut self, gravity: Vec3) {
        assert!(gravity.is_finite(), "gravity is finite, not {gravity:?}");
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

    /// The active bodies that hang together with one, ascending.
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

    /// Wakes a body and all that touches it, or hangs on it by a joint: something about it is to change that they may feel.
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

    /// Wakes particle groups that sleep where a body is, or hang on it.
    fn wake_groups_around(&mut self, index: u32) {
        let (id, body) = (self.bodies.id(index), self.bodies.at(index));
        for (_, group) in self.groups.iter_mut() {
            let Some(bed) = group.bed() else { continue };
            let shapes = 0..body.shapes.len();
            let bounds = |shape: usize| body.shapes[shape].shape.aabb(&body.world_from_shape(shape));
            if shapes.into_iter().any(|shape| bounds(shape).overlaps(&bed.bounds))
                || group.carriers().any(|body| body == id)
            {
                group.wake();
            }
        }
    }

    /// The contacts of a body, in no order that means anything.
    pub(crate) fn contacts_at(&self, index: u32) -> impl Iterator<Item = &Contact> {
        let own = self.contacts.iter().filter(move |contact| contact.key.has(index));
        own.chain(self.activity.contacts_of(index))
    }

    /// All contacts, in order of their keys: those of the step are, and those aside, few or none, are sorted and merged in.
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
