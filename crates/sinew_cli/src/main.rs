//! The `sinew` command line.
#![forbid(unsafe_code)]

fn main() {}
