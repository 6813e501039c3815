//! Tests of the embedded character and world, and of the scenes.

mod blueprint;
mod cabin;
mod crowd;
mod mannequin;
mod mjcf;
mod mocap;
mod motions;
mod movers;
mod recording;
mod scenes;
mod scenes_repeat;
mod staged;
