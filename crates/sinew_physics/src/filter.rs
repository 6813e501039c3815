//! Which shapes may meet: filters, pairs that were parted, and a function of the user's.

use crate::arena::Arena;
use crate::body::Body;
use crate::contact::{Contact, ContactKey, ordered};
use crate::def::BodyKind;
use crate::id::{BodyId, ShapeId};
use crate::registered::Registered;
use crate::shape::{Filter, Sensing};
use crate::world::World;

/// One side of a pair that may meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairSide {
    /// The shape.
    pub shape: ShapeId,
    /// How its body moves.
    pub kind: BodyKind,
    /// The user's number on its body.
    pub user_data: u64,
    /// Its filter.
    pub filter: Filter,
    /// Whether it only senses.
    pub sensing: Sensing,
}

/// Whether two shapes may meet that all other filters let meet; the one with the smaller body index comes first.
///
/// A pure function, so that a snapshot holds all that decides; a plain one, not a closure: there is nothing that it could
/// remember. It is asked in every step, in no defined order.
pub type PairFunction = fn(&PairSide, &PairSide) -> bool;

/// What keeps shapes from meeting.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairFilter<'a> {
    /// Body indices, smaller first, ascending.
    pub parted: &'a [(u32, u32)],
    pub function: Option<PairFunction>,
    /// Another one whenever `parted` is another.
    pub version: u64,
}

impl PairFilter<'_> {
    pub fn lets_meet(&self, bodies: &Arena<Body>, key: ContactKey) -> bool {
        if key.a == key.b {
            return false;
        }
        let (a, b) = (bodies.at(key.a), bodies.at(key.b));
        let (s, t) = (a.surface(key.shape_a as usize), b.surface(key.shape_b as usize));
        kinds_meet([(a.kind, s.sensing), (b.kind, t.sensing)])
            && s.filter.meets(t.filter)
            && !a.quarantined
            && !b.quarantined
            && self.parted.binary_search(&ordered(key.a, key.b)).is_err()
            && self.function.is_none_or(|accepts| {
                accepts(&side(bodies, key.a, key.shape_a), &side(bodies, key.b, key.shape_b))
            })
    }
}

fn side(bodies: &Arena<Body>, index: u32, shape: u32) -> PairSide {
    let body = bodies.at(index);
    let s = body.surface(shape as usize);
    PairSide {
        shape: ShapeId { body: bodies.id(index), shape },
        kind: body.kind,
        user_data: body.user_data,
        filter: s.filter,
        sensing: s.sensing,
    }
}

/// Contacts push something dynamic. A sensor sees whatever it or the other may move to; two sensors do not see each other.
fn kinds_meet([a, b]: [(BodyKind, Sensing); 2]) -> bool {
    let either = |kind: BodyKind| a.0 == kind || b.0 == kind;
    match (a.1, b.1) {
        (Sensing::Sensor, Sensing::Sensor) => false,
        (Sensing::Solid, Sensing::Solid) => either(BodyKind::Dynamic),
        _ => either(BodyKind::Dynamic) || either(BodyKind::Kinematic),
    }
}

/// The user's functions, and which of them is asked.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairFunctions {
    pub registered: Registered<PairFunction>,
    /// Part of the snapshot.
    pub chosen: Option<u32>,
}

impl PairFunctions {
    pub fn function(&self) -> Option<PairFunction> {
        self.registered.find(self.chosen?)
    }
}

impl World {
    /// Registers a function for [`set_pair_function`](Self::set_pair_function) under a number of the user's choice, in place
    /// of the one that had it.
    ///
    /// A snapshot holds the number, not the code: before a snapshot is loaded into a world, the functions that it names must
    /// be registered in it, else loading fails. Register the same function under the same number, or what comes is another
    /// future.
    pub fn register_pair_function(&mut self, number: u32, function: PairFunction) {
        self.parted.functions.registered.set(number, function);
    }

    /// From now on the registered function of this number is asked whether two shapes may meet that filters let meet;
    /// `None`, as at the start: none is. All bodies wake.
    ///
    /// # Panics
    /// If there is no such function.
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

    /// The function that is asked, by number.
    pub fn pair_function(&self) -> Option<u32> {
        self.parted.functions.chosen
    }

    /// From now on two bodies pass through each other; if they touch, both wake.
    #[track_caller]
    pub fn disable_pair(&mut self, a: BodyId, b: BodyId) {
        self.expect(a);
        self.expect(b);
        let met = |contact: &Contact| contact.pushes() || contact.touching || contact.sensed;
        if self.contacts_at(a.index).any(|contact| contact.key.has(b.index) && met(contact)) {
            self.wake_pair(a, b);
        }
        self.parted.disable(a.index, b.index);
    }

    /// Undoes [`disable_pair`](Self::disable_pair); they wake. Joints between them may still keep them from colliding.
    #[track_caller]
    pub fn enable_pair(&mut self, a: BodyId, b: BodyId) {
        self.expect(a);
        self.expect(b);
        self.wake_pair(a, b);
        self.parted.enable(a.index, b.index);
    }

    /// Has the next step look anew at a pair: by what wakes of it, or else by one of them.
    fn wake_pair(&mut self, a: BodyId, b: BodyId) {
        self.wake_body(a.index);
        self.wake_body(b.index);
        if !self.bodies.at(a.index).is_active() && !self.bodies.at(b.index).is_active() {
            self.look_anew(a);
        }
    }
}
