//! Tests of the embedded character and world.

mod cabin;
mod mannequin;
mod motions;
