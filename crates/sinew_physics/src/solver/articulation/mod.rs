//! Joints of an island as trees: what they hold is solved exactly, in time in proportion to their number.
//!
//! [`tree`] is the factor of one tree, [`batches`] that of eight of one shape side by side, both by the [`elimination`] of what joints leave
//! open; [`joints`] solves velocities (RATTLE) and positions (SHAKE) with it. [`drives`], [`pins`] and [`loops`] are what else pushes along joints,
//! [`response`] and [`response_cache`] what a tree answers to impulses from elsewhere.

pub(in crate::solver) mod batches;
pub(in crate::solver) mod composite;
pub(in crate::solver) mod drives;
pub(in crate::solver) mod elimination;
pub(in crate::solver) mod joints;
pub(in crate::solver) mod loops;
pub(in crate::solver) mod piece;
pub(in crate::solver) mod pins;
mod reaction;
pub(in crate::solver) mod response;
pub(in crate::solver) mod response_cache;
pub(in crate::solver) mod soft_row;
pub(in crate::solver) mod tree;
