//! Boxes against brute force in `f64`: 1,000 cases of each pair, or 100,000 with `SINEW_FULL` set, as
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
