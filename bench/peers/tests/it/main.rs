//! The tests: the quality tool on states with known faults, the scenes against their known sizes, and every
//! engine of this build against closed forms.

mod crowd;
mod engines;
mod joints;
mod quality;
mod queries;
mod scenes;
