//! Questions to worlds: against every shape by itself, against oracles in `f64`, and at the edges of what can be asked.
//!
//! Each question is asked 1,000 times, or 100,000 times when `SINEW_FULL` is set, as `cargo xtask ci --full` does.

mod balls;
mod filters;
mod hostile;
mod now;
mod oracle;
mod random;
mod rays;
mod starts;
mod surfaces;
mod whole_world;
