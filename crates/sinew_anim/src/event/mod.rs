//! Callbacks: named events on a clip's timeline, and those passed in an update.

mod footsteps;

pub use footsteps::{Footstep, FootstepMerger, FootstepSource};

use crate::animator::TrackId;
use crate::set::ClipId;

/// Rule for which of several tracks that pass an event at the same phase may fire it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FiredBy {
    /// Every track that passes it.
    #[default]
    Every,
    /// The heaviest track of its sync group, and every track without a group.
    Leader,
    /// Once for all tracks of its sync group whose clips have an event of that name at the same marker: one footstep
    /// for walk and run together. The heaviest of them fires it, at its own moment; another one does if that had passed
    /// it before it became the heaviest.
    OnePerGroup,
}

/// Conditions under which a passed event fires.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventPolicy {
    /// The least weight of the track at the moment of the event, 0 to 1; ½ by default.
    pub min_weight: f32,
    /// Tracks that may fire it.
    pub fired_by: FiredBy,
    /// True if it fires, at any weight, when its track stops before it in the lap: for clean-up at the end of a motion.
    pub on_interrupt: bool,
}

impl Default for EventPolicy {
    fn default() -> Self {
        Self { min_weight: 0.5, fired_by: FiredBy::Every, on_interrupt: false }
    }
}

/// A named time in a clip, such as a foot landing or a fist hitting.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClipEvent {
    /// Time, seconds from the clip's start, 0 to its length.
    pub time: f32,
    /// Name of the event; several events may share it.
    pub name: String,
    /// Data for the user, or `""`.
    pub payload: String,
    /// Condition for firing it.
    pub policy: EventPolicy,
}

impl ClipEvent {
    /// Creates an event with the default policy and no payload.
    pub fn new(time: f32, name: &str) -> Self {
        Self { time, name: name.to_owned(), ..Self::default() }
    }
}

/// An event of an update. Name and payload: [`AnimationSet::event`](crate::AnimationSet::event).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiredEvent {
    /// Time, seconds from the start of the update, 0 to its length.
    pub seconds: f64,
    /// Clip of the event.
    pub clip: ClipId,
    /// Index in the clip's events.
    pub event: usize,
    /// The track that passed it.
    pub track: TrackId,
    /// The track's weight at that moment, before other tracks are considered.
    pub weight: f32,
    /// The track's lap (see [`Playhead::lap`](crate::Playhead::lap)).
    pub lap: i64,
    /// True if its track stopped before it.
    pub is_interrupted: bool,
}
