//! Integration tests of the ragdoll crate.

mod actor;
mod backstops;
mod bake;
mod blows;
mod borne;
mod build;
mod build_limits;
mod character;
mod data;
mod disguise;
mod doctor;
mod drive;
mod falls;
mod faults;
mod filter;
mod garments;
mod hand_over;
mod in_world;
mod learned;
mod lives;
mod mapping;
mod mesh_garments;
mod pops;
mod quality;

mod retaken;
mod rig_variants;
mod rollback;
mod settings;
mod skin;
mod slopes;
mod springs;
mod stumble;
mod travel;
mod variants;
mod volume;
