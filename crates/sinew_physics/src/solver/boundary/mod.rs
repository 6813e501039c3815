//! Data exchange between the world and an island: reads bodies, joints and contacts, adds forces between stages, writes
//! results.

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
