//! Contacts that cannot change for now, so that a step need not visit them.

use crate::contact::{Contact, ContactKey};

/// Contacts between two bodies that both sleep or never move. Each contact is in the lists of both bodies, so that a
/// change of either body finds and removes it.
#[derive(Clone, Debug, Default)]
pub(crate) struct SleepingContacts {
    links: Vec<Link>,
    free: Vec<u32>,
    /// The first contact of each body, by slot.
    first: Vec<u32>,
}

#[derive(Clone, Debug)]
struct Link {
    /// `None` if the link is free.
    contact: Option<Contact>,
    /// Previous links in the lists of bodies A and B.
    before: [u32; 2],
    after: [u32; 2],
}

const NONE: u32 = u32::MAX;

/// Side of a body in the contact: 0 for A, 1 for B.
fn side(key: ContactKey, body: u32) -> usize {
    usize::from(key.b == body)
}

impl SleepingContacts {
    /// Reserves the lists of the bodies below `count`.
    pub fn reserve(&mut self, count: usize) {
        if self.first.len() < count {
            self.first.resize(count, NONE);
        }
    }

    /// Adds a contact. The lists of its bodies must be reserved.
    pub fn put(&mut self, contact: Contact) {
        let bodies = [contact.key.a, contact.key.b];
        let after = bodies.map(|body| self.first[body as usize]);
        let link = Link { contact: Some(contact), before: [NONE; 2], after };
        let at = match self.free.pop() {
            Some(at) => {
                self.links[at as usize] = link;
                at
            }
            None => {
                self.links.push(link);
                self.links.len() as u32 - 1
            }
        };
        for (body, next) in bodies.into_iter().zip(after) {
            if next != NONE {
                let side = self.side_at(next, body);
                self.links[next as usize].before[side] = at;
            }
            self.first[body as usize] = at;
        }
    }

    /// Removes all contacts of a body and passes them to `each`.
    pub fn take(&mut self, body: u32, mut each: impl FnMut(Contact)) {
        while self.first[body as usize] != NONE {
            each(self.unlink(self.first[body as usize]));
        }
    }

    /// Contacts of a body, in unspecified order.
    pub fn of(&self, body: u32) -> impl Iterator<Item = &Contact> {
        let at = |at: u32| (at != NONE).then(|| &self.links[at as usize]);
        let next = move |link: &&Link| at(link.after[side(link.key(), body)]);
        core::iter::successors(at(self.first[body as usize]), next).filter_map(|link| link.contact.as_ref())
    }

    /// All contacts, in unspecified order.
    pub fn iter(&self) -> impl Iterator<Item = &Contact> {
        self.links.iter().filter_map(|link| link.contact.as_ref())
    }

    fn side_at(&self, at: u32, body: u32) -> usize {
        side(self.links[at as usize].key(), body)
    }

    fn unlink(&mut self, at: u32) -> Contact {
        let link = &mut self.links[at as usize];
        let (before, after) = (link.before, link.after);
        let contact = link.contact.take().expect("a listed link holds a contact");
        for (own, body) in [contact.key.a, contact.key.b].into_iter().enumerate() {
            match before[own] {
                NONE => self.first[body as usize] = after[own],
                before => {
                    let side = self.side_at(before, body);
                    self.links[before as usize].after[side] = after[own];
                }
            }
            if after[own] != NONE {
                let side = self.side_at(after[own], body);
                self.links[after[own] as usize].before[side] = before[own];
            }
        }
        self.free.push(at);
        contact
    }
}

impl Link {
    fn key(&self) -> ContactKey {
        self.contact.as_ref().expect("a listed link holds a contact").key
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_math::Random;
    use std::collections::BTreeSet;

    const BODIES: u32 = 12;

    fn key(random: &mut Random) -> ContactKey {
        let a = random.index(BODIES as usize - 1) as u32;
        let b = a + 1 + random.index((BODIES - 1 - a) as usize) as u32;
        ContactKey { a, b, shape_a: random.index(3) as u32, shape_b: random.index(3) as u32, part: 0 }
    }

    #[test]
    fn body_lists_contain_only_contacts_of_the_body() {
        let mut random = Random::new(3);
        let (mut aside, mut expected) = (SleepingContacts::default(), BTreeSet::new());
        aside.reserve(BODIES as usize);
        for _ in 0..2000 {
            if random.index(4) > 0 {
                let key = key(&mut random);
                if expected.insert(key) {
                    aside.put(Contact::new(key));
                }
            } else {
                let body = random.index(BODIES as usize) as u32;
                let mut taken = BTreeSet::new();
                aside.take(body, |contact| assert!(taken.insert(contact.key)));
                let (own, rest) = expected.into_iter().partition(|key| key.a == body || key.b == body);
                assert_eq!(taken, own);
                expected = rest;
            }
            for body in 0..BODIES {
                let own: BTreeSet<_> = aside.of(body).map(|contact| contact.key).collect();
                assert!(own.iter().eq(expected.iter().filter(|key| key.a == body || key.b == body)));
            }
            assert_eq!(aside.iter().map(|contact| contact.key).collect::<BTreeSet<_>>(), expected);
        }
    }
}
