//! Integration tests of the ragdoll crate.

mod actor;
mod bake;
mod character;
mod doctor;
mod hand_over;
mod mapping;
mod quality;
mod settings;
