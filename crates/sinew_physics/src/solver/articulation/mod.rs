//! Joints of an island as trees: locked directions are solved exactly, in time proportional to the number of joints.
//!
//! [`tree`] is the factor of one tree, [`batches`] that of eight trees of one shape side by side; both use the
//! [`elimination`] of open directions. [`joints`] solves velocities (RATTLE) and positions (SHAKE) with the factor.
//! [`drives`], [`pins`] and [`loops`] apply other impulses along joints. [`response`] and [`response_cache`] compute
//! the response of a tree to impulses from contacts and limits.

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
