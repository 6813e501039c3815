//! Queries of worlds: compared with every shape alone and with oracles in `f64`, and with extreme arguments.
//!
//! Each query runs 1,000 times, or 100,000 times with `SINEW_FULL` set, as `cargo xtask ci --full` does.

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
