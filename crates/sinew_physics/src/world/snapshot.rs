//! Snapshots: all state that affects the future, and no other, in one order.

use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::Body;
use crate::body::external_work::Work;
use crate::body::library::LoadError;
use crate::body::owner::{Owners, OwnersInOrder};
use crate::body::snapshot::{body_index, load_body, load_def, load_option, save_body, save_def, save_option};
use crate::contact::Contact;
use crate::contact::events::Events;
use crate::contact::snapshot::{load_contact, save_contact};
use crate::contact::tracking::ContactTracking;
use crate::field::FieldDef;
use crate::joint::Joint;
use crate::mover::Mover;
use crate::particles::ParticleGroup;
use crate::world::World;
use sinew_math::{ReadError, Reader, Writer};

/// Magic bytes at the start of a snapshot; the last byte is the version.
const MAGIC: &[u8; 8] = b"sinew-w\x0a";
/// Largest number of steps in a snapshot: a thousand steps a second for 280,000 years.
const MOST_STEPS: u64 = 1 << 53;

impl World {
    /// Writes the state of the world; [`load`](Self::load) restores it bit for bit.
    #[doc(alias = "serialize")]
    #[doc(alias = "snapshot")]
    #[doc(alias = "rollback")]
    pub fn save(&self, w: &mut Writer) {
        w.raw(MAGIC);
        save_def(w, &self.def);
        w.u64(self.steps);
        w.u64(self.pending_nanoseconds);
        w.u32(self.sleepers);
        let mut owners = OwnersInOrder::default();
        self.bodies.save(w, |w, body| {
            save_body(w, body);
            body.owner.into_iter().for_each(|mark| owners.save(&self.owners, mark, w));
        });
        self.joints.save(w, |w, joint| {
            joint.save(w);
            joint.owner.into_iter().for_each(|mark| owners.save(&self.owners, mark, w));
        });
        // Idle contacts are omitted: which pairs without points exist depends on the world's history.
        let contacts: Vec<_> = self.contacts_in_order().filter(|contact| !contact.is_idle()).collect();
        w.count(contacts.len());
        contacts.into_iter().for_each(|contact| save_contact(w, contact));
        self.groups.save(w, save_group);
        self.fields.save(w, |w, field| field.save(w));
        w.count(self.parted.disabled.len());
        for &(a, b) in &self.parted.disabled {
            w.u32(a);
            w.u32(b);
        }
        self.meetings.save(w);
        save_option(w, self.parted.functions.chosen, Writer::u32);
        self.movers.all.save(w, |w, mover| mover.save(w));
        self.objects.save(w);
    }

