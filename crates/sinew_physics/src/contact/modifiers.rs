//! User functions that modify contacts, and their results in this step.

use crate::arena::Arena;
use crate::body::Body;
use crate::body::contact_rule::{ContactModifier, ContactRule, ContactSide, FoundContact};
use crate::body::material::ContactMaterial;
use crate::contact::{Contact, ContactMemory, Effect};
use crate::id::ShapeId;
use crate::registered::Registered;

#[derive(Clone, Debug, Default)]
pub(crate) struct Modifiers {
    pub registered: Registered<ContactModifier>,
    /// Indices of the contacts modified in this step, ascending, with their materials.
    changed: Vec<(u32, ContactMaterial)>,
}

impl Modifiers {
    /// Calls the modifiers for the contacts of this step; they may change the material or disable the push.
    pub fn change(&mut self, bodies: &Arena<Body>, contacts: &mut [Contact], step: u64) {
        self.changed.clear();
        if self.registered.is_empty() {
            return;
        }
        self.changed.reserve(contacts.len());
        for (place, contact) in contacts.iter_mut().enumerate().filter(|(_, contact)| contact.pushes()) {
            let own = |contact: &Contact| contact.material(bodies);
            if let Some(material) = self.ask(bodies, contact, own, step) {
                self.changed.push((place as u32, material));
            }
        }
    }

    /// Returns the material that a modifier gives to a contact with combined material `own`; `None` if the material
    /// does not change, or the modifier disables the push.
    pub fn ask(
        &self,
        bodies: &Arena<Body>,
        contact: &mut Contact,
        own: impl Fn(&Contact) -> ContactMaterial,
        step: u64,
    ) -> Option<ContactMaterial> {
        let sides = [(contact.key.a, contact.key.shape_a), (contact.key.b, contact.key.shape_b)];
        let rules = sides.map(|(body, shape)| bodies.at(body).surface(shape as usize).rule);
        let mut material = None;
        for rule in rules {
            let ContactRule::Modified { modifier } = rule else { continue };
            let Some(modifier) = self.registered.find(modifier) else { continue };
            let before = material.unwrap_or_else(|| own(contact));
            let found = FoundContact {
                sides: sides.map(|(body, shape)| side(bodies, body, shape)),
                normal: contact.manifold.normal,
                points: contact.manifold.points(),
                step,
            };
            match modifier(&found, before) {
                Some(after) => material = Some(if after.is_valid() { after } else { before }),
                None => {
                    contact.effect = Effect::Pass;
                    contact.memory = ContactMemory::default();
                    return None;
                }
            }
        }
        material
    }

    /// Sets the material of the contact at `place` for this step. Calls must be in ascending order of `place`.
    pub fn set(&mut self, place: u32, material: ContactMaterial) {
        self.changed.push((place, material));
    }

    /// True if the contact at `place` was modified in this step.
    pub fn have_changed(&self, place: u32) -> bool {
        self.find(place).is_some()
    }

    fn find(&self, place: u32) -> Option<&ContactMaterial> {
        let found = self.changed.binary_search_by_key(&place, |&(contact, _)| contact).ok()?;
        Some(&self.changed[found].1)
    }

    /// Material of the contact at `place` in this step.
    pub fn material(&self, bodies: &Arena<Body>, contacts: &[Contact], place: u32) -> ContactMaterial {
        self.find(place).copied().unwrap_or_else(|| contacts[place as usize].material(bodies))
    }
}

fn side(bodies: &Arena<Body>, index: u32, shape: u32) -> ContactSide {
    let body = bodies.at(index);
    ContactSide {
        shape: ShapeId { body: bodies.id(index), shape },
        user_data: body.user_data,
        material: body.surface(shape as usize).material,
        velocity: body.velocity,
        center: body.center(),
    }
}
