//! Gaps and casts of any two convex shapes: 1,000 cases of each pair of kinds, or
//! 100,000 with `SINEW_FULL` set.

mod cast;
mod gaps;
