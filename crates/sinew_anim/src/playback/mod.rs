//! Parts of playback: time within a clip, phase, transitions by inertia, weights of blend spaces.

pub mod blend_space;
pub mod inertial;
pub mod playhead;
pub mod sync;
