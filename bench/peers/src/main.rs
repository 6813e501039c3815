//! The command `peers`.
fn main() {}
