//! Integration tests: real files, hostile files, round trips.

mod data;
mod hostile;
mod rigs;
