//! Integration tests of the geometry, compared with closed forms and brute force.

mod boxes;
mod cases;
mod collide;
mod convex;
mod cook;
mod hull;
mod meshes;
mod ray;
mod solids;
mod submerged;
mod wide;
