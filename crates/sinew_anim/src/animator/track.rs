use crate::playback::playhead::{LoopMode, Playhead};
use crate::pose::smoothstep;
use crate::set::{ClipId, MaskId};
use crate::tuning::MAX_SPEED;
use sinew_math::clamp;

/// Id of a track of an [`Animator`](super::Animator); ids are never reused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TrackId(pub(crate) u64);

impl TrackId {
    /// Converts to a number, for saving an animator and data that refers to its tracks.
    pub fn to_bits(self) -> u64 {
        self.0
    }

    /// Restores an id from [`to_bits`](Self::to_bits); it refers to no track if the animator lacks the track.
    pub fn from_bits(bits: u64) -> Self {
        Self(bits)
    }
}

/// Action of a track at the end of a ramp, or of a clip that plays once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EndAction {
    /// The track continues with its new weight, or holds its last pose.
    #[default]
    Hold,
    /// The animator removes the track.
    Stop,
    /// The track pauses.
    Pause,
    /// The track starts again at [`TrackDef::start`]. A track of a sync group keeps the group's time.
    Restart,
}

/// Easing of a weight from one value to another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Easing {
    /// Interpolation at constant speed.
    Linear,
    /// `3x² − 2x³`: zero speed at both ends.
    #[default]
    Smooth,
    /// `x²`: slow at the start.
    In,
    /// `x (2 − x)`: slow at the end.
    Out,
}

impl Easing {
    /// Eased share at share `x` of the time; both are 0 to 1.
    pub fn at(self, x: f32) -> f32 {
        let x = clamp(x, 0.0, 1.0);
        match self {
            Self::Linear => x,
            Self::Smooth => smoothstep(x),
            Self::In => x * x,
            Self::Out => x * (2.0 - x),
        }
    }
}

/// Definition of a track: its clip and how it is played.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackDef {
    /// The clip that is played.
    pub clip: ClipId,
    /// Weight in the blend, ≥ 0; weights of a layer need not add up to 1.
    pub weight: f32,
    /// Clip seconds per second, at most [`MAX_SPEED`]; backward if negative.
    pub speed: f32,
    /// Clip seconds at which the track starts. In a sync group that already plays, the track starts at the group's
    /// phase.
    pub start: f32,
    /// Continuation after the clip's end.
    pub loop_mode: LoopMode,
    /// Action at the end of a clip that plays once.
    pub at_end: EndAction,
    /// Layer of the track. Layer 0 is blended with the rest pose; tracks of higher layers cover the layers below,
    /// in proportion to the sum of their weights times masks, up to 1.
    pub layer: u8,
    /// Mask of the joints that the track moves; all joints by default.
    pub mask: Option<MaskId>,
    /// Sync group. Tracks of one group loop, and are kept in phase by the markers of their clips.
    pub sync_group: Option<u8>,
}

impl TrackDef {
    /// Creates a track that loops its clip from the start at its own speed, with weight 1, on all joints.
    pub fn new(clip: ClipId) -> Self {
        Self {
            clip,
            weight: 1.0,
            speed: 1.0,
            start: 0.0,
            loop_mode: LoopMode::Loop,
            at_end: EndAction::Hold,
            layer: 0,
            mask: None,
            sync_group: None,
        }
    }

    pub(super) fn check(&self) {
        check_weight(self.weight);
        check_speed(self.speed);
        assert!(self.start.is_finite(), "the start of a track must be finite, not {}", self.start);
        let loops = self.loop_mode == LoopMode::Loop;
        assert!(loops || self.sync_group.is_none(), "a track of a sync group loops");
    }
}

pub(super) fn check_speed(speed: f32) {
    assert!(is_speed(speed), "the speed must be finite and at most {MAX_SPEED}, not {speed}");
}

pub(super) fn is_speed(speed: f32) -> bool {
    speed.abs() <= MAX_SPEED
}

pub(super) fn check_weight(weight: f32) {
    assert!(weight >= 0.0 && weight.is_finite(), "the weight must be at least 0, not {weight}");
}

/// A weight ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ramp {
    pub from: f32,
    pub to: f32,
    pub seconds: f64,
    pub elapsed: f64,
    pub easing: Easing,
    pub then: EndAction,
}

impl Ramp {
    pub fn at(&self, elapsed: f64) -> f32 {
        if elapsed >= self.seconds {
            return self.to;
        }
        self.from + (self.to - self.from) * self.easing.at((elapsed / self.seconds) as f32)
    }

    pub fn left(&self) -> f64 {
        self.seconds - self.elapsed
    }
}

/// Current state of a track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    pub(super) id: TrackId,
    pub(super) def: TrackDef,
    pub(super) playhead: Playhead,
    pub(super) ramp: Option<Ramp>,
    pub(super) is_paused: bool,
}

impl Track {
    /// Id of the track.
    pub fn id(&self) -> TrackId {
        self.id
    }

    /// The track's definition with its current weight and speed.
    pub fn def(&self) -> &TrackDef {
        &self.def
    }

    /// Position of the track in its clip.
    pub fn playhead(&self) -> &Playhead {
        &self.playhead
    }

    /// True if the track is paused.
    pub fn is_paused(&self) -> bool {
        self.is_paused
    }

    /// True if the track's weight is ramping.
    pub fn is_ramping(&self) -> bool {
        self.ramp.is_some()
    }

    /// Weight in `seconds` from now.
    pub(super) fn weight_in(&self, seconds: f64) -> f32 {
        self.ramp.map_or(self.def.weight, |ramp| ramp.at(ramp.elapsed + seconds))
    }
}
