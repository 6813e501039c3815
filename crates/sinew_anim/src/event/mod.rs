//! Events: named times in a clip, and the ones passed in an update.

mod footsteps;

pub use footsteps::{Footstep, FootstepMerger, FootstepSource};

use crate::animator::TrackId;
use crate::set::ClipId;

/// Rule that selects, among several tracks that pass an event at the same phase, those that may fire it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FiredBy {
    /// Every track that passes the event.
    #[default]
    Every,
    /// The heaviest track of its sync group, and every track without a group.
    Leader,
    /// One track per sync group: the event fires once for all tracks of the group whose clips have an event of that
    /// name at the same marker, such as one footstep for walk and run together. The heaviest track fires the event at
    /// its own time. If another track passed the event before the heaviest one led, that track fires it.
    OnePerGroup,
}

/// Conditions under which a passed event fires.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventPolicy {
    /// Smallest weight of the track at the time of the event, 0 to 1; ½ by default.
    pub min_weight: f32,
    /// Tracks that may fire the event.
    pub fired_by: FiredBy,
    /// True: the event also fires, at any weight, when its track stops before the event in the lap. For clean-up at the
    /// end of a motion.
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

/// An event fired in an update. Name and payload: [`AnimationSet::event`](crate::AnimationSet::event).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiredEvent {
    /// Time, seconds from the start of the update, 0 to its length.
    pub seconds: f64,
    /// Clip of the event.
    pub clip: ClipId,
    /// Index in the clip's events.
    pub event: usize,
    /// The track that passed the event.
    pub track: TrackId,
    /// The track's weight at that moment, before other tracks are considered.
    pub weight: f32,
    /// The track's lap (see [`Playhead::lap`](crate::Playhead::lap)).
    pub lap: i64,
    /// True if the track stopped before the event.
    pub is_interrupted: bool,
}
