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
mod world;

/// Of `all` cases those that are run: a hundredth unless `SINEW_FULL` is set.
pub fn cases(all: u32) -> u32 {
    if std::env::var_os("SINEW_FULL").is_some() { all } else { all / 100 }
}
