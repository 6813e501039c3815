//! Pair filters: by shape filters, by disabled pairs, and by a user function.

use crate::arena::Arena;
use crate::body::Body;
use crate::body::def::BodyKind;
use crate::body::shape::{Filter, Sensing};
use crate::contact::{ContactKey, ordered};
use crate::id::ShapeId;
use crate::registered::Registered;

/// One side of a candidate pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairSide {
    /// Shape on this side of the pair.
    pub shape: ShapeId,
    /// Kind of the shape's body.
    pub kind: BodyKind,
    /// User data of the shape's body.
    pub user_data: u64,
    /// Filter of the shape.
    pub filter: Filter,
    /// Solid shape or sensor.
    pub sensing: Sensing,
}

/// User filter for two shapes that pass all other filters; the one with the smaller body index comes first.
///
/// The function must be pure, so that a snapshot determines the future. The type is a function pointer instead of a
/// closure, because the function must not have state. It is called in every step, in unspecified order.
pub type PairFunction = fn(&PairSide, &PairSide) -> bool;

/// Filter of shape pairs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairFilter<'a> {
    /// Pairs of bodies that do not collide: body indices, smaller first, ascending.
    pub parted: &'a [(u32, u32)],
    pub function: Option<PairFunction>,
    /// Number that changes whenever `parted` changes.
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

/// True if the kinds of two shapes allow a contact. Contacts require a dynamic body. A sensor detects any shape if one
/// of the two moves; two sensors do not detect each other.
pub(crate) fn kinds_meet([a, b]: [(BodyKind, Sensing); 2]) -> bool {
    let either = |kind: BodyKind| a.0 == kind || b.0 == kind;
    match (a.1, b.1) {
        (Sensing::Sensor, Sensing::Sensor) => false,
        (Sensing::Solid, Sensing::Solid) => either(BodyKind::Dynamic),
        _ => either(BodyKind::Dynamic) || either(BodyKind::Kinematic),
    }
}

/// The registered user functions, and the active one.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairFunctions {
    pub registered: Registered<PairFunction>,
    /// Number of the active function. Part of the snapshot.
    pub chosen: Option<u32>,
}

impl PairFunctions {
    pub fn function(&self) -> Option<PairFunction> {
        self.registered.find(self.chosen?)
    }
}
