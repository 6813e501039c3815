//! Bookkeeping of awake and sleeping bodies and their islands, so that a step visits awake ones only.
//!
//! All of the bookkeeping derives from the bodies and contacts and is not part of the state: a world with rebuilt
//! bookkeeping has the same future.

#[cfg(test)]
mod check;
mod groups;
mod sleeping_contacts;
mod slot_set;

use crate::arena::Arena;
use crate::body::def::{BodyKind, WorldDef};
use crate::body::shape::Shape;
use crate::body::{Body, Gain, Rest, Velocity};
use crate::boxes::Aabb;
use crate::contact::Contact;
use crate::contact::near::bear;
use crate::contact::proxies::{Owner, Proxies};
use crate::joint::{Incidence, Joint};
use crate::particles::ParticleGroup;
use core::ops::ControlFlow;
pub(crate) use groups::{follow, sleeping_partner, store_sleep_supports};
use sinew_math::Transform;
use sleeping_contacts::SleepingContacts;
use slot_set::SlotSet;

/// Active bodies, the bodies of each sleeping island, the contacts of sleeping bodies, and the joints of each body.
#[derive(Clone, Debug, Default)]
pub(crate) struct Activity {
    pub joints_of: Incidence,
    active: SlotSet,
    /// Indices of the kinematic bodies, ascending.
    kinematic: Vec<u32>,
    /// The next body of the same sleeping island, as a ring, by slot.
    next: Vec<u32>,
    aside: SleepingContacts,
    /// Contacts of bodies that woke or started moving, until the step visits them.
    returned: Vec<Contact>,
    struck: Vec<u32>,
}

impl Activity {
    /// Bookkeeping of a world that has all contacts in its own list.
    pub fn new(bodies: &Arena<Body>, joints: &Arena<Joint>) -> Self {
        let mut activity = Self { joints_of: Incidence::new(joints), ..Self::default() };
        let mut sleepers = Vec::new();
        for (index, body) in bodies.iter() {
            activity.add(index, body);
            if let Rest::Asleep { island } = body.rest {
                sleepers.push((island, index));
            }
        }
        sleepers.sort_unstable();
        for members in sleepers.chunk_by(|p, q| p.0 == q.0) {
            activity.tie(members.iter().map(|&(_, index)| index));
        }
        activity
    }

    /// Active bodies, ascending.
    pub fn active(&self) -> impl Iterator<Item = u32> {
        self.active.iter()
    }

    /// Kinematic bodies, ascending.
    pub fn kinematic(&self) -> &[u32] {
        &self.kinematic
    }

    /// Limits each velocity component of kinematic bodies to `most`, m/s or rad/s.
    pub fn bound_kinematic(&self, bodies: &mut Arena<Body>, most: f32) {
        for &index in &self.kinematic {
            bodies.at_mut(index).velocity.bound(most);
        }
    }

    /// The other bodies of a sleeping body's island.
    #[cfg(test)]
    fn asleep_with(&self, index: u32) -> impl Iterator<Item = u32> {
        let next = move |&at: &u32| Some(self.next[at as usize]).filter(|&next| next != index);
        core::iter::successors(Some(index), next).skip(1)
    }

    /// Active and kinematic bodies, each once.
    pub fn movers(&self) -> impl Iterator<Item = u32> {
        self.active().chain(self.kinematic.iter().copied())
    }

    /// Records a new body.
    pub fn add(&mut self, index: u32, body: &Body) {
        let slots = index as usize + 1;
        self.active.reserve(slots);
        self.aside.reserve(slots);
        if self.next.len() < slots {
            self.next.resize(slots, 0);
        }
        self.next[index as usize] = index;
        if let (BodyKind::Kinematic, Err(place)) = (body.kind, self.kinematic.binary_search(&index)) {
            self.kinematic.insert(place, index);
        }
        self.note(index, body);
    }

    /// Records that an awake body changed its kind.
    pub fn change_kind(&mut self, index: u32, body: &Body) {
        self.kinematic.retain(|&other| other != index);
        self.add(index, body);
    }

    /// Records whether a body is active.
    pub fn note(&mut self, index: u32, body: &Body) {
        self.active.set(index, body.is_active());
    }

    /// Removes a body; passes its contacts outside the world's list to `part_with`, in unspecified order.
    pub fn remove(&mut self, index: u32, mut part_with: impl FnMut(Contact)) {
        self.active.set(index, false);
        self.kinematic.retain(|&other| other != index);
        self.aside.take(index, &mut part_with);
        self.drop_returned(|contact| contact.key.has(index), part_with);
    }

