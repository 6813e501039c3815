//! Which shapes touched in the last step: what begin and end are told against.

use crate::arena::Arena;
use crate::body::Body;
use crate::contact::Contact;
use crate::hits::OpenHits;
use crate::id::{BodyId, ShapeId};
use crate::modifiers::Modifiers;
use crate::snapshot::body_index;
use crate::touch::id;
use sinew_math::{ReadError, Reader, Writer};

/// What the world remembers of pairs beside their contacts, which come and go with the broad phase. Part of the snapshot.
#[derive(Clone, Debug, Default)]
pub(crate) struct Meetings {
    /// Solid shapes.
    pub touching: Touches,
    /// A sensor and what is in it.
    pub sensed: Touches,
    pub hits: OpenHits,
    /// Bodies that were changed since the last step: what they touch is looked for anew even if nothing moves.
    pub stirred: Vec<u32>,
    /// No part of the snapshot.
    pub modifiers: Modifiers,
}

impl Meetings {
    pub fn save(&self, w: &mut Writer) {
        self.touching.save(w);
        self.sensed.save(w);
        self.hits.save(w);
        w.count(self.stirred.len());
        for &index in &self.stirred {
            w.u32(index);
        }
    }

    /// Marks the bodies that were changed.
    pub fn load(r: &mut Reader<'_>, bodies: &mut Arena<Body>) -> Result<Self, ReadError> {
        let (touching, sensed, hits) = (Touches::load(r)?, Touches::load(r)?, OpenHits::load(r)?);
        let mut stirred = Vec::new();
        for _ in 0..r.count(4)? {
            let index = body_index(r, bodies)?;
            bodies.at_mut(index).stirred = true;
            stirred.push(index);
        }
        Ok(Self { touching, sensed, hits, stirred, modifiers: Modifiers::default() })
    }

    /// The step has looked at what was changed.
    pub fn settle(&mut self, bodies: &mut Arena<Body>) {
        for index in self.stirred.drain(..) {
            bodies.at_mut(index).stirred = false;
        }
    }
}

/// Two shapes that touch; the one with the smaller body index is A.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Touch {
    pub a: ShapeId,
    pub b: ShapeId,
}

impl Touch {
    /// What all lists are ordered by.
    fn shapes(&self) -> (BodyId, BodyId, u32, u32) {
        (self.a.body, self.b.body, self.a.shape, self.b.shape)
    }

    fn bodies(&self) -> (BodyId, BodyId) {
        (self.a.body, self.b.body)
    }
}

/// Ids of the two shapes of a contact.
pub(crate) fn shape_ids(bodies: &Arena<Body>, contact: &Contact) -> (ShapeId, ShapeId) {
    let key = contact.key;
    (
        ShapeId { body: id(bodies, key.a), shape: key.shape_a },
        ShapeId { body: id(bodies, key.b), shape: key.shape_b },
    )
}

/// The shapes of a contact.
pub(crate) fn touch_of(bodies: &Arena<Body>, contact: &Contact) -> Touch {
    let (a, b) = shape_ids(bodies, contact);
    Touch { a, b }
}

/// Whether nothing about the contacts of two shapes can have changed: they were not looked at.
pub(crate) fn lie_still(bodies: &Arena<Body>, pair: &[Contact]) -> bool {
    !bodies.at(pair[0].key.a).can_touch() && !bodies.at(pair[0].key.b).can_touch()
}

/// Pairs that touch, in order; those to which nothing can happen may be missing.
#[derive(Clone, Debug, Default)]
pub(crate) struct Touches {
    list: Vec<Touch>,
    /// Of this step.
    next: Vec<Touch>,
    /// How far the notes of this step have come in the list.
    seen: usize,
    /// Not in the list, but known to touch.
    returned: Vec<Touch>,
}

/// Lists of what began, or of what ended.
pub(crate) struct Told<'a> {
    pub bodies: &'a mut Vec<(BodyId, BodyId)>,
    pub shapes: &'a mut Vec<(ShapeId, ShapeId)>,
}

