//! Batches: one box against many points, and many pairs of boxes, eight at a time with SIMD.
//!
//! Each formula is written once, generic over [`Real`](sinew_math::lanes::Real): `f32` computes one item, and the SIMD
//! type that [`dispatch`](sinew_math::dispatch) chooses computes eight. So the result of an item has the same bits
//! alone, in a batch, and on every processor. NaN in an item gives NaN or false for that item only.

mod pairs;
mod points;
mod record;
mod separation;

pub use pairs::{Axes, FindOverlaps, FindSeparations, Pairs, Separations};
pub use points::{ContainsPoints, Points, SignedDistances};
pub use record::{NUMBERS, Record};
pub use separation::{SeparatingAxis, Separation};
