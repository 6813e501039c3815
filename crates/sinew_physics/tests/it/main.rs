//! Integration tests of the world, held against closed forms and brute force.

mod allocations;
mod bounce;
mod boxes;
mod build;
mod closed_forms;
mod collide;
mod cook;
mod events;
mod fields;
mod finite;
mod humanoid;
mod joints;
mod meshes;
mod nets;
mod objects;
mod particles;
mod random_worlds;
mod ray;
mod rope;
mod sleep;
mod surfaces;
mod trees;
mod trouble;
mod update;
