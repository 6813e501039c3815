//! Data that the characters of one rig share: clips and masks.

use crate::built::{BuiltClip, Fill};
use crate::clip::root_motion::MotionTrack;
use crate::event::{ClipEvent, FiredEvent};
use crate::playback::sync::Markers;
use crate::pose::{Mask, Skeleton};
use sinew_math::StableHasher;

/// Id of a clip of an [`AnimationSet`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ClipId(pub(crate) u32);

/// Id of a mask of an [`AnimationSet`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaskId(pub(crate) u32);

/// A clip with its metadata.
#[derive(Clone, Debug, PartialEq)]
pub struct AnimatedClip {
    /// The poses. A clip built with [`Fill::Identity`] is additive; one with [`Fill::Rest`] is blended.
    pub clip: BuiltClip,
    /// Events of the clip, in any order.
    pub events: Vec<ClipEvent>,
    /// Markers that keep the clip in phase with other clips.
    pub markers: Markers,
    /// Motion of the character, if it was extracted from the poses.
    pub motion: Option<MotionTrack>,
}

impl From<BuiltClip> for AnimatedClip {
    fn from(clip: BuiltClip) -> Self {
        Self { clip, events: Vec::new(), markers: Markers::default(), motion: None }
    }
}

impl AnimatedClip {
    pub(crate) fn is_difference(&self) -> bool {
        self.clip.fill() == Fill::Identity
    }
}

/// Clips and masks of one rig. Animators refer to them by id; they are never removed.
#[derive(Clone, Debug, PartialEq)]
pub struct AnimationSet {
    skeleton: Skeleton,
    clips: Vec<AnimatedClip>,
    masks: Vec<Mask>,
}

impl AnimationSet {
    /// Creates a set without clips.
    pub fn new(skeleton: Skeleton) -> Self {
        Self { skeleton, clips: Vec::new(), masks: Vec::new() }
    }

    /// Skeleton of the set.
    pub fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }

    /// Adds a clip; returns its id.
    ///
    /// # Panics
    /// If the clip has another number of joints than the skeleton, an event or marker is outside of its duration, or an
    /// event's least weight is not in 0..=1.
    pub fn add_clip(&mut self, clip: AnimatedClip) -> ClipId {
        assert_eq!(clip.clip.joints(), self.skeleton.len(), "a clip of the same rig");
        let duration = clip.clip.duration();
        for event in &clip.events {
            assert!((0.0..=duration).contains(&event.time), "{:?} is outside of its clip", event.name);
            let weight = event.policy.min_weight;
            assert!((0.0..=1.0).contains(&weight), "{:?}: a least weight is in 0..=1", event.name);
        }
        let last = clip.markers.times()[clip.markers.times().len() - 1];
        assert!(last < duration || last == 0.0, "a marker at {last} s is outside of its clip");
        self.clips.push(clip);
        ClipId(u32::try_from(self.clips.len() - 1).expect("fewer than 2^32 clips"))
    }

    /// Adds a mask; returns its id.
    ///
    /// # Panics
    /// If the mask has another number of joints than the skeleton.
    pub fn add_mask(&mut self, mask: Mask) -> MaskId {
        assert_eq!(mask.len(), self.skeleton.len(), "a mask of the same rig");
        self.masks.push(mask);
        MaskId(u32::try_from(self.masks.len() - 1).expect("fewer than 2^32 masks"))
    }

    /// Returns a clip.
    ///
    /// # Panics
    /// If the id is from another set and this set has fewer clips.
    pub fn clip(&self, id: ClipId) -> &AnimatedClip {
        &self.clips[id.0 as usize]
    }

    /// Returns a mask.
    ///
    /// # Panics
    /// If the id is from another set and this set has fewer masks.
    pub fn mask(&self, id: MaskId) -> &Mask {
        &self.masks[id.0 as usize]
    }

    /// Iterates over the ids of all clips, in the order in which they were added.
    pub fn clips(&self) -> impl ExactSizeIterator<Item = ClipId> {
        (0..self.clips.len() as u32).map(ClipId)
    }

    /// Returns name, payload and policy of an event that an animator of this set fired.
    ///
    /// # Panics
    /// If an animator of another set fired the event and this set does not have it.
    pub fn event(&self, fired: &FiredEvent) -> &ClipEvent {
        &self.clip(fired.clip).events[fired.event]
    }

    pub(crate) fn has_clip(&self, id: u32) -> Option<ClipId> {
        ((id as usize) < self.clips.len()).then_some(ClipId(id))
    }

    pub(crate) fn has_mask(&self, id: u32) -> Option<MaskId> {
        ((id as usize) < self.masks.len()).then_some(MaskId(id))
    }

    /// Hash that differs between sets whose animators are not interchangeable.
    pub(crate) fn fingerprint(&self) -> u64 {
        let mut hasher = StableHasher::default();
        for number in [self.skeleton.len(), self.masks.len(), self.clips.len()] {
            hasher.write(&(number as u64).to_le_bytes());
        }
        for clip in &self.clips {
            hasher.write(&clip.clip.fingerprint().to_le_bytes());
        }
        hasher.finish()
    }
}
