//! Clips for playback: quantised, and sampled with a cursor.
//!
//! A key has 8 bytes: an index into the clip's time table and a value of 48 bits. Constant tracks have no keys. A
//! [`BuiltClip`] is built once by [`BuiltClip::build`] and then only read; each character has its own [`Cursor`].
//! Design: `docs/adr/0016-built-clips.md`.

mod build;
mod code;
mod cursor;
mod curve;
mod error;

pub use build::{ClipBuildError, ClipBuildOptions, Fill};
pub use cursor::Cursor;
pub use error::ClipError;

use crate::pose::Pose;
use code::{Bounds, Key, SmallestThree};
use sinew_math::lanes::WIDTH;

/// A motion of one rig, ready to be sampled.
#[derive(Clone, Debug, PartialEq)]
pub struct BuiltClip {
    name: String,
    duration: f32,
    /// All times of keys, seconds, increasing.
    times: Vec<f32>,
    /// Pose of all joints and properties that are not animated: constant tracks, and the rest pose elsewhere.
    base: Pose,
    rotations: Tracks<SmallestThree>,
    translations: Tracks<Bounds>,
    scales: Tracks<Bounds>,
    fill: Fill,
    bound: ClipError,
    /// Hash of all data that affects a pose, so that a cursor recognises its clip.
    fingerprint: u64,
}

/// The animated tracks of one property.
#[derive(Clone, Debug, Default, PartialEq)]
struct Tracks<C> {
    /// Keys, track by track, in order of time.
    keys: Vec<Key>,
    /// Blocks of the pose in which at least one joint is animated.
    blocks: Vec<TrackBlock<C>>,
}

#[derive(Clone, Debug, PartialEq)]
struct TrackBlock<C> {
    /// Index of the block in the pose.
    block: usize,
    tracks: [Track<C>; WIDTH],
}

/// Range of the keys of one property of one joint; empty where the property is not animated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Track<C> {
    first: u32,
    count: u32,
    code: C,
}

impl BuiltClip {
    /// Name in the file, or `""`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Duration, seconds; 0 for a pose.
    pub fn duration(&self) -> f32 {
        self.duration
    }

    /// Number of joints of the rig that the clip was built for.
    pub fn joints(&self) -> usize {
        self.base.len()
    }

    /// Number of keys; each has 8 bytes.
    pub fn keys(&self) -> usize {
        self.rotations.keys.len() + self.translations.keys.len() + self.scales.keys.len()
    }

    /// Size of keys, times, base pose and track table, bytes.
    pub fn bytes(&self) -> usize {
        let tables = self.rotations.blocks.len() * size_of::<TrackBlock<SmallestThree>>()
            + (self.translations.blocks.len() + self.scales.blocks.len()) * size_of::<TrackBlock<Bounds>>();
        let base = self.base.len().div_ceil(WIDTH) * WIDTH * 10 * size_of::<f32>();
        self.keys() * size_of::<Key>() + self.times.len() * size_of::<f32>() + tables + base
    }

    /// Upper bound of the difference between a sampled pose and the raw clip's pose.
    pub fn error_bound(&self) -> ClipError {
        self.bound
    }

    /// Kind of value of joints without a channel: the rest pose in blended clips, no change in additive clips.
    pub fn fill(&self) -> Fill {
        self.fill
    }

    /// Hash that differs between clips with different poses.
    pub fn fingerprint(&self) -> u64 {
        self.fingerprint
    }
}
