//! Integration tests of the world, compared with closed forms and brute force.

mod allocations;
mod backstops;
mod bobs;
mod bounce;
mod boxes;
mod build;
#[path = "../../../sinew_geometry/tests/it/cases.rs"]
mod cases;
mod changes;
mod closed_forms;
mod eights;
mod events;
mod fields;
mod finite;
mod flight;
mod held;
mod hull;
mod humanoid;
mod ids;
mod joints;
mod large_islands;
mod loads;
mod meshes;
mod mover;
mod nets;
mod objects;
mod particle_worlds;
mod particles;
mod pinched;
mod pins;
mod quality;
mod queries;
mod random_worlds;
mod rims;
mod rope;
mod round_rest;
mod seams;
mod self_collision;
#[cfg(feature = "serde")]
mod serde;
mod sleep;
#[path = "../../../sinew_geometry/tests/it/solids.rs"]
mod solids;
mod spinning;
mod stacks;
mod strands;
mod strangers;
mod surfaces;
mod threads;
mod touches;
mod trees;
mod trouble;
mod update;
#[path = "../../../sinew_geometry/tests/it/wide.rs"]
mod wide;
mod yields;
