//! Limits of joints: unilateral rows outside the trees' factors.

pub(in crate::solver) mod blocks;
pub(in crate::solver) mod row;
pub(in crate::solver) mod rows;
