//! Integration tests of the ragdoll crate.

mod actor;
mod bake;
mod build;
mod build_limits;
mod character;
mod data;
mod doctor;
mod hand_over;
mod mapping;
mod quality;
mod settings;
