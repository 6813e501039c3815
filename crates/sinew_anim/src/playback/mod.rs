//! Playback: time within a clip, phase, inertial transitions, blend space weights.

pub mod blend_space;
pub mod inertial;
pub mod playhead;
pub mod sync;
