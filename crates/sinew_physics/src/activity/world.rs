//! Sleep as a user sees it: asked, and changed by hand.

use crate::contact::Contact;
use crate::id::BodyId;
use crate::world::World;

impl World {
    /// False while it sleeps.
    pub fn is_awake(&self, id: BodyId) -> bool {
        self.expect(id).is_awake()
    }

    /// Wakes a body and its island.
    pub fn wake(&mut self, id: BodyId) {
        self.expect(id);
        self.wake_body(id.index);
    }

    pub(crate) fn wake_body(&mut self, index: u32) {
        self.activity.wake(&mut self.bodies, index);
    }

    /// Wakes a body and all that touches it, or hangs on it by a joint: something about it is to change that they may feel.
    pub(crate) fn wake_around(&mut self, index: u32) {
        let touching = self.contacts_of(index).filter(|contact| contact.pushes());
        let mut others: Vec<u32> = touching.map(|contact| contact.key.other(index)).collect();
        for &joint in self.activity.joints_of.body(index) {
            let joint = self.joints.at(joint);
            others.extend([joint.a, joint.b]);
        }
        self.wake_body(index);
        others.into_iter().for_each(|other| self.wake_body(other));
    }

    /// The contacts of a body, in no order that means anything.
    pub(crate) fn contacts_of(&self, index: u32) -> impl Iterator<Item = &Contact> {
        let own = self.contacts.iter().filter(move |contact| contact.key.has(index));
        own.chain(self.activity.contacts_of(index))
    }

    /// All contacts, in order of their keys.
    pub(crate) fn contacts_in_order(&self) -> Vec<&Contact> {
        let mut all: Vec<&Contact> = self.contacts.iter().chain(self.activity.contacts()).collect();
        all.sort_unstable_by_key(|contact| contact.key);
        all
    }
}
