//! Integration tests of the ragdoll crate.

mod actor;
mod bake;
mod blows;
mod build;
mod build_limits;
mod character;
mod data;
mod disguise;
mod doctor;
mod drive;
mod falls;
mod filter;
mod guises;
mod hand_over;
mod in_world;
mod learned;
mod mapping;
mod pops;
mod quality;
mod rollback;
mod settings;
mod skin;
mod slopes;
mod travel;
mod variants;
mod volume;
