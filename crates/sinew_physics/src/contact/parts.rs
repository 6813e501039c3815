//! Contacts of pairs with a mesh or a height field, which may have several contact regions. Each manifold is a separate
//! contact, a part of the pair. Belongs to the stage `collide`.

use crate::collide::{Ground, MAX_PARTS, Manifold, Motion, Patch, Scratch, collide_pair};
use crate::contact::proxies::Owner;
use crate::contact::seams::Seams;
use crate::contact::tuning::SAME_PART_COSINE;
use crate::contact::{Contact, ContactMemory, slop};
use crate::context::StepContext;
use crate::slices::for_each_mut;
use sinew_math::Vec3;
use std::sync::{Mutex, PoisonError};

/// New manifolds of the pairs with parts; kept to reuse their memory.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    pairs: Vec<Pair>,
    next: Vec<Contact>,
    /// Free search memory: one entry per thread so far.
    idle: Mutex<Vec<(Scratch, Vec<Owner>)>>,
}

/// A clone starts empty: the memory holds no data between steps.
impl Clone for Parts {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// A pair with parts: the range of its contacts, and its new manifolds.
#[derive(Clone, Copy, Debug)]
struct Pair {
    first: usize,
    motion: Motion,
    patch: Patch,
}

impl Parts {
    /// Recomputes the contacts of pairs with parts. `motion` returns the bodies' motion if its argument is the first
    /// contact of such a pair.
    pub fn update(
        &mut self,
        seams: &Seams<'_>,
        contacts: &mut Vec<Contact>,
        context: &StepContext<'_>,
        motion: impl Fn(&Contact) -> Option<Motion>,
    ) {
        self.pairs.clear();
        let pairs = contacts.iter().enumerate().filter(|(_, contact)| contact.key.part == 0);
        self.pairs.extend(pairs.filter_map(|(first, contact)| {
            Some(Pair { first, motion: motion(contact)?, patch: Patch::default() })
        }));
        if self.pairs.is_empty() {
            return;
        }
        let idle = &self.idle;
        for_each_mut(context.runner, &mut self.pairs, |pair| {
            let lock = || idle.lock().unwrap_or_else(PoisonError::into_inner);
            let free = lock().pop();
            let mut lists = free.unwrap_or_default();
            find(seams, &contacts[pair.first], pair, &mut lists);
            lock().push(lists);
        });
        self.replace(contacts);
    }

    fn replace(&mut self, contacts: &mut Vec<Contact>) {
        self.next.clear();
        let mut done = 0;
        for pair in &self.pairs {
            self.next.extend_from_slice(&contacts[done..pair.first]);
            let key = contacts[pair.first].key;
            let old = contacts[pair.first..].iter().take_while(|contact| contact.key.is_of_pair(key)).count();
            done = pair.first + old;
            push_parts(&contacts[pair.first..done], pair.patch.manifolds(), &mut self.next);
        }
        self.next.extend_from_slice(&contacts[done..]);
        core::mem::swap(contacts, &mut self.next);
    }
}

fn find(
    seams: &Seams<'_>,
    contact: &Contact,
    pair: &mut Pair,
    (scratch, beside): &mut (Scratch, Vec<Owner>),
) {
    let key = contact.key;
    let [a, b] = [(key.a, key.shape_a), (key.b, key.shape_b)].map(|(body, shape)| Owner { body, shape });
    let placed = |owner: Owner| {
        let body = seams.bodies.at(owner.body);
        (&body.shapes[owner.shape as usize].shape, body.world_from_shape(owner.shape as usize))
    };
    let ((shape_a, from_a), (shape_b, from_b)) = (placed(a), placed(b));
    let (ground, mover, bounds, thinnest) = match shape_a.surface() {
        Some(_) => (a, b, shape_b.aabb(&from_b), shape_b.smallest_extent()),
        None => (b, a, shape_a.aabb(&from_a), shape_a.smallest_extent()),
    };
    seams.beside(ground, mover, &bounds.expand(pair.motion.margin), beside);
    let slop = slop(thinnest);
    let shown = |point: Vec3, normal: Vec3| seams.shown(ground, beside, (point, normal), slop);
    let around: Option<&Ground<'_>> = if beside.is_empty() { None } else { Some(&shown) };
    let (a, b) = ((shape_a, &from_a), (shape_b, &from_b));
    collide_pair(a, b, &pair.motion, around, scratch, &mut pair.patch);
}

/// Appends the contacts of a pair: persisting contacts in their previous order, then new ones. There is at least one,
/// possibly without points, which stores whether the pair touches.
fn push_parts(old: &[Contact], new: &[Manifold], out: &mut Vec<Contact>) {
    let mut taken = [false; MAX_PARTS];
    let pushed = old.iter().any(|contact| contact.pushed);
    let mut part = 0;
    let mut push = |manifold: Manifold, memory: ContactMemory| {
        let mut contact = Contact { manifold, memory, pushed, ..old[0] };
        contact.key.part = part;
        part += 1;
        out.push(contact);
    };
    for contact in old.iter().filter(|contact| contact.manifold.count > 0) {
        let mut best: Option<(f32, usize)> = None;
        for (k, manifold) in new.iter().enumerate().filter(|(k, _)| !taken[*k]) {
            let cosine = manifold.normal.dot(contact.manifold.normal);
            if cosine >= SAME_PART_COSINE && best.is_none_or(|(most, _)| cosine > most) {
                best = Some((cosine, k));
            }
        }
        if let Some((_, k)) = best {
            taken[k] = true;
            push(new[k], contact.memory.matched(&contact.manifold, &new[k]));
        }
    }
    for (manifold, _) in new.iter().zip(taken).filter(|(_, taken)| !taken) {
        push(*manifold, ContactMemory::default());
    }
    if new.is_empty() {
        push(Manifold::default(), ContactMemory::default());
    }
}
