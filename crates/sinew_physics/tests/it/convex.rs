//! Any two convex shapes: gaps, casts, and how the round ones come to rest. Each kind of pair is asked 1,000 times, or
//! 100,000 times when `SINEW_FULL` is set.

mod cast;
mod gaps;
mod rest;
