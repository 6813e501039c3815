//! Integration tests of the world, held against closed forms and brute force.

mod collide;
mod ray;
