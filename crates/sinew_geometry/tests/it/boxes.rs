//! Boxes against brute force in `f64`. Each pair is asked 1,000 times, or 100,000 times when `SINEW_FULL` is set, as
//! `cargo xtask ci --full` does.

mod batch;
mod build;
mod cast;
mod fit;
mod frustum;
mod oracle;
mod overlap;
mod point;
mod random_pairs;
