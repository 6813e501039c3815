//! Contact tracking: touching pairs, for begin and end events.

use crate::arena::Arena;
use crate::body::Body;
use crate::body::snapshot::body_index;
use crate::contact::hits::OpenHits;
use crate::contact::modifiers::Modifiers;
use crate::contact::{Contact, ContactKey};
use crate::id::{BodyId, ShapeId};
use sinew_math::{ReadError, Reader, Writer};

/// State of touching pairs outside their contacts, which exist only while the broad phase finds the pairs. Part of the
/// snapshot.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactTracking {
    /// Touching pairs of solid shapes.
    pub touching: Touches,
    /// Pairs of a sensor and a shape in it.
    pub sensed: Touches,
    pub hits: OpenHits,
    /// Bodies changed since the last step: their contacts are tested again even if nothing moves.
    pub changed: Vec<u32>,
    /// Contact modifiers; not part of the snapshot.
    pub modifiers: Modifiers,
}

impl ContactTracking {
    pub fn save(&self, w: &mut Writer) {
        self.touching.save(w);
        self.sensed.save(w);
        self.hits.save(w);
        w.count(self.changed.len());
        for &index in &self.changed {
            w.u32(index);
        }
    }

    /// Reads the state, and marks the bodies that were changed.
    pub fn load(r: &mut Reader<'_>, bodies: &mut Arena<Body>) -> Result<Self, ReadError> {
        let (touching, sensed, hits) = (Touches::load(r)?, Touches::load(r)?, OpenHits::load(r)?);
        let mut changed = Vec::new();
        for _ in 0..r.count(4)? {
            let index = body_index(r, bodies)?;
            bodies.at_mut(index).changed = true;
            changed.push(index);
        }
        Ok(Self { touching, sensed, hits, changed, modifiers: Modifiers::default() })
    }

    /// Ends the touch of a contact that is dropped.
    pub fn part(&mut self, bodies: &Arena<Body>, contact: &Contact) {
        if contact.touching {
            self.touching.gone.push(touch_of(bodies, contact.key));
        }
        if contact.sensed {
            self.sensed.gone.push(touch_of(bodies, contact.key));
        }
    }

    /// Clears the marks of changed bodies after the step has processed the changes.
    pub fn settle(&mut self, bodies: &mut Arena<Body>) {
        for index in self.changed.drain(..) {
            bodies.at_mut(index).changed = false;
        }
    }
}

/// Two touching shapes; the one with the smaller body index is A.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Touch {
    pub a: ShapeId,
    pub b: ShapeId,
}

impl Touch {
    /// Key that sorts all lists.
    fn shapes(&self) -> (BodyId, BodyId, u32, u32) {
        (self.a.body, self.b.body, self.a.shape, self.b.shape)
    }

    fn bodies(&self) -> (BodyId, BodyId) {
        (self.a.body, self.b.body)
    }
}

/// Ids of the two shapes of a contact.
pub(crate) fn shape_ids(bodies: &Arena<Body>, key: ContactKey) -> (ShapeId, ShapeId) {
    (
        ShapeId { body: bodies.id(key.a), shape: key.shape_a },
        ShapeId { body: bodies.id(key.b), shape: key.shape_b },
    )
}

/// The shapes of a contact.
fn touch_of(bodies: &Arena<Body>, key: ContactKey) -> Touch {
    let (a, b) = shape_ids(bodies, key);
    Touch { a, b }
}

/// Touching pairs or sensor pairs. A contact stores whether its pair touched when last tested. This list holds the
/// pairs whose contact was dropped since, and the results of one step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Touches {
    /// Pairs that touched until their contact was dropped: the next step reports their end. Part of the snapshot.
    gone: Vec<Touch>,
    /// Pairs that touched before this step or touch now, except pairs of bodies that had no change and no dropped
    /// contact.
    seen: Vec<Seen>,
    /// Start in `seen` of the current two bodies' pairs, and whether any of them changed.
    first: usize,
    changes: bool,
    /// Pairs of `gone` and `seen`, merged for reports.
    noted: Vec<Noted>,
}

/// A pair of shapes visited by the step.
#[derive(Clone, Copy, Debug)]
struct Seen {
    key: ContactKey,
    was: bool,
    is: bool,
}

#[derive(Clone, Copy, Debug)]
struct Noted {
    touch: Touch,
    was: bool,
    is: bool,
}

