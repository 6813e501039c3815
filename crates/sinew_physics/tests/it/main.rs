//! Integration tests of the world, held against closed forms and brute force.

mod allocations;
mod bounce;
mod build;
mod closed_forms;
mod collide;
mod humanoid;
mod joints;
mod nets;
mod particles;
mod random_worlds;
mod ray;
mod rope;
mod trees;
