//! Handles: an index and a generation, so that a stale one is caught.

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name {
            pub(crate) index: u32,
            pub(crate) generation: u32,
        }

        impl $name {
            /// Both parts in one number, for storage on the user's side.
            pub fn to_bits(self) -> u64 {
                u64::from(self.generation) << 32 | u64::from(self.index)
            }
            /// From [`to_bits`](Self::to_bits).
            pub fn from_bits(bits: u64) -> Self {
                Self { index: bits as u32, generation: (bits >> 32) as u32 }
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
    /// An object of the user's own kind in a [`World`](crate::World).
    ObjectId
}

/// A shape of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ShapeId {
    /// The body.
    pub body: BodyId,
    /// Which of its shapes, counted from 0 as in [`BodyDef::shapes`](crate::BodyDef::shapes).
    pub shape: u32,
}
