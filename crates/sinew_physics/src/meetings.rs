//! Which shapes touched in the last step: what begin and end are told against.

use crate::arena::Arena;
use crate::body::Body;
use crate::contact::{Contact, Effect};
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
    /// They pass through each other.
    pub passes: bool,
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

/// Pairs that touch, in order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Touches {
    list: Vec<Touch>,
    /// Of this step.
    next: Vec<Touch>,
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
    }

    /// Notes the contacts of one pair of shapes, pairs in order.
    pub fn note(&mut self, bodies: &Arena<Body>, pair: &[Contact]) {
        if pair.iter().any(Contact::touches) {
            let (a, b) = shape_ids(bodies, &pair[0]);
            self.next.push(Touch { a, b, passes: pair.iter().all(|contact| contact.effect == Effect::Pass) });
        }
    }

    /// Whether a pair that touched in the last step passed through each other; `None` if it did not touch.
    pub fn passed(&self, a: ShapeId, b: ShapeId) -> Option<bool> {
        let asked = Touch { a, b, passes: false };
        let place = self.list.binary_search_by_key(&asked.shapes(), Touch::shapes).ok()?;
        Some(self.list[place].passes)
    }

    /// Tells what is not as it was in the last step.
    pub fn tell<'a>(&mut self, mut begin: Told<'a>, mut end: Told<'a>) {
        for told in [&mut begin, &mut end] {
            told.bodies.clear();
            told.shapes.clear();
            // All of them: how many come at once differs from hit to hit.
            let most = usize::max(self.list.len(), self.next.capacity());
            told.bodies.reserve(most);
            told.shapes.reserve(most);
        }
        let (was, is) = (&self.list, &self.next);
        compare(was, is, Touch::bodies, |pair| begin.bodies.push(pair), |pair| end.bodies.push(pair));
        let ids = |(a, b, i, j)| (ShapeId { body: a, shape: i }, ShapeId { body: b, shape: j });
        compare(
            was,
            is,
            Touch::shapes,
            |pair| begin.shapes.push(ids(pair)),
            |pair| end.shapes.push(ids(pair)),
        );
        core::mem::swap(&mut self.list, &mut self.next);
    }

    fn save(&self, w: &mut Writer) {
        w.count(self.list.len());
        for touch in &self.list {
            save_shape_id(w, touch.a);
            save_shape_id(w, touch.b);
            w.bool(touch.passes);
        }
    }

    fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut list = Vec::new();
        for _ in 0..r.count(25)? {
            list.push(Touch { a: load_shape_id(r)?, b: load_shape_id(r)?, passes: r.bool()? });
        }
        if !list.is_sorted_by(|p: &Touch, q| p.shapes() < q.shapes()) {
            return Err(r.error("touching pairs are out of order"));
        }
        Ok(Self { list, next: Vec::new() })
    }
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
