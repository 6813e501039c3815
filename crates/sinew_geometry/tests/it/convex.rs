//! Any two convex shapes: gaps and casts. Each kind of pair is asked 1,000 times, or
//! 100,000 times when `SINEW_FULL` is set.

mod cast;
mod gaps;
