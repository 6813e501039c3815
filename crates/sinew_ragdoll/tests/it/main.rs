//! Integration tests of the ragdoll crate.

mod build;
mod build_limits;
mod data;