    /// Removes contacts for which `goes` is true from those that returned since the last step; passes them to
    /// `part_with`.
    pub fn drop_returned(&mut self, mut goes: impl FnMut(&Contact) -> bool, part_with: impl FnMut(Contact)) {
        self.returned.extract_if(.., |contact| goes(contact)).for_each(part_with);
    }

    /// Wakes a sleeping body and all bodies of its sleeping island.
    pub fn wake(&mut self, bodies: &mut Arena<Body>, index: u32) {
        if bodies.at(index).is_awake() {
            return;
        }
        let mut member = index;
        loop {
            let body = bodies.at_mut(member);
            body.disturb();
            self.note(member, body);
            self.recall(member);
            member = core::mem::replace(&mut self.next[member as usize], member);
            if member == index {
                return;
            }
        }
    }

    /// Wakes a body, or restarts its time at rest.
    pub fn disturb(&mut self, bodies: &mut Arena<Body>, index: u32) {
        self.wake(bodies, index);
        bodies.at_mut(index).disturb();
    }

    /// Wakes bodies that particles hit; particles that rest on a sleeping body are too slow to wake it.
    pub fn wake_struck(
        &mut self,
        bodies: &mut Arena<Body>,
        groups: &Arena<ParticleGroup>,
        proxies: &Proxies,
        def: &WorldDef,
    ) {
        let (speed, dt) = (def.sleep_thresholds.speed, def.dt());
        for (_, group) in groups.iter().filter(|(_, group)| group.is_awake()) {
            let fastest = group.fastest();
            if fastest > speed {
                let bounds = group.strike_bounds(fastest, dt);
                let strikes = |shape: &Shape, at: &Transform| group.strikes(shape, at, speed, dt);
                self.wake_met(bodies, group, (proxies, &bounds), strikes);
            }
        }
    }

    /// Wakes sleeping bodies with a shape within `bounds` that the group collides with and for which `meets` is true.
    fn wake_met(
        &mut self,
        bodies: &mut Arena<Body>,
        group: &ParticleGroup,
        (proxies, bounds): (&Proxies, &Aabb),
        meets: impl Fn(&Shape, &Transform) -> bool,
    ) {
        let mut met = core::mem::take(&mut self.struck);
        let _ = proxies.overlapping(bounds, |Owner { body: index, shape }| {
            let (body, shape) = (bodies.at(index), shape as usize);
            let is_met = !body.is_awake()
                && group.meets(bodies.id(index), body.surface(shape))
                && meets(&body.shapes[shape].shape, &body.world_from_shape(shape));
            met.extend(is_met.then_some(index));
            ControlFlow::<()>::Continue(())
        });
        met.drain(..).for_each(|index| self.wake(bodies, index));
        self.struck = met;
    }

    /// Puts bodies to sleep as one island, under a new number.
    pub fn sleep(&mut self, bodies: &mut Arena<Body>, members: &[u32], island: u32) {
        for &index in members {
            let body = bodies.at_mut(index);
            body.rest = Rest::Asleep { island };
            body.gain = Gain::default();
            body.velocity = Velocity::default();
            body.previous = body.world_from_principal;
            self.note(index, body);
        }
        self.tie(members.iter().copied());
    }

    fn tie(&mut self, members: impl Iterator<Item = u32> + Clone) {
        let following = members.clone().skip(1).chain(members.clone().take(1));
        for (index, next) in members.zip(following) {
            self.next[index as usize] = next;
        }
    }

    /// Stores a contact that cannot change until one of its bodies wakes or starts moving.
    pub fn put_aside(&mut self, contact: Contact) {
        self.aside.put(contact);
    }

    /// Returns the contacts of a body that can collide again: they take part in the next step.
    pub fn recall(&mut self, index: u32) {
        self.aside.take(index, |contact| self.returned.push(contact));
    }

    /// Contacts that returned since the last step.
    pub fn returned_mut(&mut self) -> impl Iterator<Item = &mut Contact> {
        self.returned.iter_mut()
    }

    /// Merges the returned contacts with those of the step, which are sorted by key.
    pub fn return_contacts(&mut self, contacts: &mut Vec<Contact>) {
        self.returned.sort_unstable_by_key(|contact| contact.key);
        bear(contacts, &mut self.returned);
    }

    /// Contacts of a body that are not in the world's list, in unspecified order.
    pub fn contacts_of(&self, body: u32) -> impl Iterator<Item = &Contact> {
        let returned = self.returned.iter().filter(move |contact| contact.key.has(body));
        self.aside.of(body).chain(returned)
    }

    /// All contacts outside the world's list.
    pub fn contacts(&self) -> impl Iterator<Item = &Contact> {
        self.aside.iter().chain(&self.returned)
    }
}
