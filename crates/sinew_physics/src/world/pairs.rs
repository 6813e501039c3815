//! World methods for disabled pairs, pair functions and contact modifiers.

use crate::body::contact_rule::{ContactModifier, ContactRule};
use crate::contact::Contact;
use crate::contact::filter::PairFunction;
use crate::id::BodyId;
use crate::world::World;

impl World {
    /// Registers a function for [`set_pair_function`](Self::set_pair_function) under a number of the user's choice,
    /// replacing an earlier function.
    ///
    /// A snapshot contains the number, not the code. Before a world loads a snapshot, the function in the snapshot must
    /// be registered in the world, otherwise loading fails. Register the same function under the same number, or the
    /// future differs.
    pub fn register_pair_function(&mut self, number: u32, function: PairFunction) {
        self.parted.functions.registered.set(number, function);
    }

    /// Sets the registered function that decides from now on whether shape pairs that pass the other filters collide.
    /// Initially `None`: no function. All bodies wake.
    ///
    /// # Panics
    /// If the function is not registered.
    pub fn set_pair_function(&mut self, number: Option<u32>) {
        if let Some(number) = number {
            assert!(self.parted.functions.registered.has(number), "pair function {number} is registered");
        }
        self.parted.functions.chosen = number;
        let ids: Vec<BodyId> = self.body_ids().collect();
        for id in ids {
            self.look_anew(id);
            self.wake_body(id.index);
        }
    }

    /// Number of the active pair function.
    pub fn pair_function(&self) -> Option<u32> {
        self.parted.functions.chosen
    }

    /// Disables collisions between two bodies from now on; if the bodies touch, both wake.
    #[track_caller]
    #[doc(alias = "ignore collision")]
    pub fn disable_pair(&mut self, a: BodyId, b: BodyId) {
        self.expect(a);
        self.expect(b);
        let met = |contact: &Contact| contact.pushes() || contact.touching || contact.sensed;
        if self.contacts_at(a.index).any(|contact| contact.key.has(b.index) && met(contact)) {
            self.wake_pair(a, b);
        }
        self.parted.disable(a.index, b.index);
    }

    /// Reverts [`disable_pair`](Self::disable_pair); both bodies wake. A joint between them may still disable their
    /// collision.
    #[track_caller]
    pub fn enable_pair(&mut self, a: BodyId, b: BodyId) {
        self.expect(a);
        self.expect(b);
        self.wake_pair(a, b);
        self.parted.enable(a.index, b.index);
    }

    /// Makes the next step test a pair again: wakes both bodies, or marks body A as changed if neither can wake.
    fn wake_pair(&mut self, a: BodyId, b: BodyId) {
        self.wake_body(a.index);
        self.wake_body(b.index);
        if !self.bodies.at(a.index).is_active() && !self.bodies.at(b.index).is_active() {
            self.look_anew(a);
        }
    }
}

impl World {
    /// Registers a function for [`ContactRule::Modified`] under a number of the user's choice, replacing an earlier
    /// function.
    ///
    /// A snapshot contains the number, not the code. Before a world loads a snapshot, the functions of the shapes in
    /// the snapshot must be registered in the world, otherwise loading fails. Register the same function under the same
    /// number, or the future differs.
    pub fn register_modifier(&mut self, number: u32, modifier: ContactModifier) {
        self.meetings.modifiers.registered.set(number, modifier);
    }

    /// # Panics
    /// If a rule names a modifier that is not registered.
    pub(crate) fn expect_modifier(&self, rule: ContactRule) {
        assert!(self.knows_rule(rule), "a contact rule's modifier is registered");
    }

    pub(crate) fn knows_rule(&self, rule: ContactRule) -> bool {
        match rule {
            ContactRule::Modified { modifier } => self.meetings.modifiers.registered.has(modifier),
            ContactRule::Push | ContactRule::Ghost | ContactRule::OneWay(_) | ContactRule::Yields(_) => true,
        }
    }
}
