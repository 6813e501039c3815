//! Handles: index, generation and lineage, so that stale ids and ids of another world are detected.

use core::fmt;
use std::hash::{BuildHasher, RandomState};

/// World that an id belongs to. Not part of a snapshot or hash. Ids from bits, and ids of a world that has loaded a
/// snapshot, have an unknown lineage, which matches every world: a user who loads the snapshot of another world
/// continues to use the ids of that world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Lineage(u32);

impl Lineage {
    /// Unique in the process except for a chance of one in 2³¹: hashers are seeded randomly.
    pub fn fresh() -> Self {
        Self(RandomState::new().hash_one(()) as u32 | 1)
    }

    /// True unless both lineages are known and different.
    pub fn goes_with(self, other: Self) -> bool {
        self == other || self == Self::default() || other == Self::default()
    }
}

/// Typed id of an item in an [`Arena`](crate::arena::Arena).
pub(crate) trait Handle: Copy + fmt::Debug {
    fn new(index: u32, generation: u32, lineage: Lineage) -> Self;
    fn index(self) -> u32;
    fn generation(self) -> u32;
    fn lineage(self) -> Lineage;
}

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        ///
        /// A world panics for the id of a removed item, and for an id of another world, unless it has loaded a
        /// snapshot. Ids are equal if their [bits](Self::to_bits) are.
        #[derive(Clone, Copy)]
        pub struct $name {
            pub(crate) index: u32,
            pub(crate) generation: u32,
            lineage: Lineage,
        }

        impl $name {
            /// Returns index and generation in one number, which the user can store.
            pub fn to_bits(self) -> u64 {
                u64::from(self.generation) << 32 | u64::from(self.index)
            }
            /// Returns the id of a number from [`to_bits`](Self::to_bits); any world accepts it.
            pub fn from_bits(bits: u64) -> Self {
                Self { index: bits as u32, generation: (bits >> 32) as u32, lineage: Lineage::default() }
            }
        }

        /// Serialises an id as its [bits](Self::to_bits).
        #[cfg(feature = "serde")]
        impl serde::Serialize for $name {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_u64(self.to_bits())
            }
        }

        #[cfg(feature = "serde")]
        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                u64::deserialize(deserializer).map(Self::from_bits)
            }
        }

        impl Handle for $name {
            fn new(index: u32, generation: u32, lineage: Lineage) -> Self {
                Self { index, generation, lineage }
            }
            fn index(self) -> u32 {
                self.index
            }
            fn generation(self) -> u32 {
                self.generation
            }
            fn lineage(self) -> Lineage {
                self.lineage
            }
        }

        impl PartialEq for $name {
            fn eq(&self, other: &Self) -> bool {
                self.to_bits() == other.to_bits()
            }
        }

        impl Eq for $name {}

        impl PartialOrd for $name {
            fn partial_cmp(&self, other: &Self) -> Option<core::cmp::Ordering> {
                Some(self.cmp(other))
            }
        }

        impl Ord for $name {
            fn cmp(&self, other: &Self) -> core::cmp::Ordering {
                (self.index, self.generation).cmp(&(other.index, other.generation))
            }
        }

        impl core::hash::Hash for $name {
            fn hash<H: core::hash::Hasher>(&self, state: &mut H) {
                self.to_bits().hash(state);
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{} {}v{}", stringify!($name), self.index, self.generation)
            }
        }
    };
}

id! {
    /// A body of a [`World`](crate::World).
    BodyId
}
id! {
    /// A joint of a [`World`](crate::World).
    JointId
}
id! {
    /// A particle group of a [`World`](crate::World).
    GroupId
}
id! {
    /// A field of a [`World`](crate::World).
    FieldId
}
id! {
    /// A character mover of a [`World`](crate::World).
    MoverId
}
id! {
    /// An object of the user's own kind in a [`World`](crate::World).
    ObjectId
}

/// A shape of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ShapeId {
    /// Body of the shape.
    pub body: BodyId,
    /// Number of the shape in its body, counted from 0 as in [`BodyDef::shapes`](crate::BodyDef::shapes).
    pub shape: u32,
}
