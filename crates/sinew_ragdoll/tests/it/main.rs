//! Integration tests of the ragdoll crate.

mod actor;
mod bake;
