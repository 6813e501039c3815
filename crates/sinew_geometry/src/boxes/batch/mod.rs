//! Many at once: one box against many points, many pairs of boxes; eight side by side, on the widest registers there are.
//!
//! The formulas are written once, over [`Real`](sinew_math::lanes::Real): for one item it is an `f32`, for eight it is
//! whatever [`dispatch`](sinew_math::dispatch) finds. So an item's answer has the same bits alone and in a batch, and on
//! every processor. NaN in an item gives NaN, or false, for that item alone.

mod pairs;
mod points;
mod record;
mod separation;

pub use pairs::{Axes, FindOverlaps, FindSeparations, Pairs, Separations};
pub use points::{ContainsPoints, Points, SignedDistances};
pub use record::{NUMBERS, Record};
pub use separation::{SeparatingAxis, Separation};
