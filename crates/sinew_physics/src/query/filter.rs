//! Filter of the shapes that a query considers.

use crate::body::def::BodyKind;
use crate::body::shape::{Filter, Sensing};
use crate::id::{BodyId, ShapeId};
use core::ops::BitOr;

/// Filter of the shapes of a world that a [`Query`](super::Query) considers. Default: every shape except sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[doc(alias = "layer mask")]
pub struct QueryFilter<'a> {
    /// Filter with which the query acts like a shape: it accepts shapes that [`Filter::meets`] this filter. Default: on
    /// all layers, with all layers in its mask, in no group. A shape with an empty mask collides with nothing, so no
    /// query finds it.
    pub meets: Filter,
    /// Kinds of bodies whose shapes are accepted. Default: all.
    pub kinds: BodyKinds,
    /// Treatment of sensors. Default: ignored.
    pub sensors: Sensors,
    /// Excluded bodies: a few, because each shape is compared with all of them. Default none.
    pub except: &'a [BodyId],
}

impl Default for QueryFilter<'_> {
    fn default() -> Self {
        Self {
            meets: Filter { layers: u32::MAX, ..Filter::default() },
            kinds: BodyKinds::ALL,
            sensors: Sensors::Ignored,
            except: &[],
        }
    }
}

impl<'a> QueryFilter<'a> {
    /// Returns a filter for the shapes of some kinds of bodies.
    pub fn of(kinds: BodyKinds) -> Self {
        Self { kinds, ..Self::default() }
    }

    /// Returns a filter for all bodies except a few.
    pub fn without(except: &'a [BodyId]) -> Self {
        Self { except, ..Self::default() }
    }

    /// True if a shape of a body of this kind passes.
    pub(super) fn passes(&self, id: ShapeId, kind: BodyKind, filter: Filter, sensing: Sensing) -> bool {
        self.kinds.contains(kind)
            && (sensing == Sensing::Solid || self.sensors == Sensors::Included)
            && self.meets.meets(filter)
            && !self.except.contains(&id.body)
    }
}

/// Treatment of sensors in a query.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sensors {
    /// Sensors are ignored. Default.
    #[default]
    Ignored,
    /// Sensors answer like solid shapes.
    Included,
}

/// A set of [`BodyKind`]s: `BodyKinds::STATIC | BodyKinds::KINEMATIC`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BodyKinds(u8);

impl BodyKinds {
    /// Static bodies: they never move.
    pub const STATIC: Self = Self(1);
    /// Kinematic bodies: they move according to their velocity.
    pub const KINEMATIC: Self = Self(2);
    /// Dynamic bodies: forces move them.
    pub const DYNAMIC: Self = Self(4);
    /// All three.
    pub const ALL: Self = Self(7);

    /// True if a kind is in the set.
    pub fn contains(self, kind: BodyKind) -> bool {
        self.0 & Self::from(kind).0 != 0
    }
}

impl From<BodyKind> for BodyKinds {
    fn from(kind: BodyKind) -> Self {
        match kind {
            BodyKind::Static => Self::STATIC,
            BodyKind::Kinematic => Self::KINEMATIC,
            BodyKind::Dynamic => Self::DYNAMIC,
        }
    }
}

impl BitOr for BodyKinds {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}
