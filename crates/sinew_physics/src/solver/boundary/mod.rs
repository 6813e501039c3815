//! Data that pass between the world and an island: its bodies, joints and contacts on the way in, forces between stages, results on the way out.

pub(in crate::solver) mod build;
pub(in crate::solver) mod counts;
pub(in crate::solver) mod faces;
pub(in crate::solver) mod fields;
pub(crate) mod groups;
pub(in crate::solver) mod growth;
pub(crate) mod solution;
mod store;
pub(in crate::solver) mod tally;
mod user_forces;