impl Touches {
    /// Makes room for the pairs of so many contacts.
    pub fn start(&mut self, contacts: usize) {
        self.next.clear();
        self.next.reserve(contacts);
        self.returned.clear();
        self.returned.reserve(contacts);
        self.seen = 0;
    }

    /// Notes a pair of shapes, pairs in order: whether it was told of in some step before, and whether it touches now.
    pub fn note(&mut self, touch: Touch, was: bool, is: bool) {
        let behind =
            self.list[self.seen..].iter().take_while(|other| other.shapes() < touch.shapes()).count();
        self.seen += behind;
        let listed = self.list.get(self.seen).is_some_and(|other| other.shapes() == touch.shapes());
        if was && !listed {
            self.returned.push(touch);
        }
        if is {
            self.next.push(touch);
        }
    }

    /// Tells what is not as it was in the last step. What is gone, but lies still, goes on touching.
    pub fn tell<'a>(&mut self, bodies: &Arena<Body>, mut begin: Told<'a>, mut end: Told<'a>) {
        let most = usize::max(self.list.len() + self.returned.len(), self.next.capacity());
        for told in [&mut begin, &mut end] {
            told.bodies.clear();
            told.shapes.clear();
            // All of them: how many come at once differs from hit to hit.
            told.bodies.reserve(most);
            told.shapes.reserve(most);
        }
        if !self.returned.is_empty() {
            self.list.extend_from_slice(&self.returned);
            self.list.sort_unstable_by_key(Touch::shapes);
        }
        let (was, is) = (&self.list, &self.next);
        let ended = |a, b| !(lies_still(bodies, a) && lies_still(bodies, b));
        compare(
            was,
            is,
            Touch::bodies,
            |pair| begin.bodies.push(pair),
            |(a, b)| {
                end.bodies.extend(ended(a, b).then_some((a, b)));
            },
        );
        let ids = |(a, b, i, j)| (ShapeId { body: a, shape: i }, ShapeId { body: b, shape: j });
        compare(
            was,
            is,
            Touch::shapes,
            |pair| begin.shapes.push(ids(pair)),
            |pair| {
                end.shapes.extend(ended(pair.0, pair.1).then_some(ids(pair)));
            },
        );
        core::mem::swap(&mut self.list, &mut self.next);
    }

    fn save(&self, w: &mut Writer) {
        w.count(self.list.len());
        for touch in &self.list {
            save_shape_id(w, touch.a);
            save_shape_id(w, touch.b);
        }
    }

    fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut list = Vec::new();
        for _ in 0..r.count(24)? {
            list.push(Touch { a: load_shape_id(r)?, b: load_shape_id(r)? });
        }
        if !list.is_sorted_by(|p: &Touch, q| p.shapes() < q.shapes()) {
            return Err(r.error("touching pairs are out of order"));
        }
        Ok(Self { list, ..Self::default() })
    }
}

/// Whether nothing about what a body touches can have changed.
fn lies_still(bodies: &Arena<Body>, id: BodyId) -> bool {
    bodies.get(id.index, id.generation).is_some_and(|body| !body.can_touch() && !body.quarantined)
}

/// Walks two ordered lists side by side: what only the new one has began, what only the old one has ended.
fn compare<K: Ord + Copy>(
    mut was: &[Touch],
    mut is: &[Touch],
    key: impl Fn(&Touch) -> K,
    mut begin: impl FnMut(K),
    mut end: impl FnMut(K),
) {
    while let Some(next) = [was.first(), is.first()].into_iter().flatten().map(&key).min() {
        let count = |list: &[Touch]| list.iter().take_while(|touch| key(touch) == next).count();
        let (old, new) = (count(was), count(is));
        match (old > 0, new > 0) {
            (false, true) => begin(next),
            (true, false) => end(next),
            _ => {}
        }
        (was, is) = (&was[old..], &is[new..]);
    }
}

pub(crate) fn save_shape_id(w: &mut Writer, id: ShapeId) {
    w.u64(id.body.to_bits());
    w.u32(id.shape);
}

pub(crate) fn load_shape_id(r: &mut Reader<'_>) -> Result<ShapeId, ReadError> {
    Ok(ShapeId { body: BodyId::from_bits(r.u64()?), shape: r.u32()? })
}
