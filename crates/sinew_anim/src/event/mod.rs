//! Callbacks: names on a clip's timeline, and what came by in an update.

mod footsteps;

pub use footsteps::{Footstep, FootstepMerger, FootstepSource};

use crate::animator::TrackId;
use crate::set::ClipId;

/// Rule for which of several tracks that pass an event at the same phase may fire it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FiredBy {
    /// Each that passes it.
    #[default]
    Every,
    /// The heaviest track of its sync group, and any track that has none.
    Leader,
    /// Once for all tracks of its sync group whose clips have an event of that name beside the same marker: one footstep for
    /// walk and run together. The heaviest of them fires it, at its own moment; another one where that had passed it before
    /// it became the heaviest.
    OnePerGroup,
}

/// When an event that is passed becomes one that is fired.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventPolicy {
    /// The least weight of the track at the moment of the event, 0 to 1; ½ by default.
    pub min_weight: f32,
    /// Who fires it.
    pub fired_by: FiredBy,
    /// True if it is fired, whatever the weight, when its track is stopped before it in the lap: for what has to be put
    /// right at the end of a motion.
    pub on_interrupt: bool,
}

impl Default for EventPolicy {
    fn default() -> Self {
        Self { min_weight: 0.5, fired_by: FiredBy::Every, on_interrupt: false }
    }
}

/// Something that happens in a clip: a foot comes down, a fist arrives.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClipEvent {
    /// When, seconds from the clip's start, 0 to its length.
    pub time: f32,
    /// Name of what happens; several events may have one name.
    pub name: String,
    /// Whatever the user needs to know of it, or `""`.
    pub payload: String,
    /// When it is fired.
    pub policy: EventPolicy,
}

impl ClipEvent {
    /// With the usual policy and no payload.
    pub fn new(time: f32, name: &str) -> Self {
        Self { time, name: name.to_owned(), ..Self::default() }
    }
}

/// An event that came by in an update. Name and payload: [`AnimationSet::event`](crate::AnimationSet::event).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiredEvent {
    /// When, seconds from the start of the update, 0 to its length.
    pub seconds: f64,
    /// The clip it is in.
    pub clip: ClipId,
    /// Index in the clip's events.
    pub event: usize,
    /// The track that passed it.
    pub track: TrackId,
    /// The track's weight at that moment, before other tracks are taken into account.
    pub weight: f32,
    /// The track's lap (see [`Playhead::lap`](crate::Playhead::lap)).
    pub lap: i64,
    /// True if it was not passed, but its track stopped before it.
    pub is_interrupted: bool,
}