/// Lists of started or ended touches.
pub(crate) struct TouchEvents<'a> {
    pub bodies: &'a mut Vec<(BodyId, BodyId)>,
    pub shapes: &'a mut Vec<(ShapeId, ShapeId)>,
}

impl Touches {
    /// Starts a step; reserves space for the pairs of `contacts` contacts.
    pub fn start(&mut self, contacts: usize) {
        self.seen.clear();
        self.noted.clear();
        (self.first, self.changes) = (0, false);
        self.seen.reserve(contacts);
        self.noted.reserve(contacts + self.gone.len());
        self.gone.reserve(contacts);
    }

    /// Records whether a pair of shapes touched when last tested, and whether it touches now. Pairs come in order.
    pub fn note(&mut self, key: ContactKey, was: bool, is: bool) {
        if !was && !is {
            return;
        }
        if self.seen.last().is_some_and(|last| (last.key.a, last.key.b) != (key.a, key.b)) {
            self.forget_unchanged();
        }
        self.changes |= was != is;
        self.seen.push(Seen { key, was, is });
    }

    /// Drops the pairs of the current two bodies if none changed and no contact was dropped: there is nothing to
    /// report.
    fn forget_unchanged(&mut self) {
        if !self.changes && self.gone.is_empty() {
            self.seen.truncate(self.first);
        }
        (self.first, self.changes) = (self.seen.len(), false);
    }

    /// Reports the changes in order.
    pub fn report<'a>(&mut self, bodies: &Arena<Body>, mut begin: TouchEvents<'a>, mut end: TouchEvents<'a>) {
        self.forget_unchanged();
        let noted = |&Seen { key, was, is }: &Seen| Noted { touch: touch_of(bodies, key), was, is };
        self.noted.extend(self.seen.iter().map(noted));
        self.noted.extend(self.gone.drain(..).map(|touch| Noted { touch, was: true, is: false }));
        // Reserves space for all pairs: the number varies from step to step.
        let most = self.noted.capacity();
        for TouchEvents { bodies, shapes } in [&mut begin, &mut end] {
            bodies.clear();
            bodies.reserve(most);
            shapes.clear();
            shapes.reserve(most);
        }
        self.noted.sort_unstable_by_key(|noted| noted.touch.shapes());
        for of_bodies in self.noted.chunk_by(|p, q| p.touch.bodies() == q.touch.bodies()) {
            match change(of_bodies) {
                Some(Change::Begins) => begin.bodies.push(of_bodies[0].touch.bodies()),
                Some(Change::Ends) => end.bodies.push(of_bodies[0].touch.bodies()),
                None => {}
            }
            for of_shapes in of_bodies.chunk_by(|p, q| p.touch == q.touch) {
                let Touch { a, b } = of_shapes[0].touch;
                match change(of_shapes) {
                    Some(Change::Begins) => begin.shapes.push((a, b)),
                    Some(Change::Ends) => end.shapes.push((a, b)),
                    None => {}
                }
            }
        }
    }

    fn save(&self, w: &mut Writer) {
        let mut gone = self.gone.clone();
        gone.sort_unstable_by_key(Touch::shapes);
        w.count(gone.len());
        for touch in gone {
            save_shape_id(w, touch.a);
            save_shape_id(w, touch.b);
        }
    }

    fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut gone = Vec::new();
        for _ in 0..r.count(24)? {
            gone.push(Touch { a: load_shape_id(r)?, b: load_shape_id(r)? });
        }
        Ok(Self { gone, ..Self::default() })
    }
}

enum Change {
    Begins,
    Ends,
}

/// Change from no touching pair to at least one, or the reverse; `None` if neither.
fn change(noted: &[Noted]) -> Option<Change> {
    match (noted.iter().any(|noted| noted.was), noted.iter().any(|noted| noted.is)) {
        (false, true) => Some(Change::Begins),
        (true, false) => Some(Change::Ends),
        _ => None,
    }
}

pub(crate) fn save_shape_id(w: &mut Writer, id: ShapeId) {
    w.u64(id.body.to_bits());
    w.u32(id.shape);
}

pub(crate) fn load_shape_id(r: &mut Reader<'_>) -> Result<ShapeId, ReadError> {
    Ok(ShapeId { body: BodyId::from_bits(r.u64()?), shape: r.u32()? })
}