    /// Restores a saved state. The events are then empty.
    ///
    /// User objects restore their state in place: into the object that was saved, if it still exists, or else into a
    /// new one of a [registered](Self::register_kind) kind. Objects added since are dropped.
    ///
    /// # Errors
    /// If the bytes are not a snapshot of this version, a shape with data is missing in the library, a function is not
    /// registered, or an object is missing and its kind is not registered; the world is then unchanged.
    ///
    /// # Panics
    /// If an object rejects its own saved state.
    pub fn load(&mut self, r: &mut Reader<'_>) -> Result<(), LoadError> {
        if r.raw(MAGIC.len())? != MAGIC {
            return Err(ReadError { at: 0, what: "is not a world snapshot of this version" }.into());
        }
        let def = load_def(r)?;
        let (steps, pending, sleepers) = (r.u64()?, r.u64()?, r.u32()?);
        if steps > MOST_STEPS {
            return Err(r.error("more steps than any world takes").into());
        }
        let (mut owners, mut in_order) = (Owners::default(), OwnersInOrder::default());
        let mut bodies = Arena::load(r, |r| {
            let mut body = load_body(r, &self.library)?;
            if let Some(mark) = &mut body.owner {
                *mark = in_order.load(&mut owners, r)?;
            }
            Ok::<_, LoadError>(body)
        })?;
        self.check_rules(r, &bodies)?;
        let joints = Arena::load(r, |r| {
            let (a, b) = (body_index(r, &bodies)?, body_index(r, &bodies)?);
            let mut joint = Joint::load(r, a, b)?;
            if let Some(mark) = &mut joint.owner {
                *mark = in_order.load(&mut owners, r)?;
            }
            Ok::<_, ReadError>(joint)
        })?;
        let count = r.count(8)?;
        let mut contacts = Vec::with_capacity(count);
        for _ in 0..count {
            contacts.push(load_contact(r, &bodies)?);
        }
        if !contacts.is_sorted_by(|p: &Contact, q| p.key < q.key) {
            return Err(r.error("contacts are out of order").into());
        }
        let mut groups = Arena::load(r, |r| load_group(r, &bodies))?;
        crate::activity::store_sleep_supports(&bodies, &mut groups);
        let fields = Arena::load(r, |r| FieldDef::load(r, &self.functions, &self.library))?;
        let count = r.count(8)?;
        let mut disabled = Vec::with_capacity(count);
        for _ in 0..count {
            disabled.push((body_index(r, &bodies)?, body_index(r, &bodies)?));
        }
        if !disabled.is_sorted() {
            return Err(r.error("disabled pairs are out of order").into());
        }
        let meetings = ContactTracking::load(r, &mut bodies)?;
        let pair_function = load_option(r, Reader::u32)?;
        if !pair_function.is_none_or(|number| self.parted.functions.registered.has(number)) {
            return Err(r.error("names a pair function that is not registered").into());
        }
        let movers = Arena::load(r, |r| Mover::load(r, &bodies))?;
        self.objects.load(r)?;
        self.def = def;
        (self.steps, self.pending_nanoseconds, self.sleepers) = (steps, pending, sleepers);
        self.activity = Activity::new(&bodies, &joints);
        (self.bodies, self.joints, self.contacts) = (bodies, joints, contacts);
        self.owners = owners;
        self.parted.restore(disabled, pair_function);
        let modifiers = core::mem::take(&mut self.meetings.modifiers);
        self.meetings = ContactTracking { modifiers, ..meetings };
        (self.groups, self.fields, self.movers.all) = (groups, fields, movers);
        self.events = Events::default();
        self.islands.forget();
        self.work = Work::default();
        self.broad.proxies.adopt(&self.bodies);
        Ok(())
    }

    fn check_rules(&self, r: &Reader<'_>, bodies: &Arena<Body>) -> Result<(), ReadError> {
        let mut surfaces = bodies.iter().flat_map(|(_, body)| body.surfaces.as_slice());
        if surfaces.all(|surface| self.knows_rule(surface.rule)) {
            return Ok(());
        }
        Err(r.error("names a modifier that is not registered"))
    }

    /// Hash of the snapshot's bytes.
    pub fn hash(&self) -> u64 {
        let mut w = Writer::new();
        self.save(&mut w);
        sinew_math::hash::hash_bytes(w.as_bytes())
    }

    /// Stores the current state, as [`save`](Self::save) writes it, for [`reset`](Self::reset).
    pub fn mark(&mut self) {
        let mut w = Writer::reuse(core::mem::take(&mut self.marked));
        self.save(&mut w);
        self.marked = w.into_bytes();
    }

    /// Returns to the marked state exactly: the following steps have the same bits as those after the mark, including
    /// new ids. Items added since are removed, removed items return, and [`events`](Self::events) are empty. Settings
    /// outside the state (threads, registered kinds) do not change.
    ///
    /// # Panics
    /// If no state was marked, or an object of an [unregistered](Self::register_kind) kind was removed since.
    pub fn reset(&mut self) {
        assert!(!self.marked.is_empty(), "a state was marked");
        let marked = core::mem::take(&mut self.marked);
        self.load(&mut Reader::new(&marked)).expect("a marked state is valid");
        self.marked = marked;
    }
}

fn save_group(w: &mut Writer, group: &ParticleGroup) {
    group.save(w);
    w.count(group.pinched.contacts.len());
    group.pinched.contacts.iter().for_each(|contact| save_contact(w, contact));
}

fn load_group(r: &mut Reader<'_>, bodies: &Arena<Body>) -> Result<ParticleGroup, ReadError> {
    let mut group = ParticleGroup::load(r)?;
    for _ in 0..r.count(8)? {
        group.pinched.contacts.push(load_contact(r, bodies)?);
    }
    if group.carriers().all(|body| bodies.get(body).is_some()) {
        Ok(group)
    } else {
        Err(r.error("attached to no body, or stopped by none"))
    }
}
