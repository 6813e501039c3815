//! Recordings: the operations on a scene and the resulting states, step by step.
//!
//! A recording holds the scene with its settings, the [`Operation`]s before each step, the hash of the world's state
//! after each step, and sometimes the poses of all bodies. The version that made a recording replays it to the same
//! bits, and finds the first step that differs. Any other version can still show the poses.
//!
//! ```
//! use sinew_scenes::recording::{Recorder, Recording, Replay};
//!
//! let mut recorder = Recorder::start("pendulum", &[])?;
//! for _ in 0..60 {
//!     recorder.step();
//! }
//! let bytes = recorder.finish().to_bytes();
//! let mut replay = Replay::start(Recording::read(&bytes)?)?;
//! while let Some(step) = replay.step() {
//!     assert_eq!(step.found, step.recorded);
//! }
//! # Ok::<(), sinew::formats::Error>(())
//! ```

mod compare;
mod format;
mod hands;
mod record;

pub use compare::{Difference, compare};
pub use format::{FORMAT, KeyFrame, RecordedStep, Recording};
pub use hands::{Hands, Operation};
pub use record::{Mark, Recorder, RecorderMark, Replay, ReplayedStep};
