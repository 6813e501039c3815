//! Selects the passed events that fire, by their policies.

use super::{Animator, Slot, Track};
use crate::event::{FiredBy, FiredEvent};
use crate::playback::playhead::Place;
use crate::playback::sync::Phase;
use crate::set::{AnimatedClip, AnimationSet, ClipId};

/// An event passed by a track; whether it fires depends on the other crossings.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrackCrossing {
    pub slot: usize,
    pub event: usize,
    /// Position of the event, in the track's laps.
    pub place: Place,
    /// Seconds since the update began.
    pub seconds: f64,
    pub is_backward: bool,
}

/// The last time that a sync group fired an event that its clips share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LastFired {
    pub group: u8,
    /// The clip and event; the name identifies the same event in other clips.
    pub clip: ClipId,
    pub event: usize,
    /// Number of the event's nearest marker, counted through all laps.
    pub marker: i64,
    pub is_backward: bool,
}

/// Position of an event: its nearest marker, counted through all laps, and the distance from the marker as a share of
/// the way to the next.
#[derive(Clone, Copy)]
struct Beside {
    marker: i64,
    offset: f64,
}

impl Beside {
    fn of(clip: &AnimatedClip, place: Place) -> Self {
        let Phase { marker, share } = clip.markers.phase(place, f64::from(clip.clip.duration()));
        if share < 0.5 {
            Self { marker, offset: share }
        } else {
            Self { marker: marker + 1, offset: share - 1.0 }
        }
    }
}

/// Largest difference of two times that count as equal, seconds; it covers the rounding of a sync group's times.
const MOMENT: f64 = 1e-9;

impl Animator {
    /// Converts passed events to fired ones.
    pub(super) fn fire(&mut self, set: &AnimationSet) {
        let slots = &self.slots;
        let is_there = |group: u8| slots.iter().any(|slot| slot.track.def.sync_group == Some(group));
        self.last_fired.retain(|last| is_there(last.group));
        // Sorts by time; at the same time, events of the leader come first.
        let key = |crossing: &TrackCrossing| {
            let moment = (crossing.seconds / MOMENT) as i64;
            let follows = leader_of(set, slots, crossing) != Some(crossing.slot);
            (moment, follows, crossing.slot, crossing.event, crossing.place.lap)
        };
        self.room.crossings.sort_unstable_by_key(key);
        for i in 0..self.room.crossings.len() {
            let crossing = self.room.crossings[i];
            let track = &self.slots[crossing.slot].track;
            let event = &set.clip(track.def.clip).events[crossing.event];
            let weight = track.weight_in(crossing.seconds);
            let is_its = weight >= event.policy.min_weight
                && match event.policy.fired_by {
                    FiredBy::Every => true,
                    FiredBy::Leader => track.def.sync_group.is_none_or(|group| {
                        heaviest(&self.slots, group, crossing.seconds, |_| true) == Some(crossing.slot)
                    }),
                    FiredBy::OnePerGroup => self.is_first_of_group(set, &crossing),
                };
            if is_its {
                let track = &self.slots[crossing.slot].track;
                let (clip, track, seconds) = (track.def.clip, track.id, crossing.seconds);
                let (event, lap, is_interrupted) = (crossing.event, crossing.place.lap, false);
                self.events.push(FiredEvent { seconds, clip, event, track, weight, lap, is_interrupted });
            }
        }
    }

    /// True if an event that the group's clips share fires now: the leader passes it, or no longer passes it because
    /// another track led at that time. Each such event belongs to one marker in every clip and fires once per passage
    /// of the group. If markers do not distinguish events of one name, the leader's event fires.
    fn is_first_of_group(&mut self, set: &AnimationSet, crossing: &TrackCrossing) -> bool {
        let track = &self.slots[crossing.slot].track;
        let Some(group) = track.def.sync_group else { return true };
        let Some(leader) = leader_of(set, &self.slots, crossing) else { return false };
        let (clip, leading) = (track.def.clip, self.slots[leader].track.def.clip);
        let own = Beside::of(set.clip(clip), crossing.place);
        let beside = |of| same_event(set, (clip, crossing.event), of, own.marker);
        if beside(clip).is_none() {
            return leader == crossing.slot;
        }
        let is_backward = crossing.is_backward;
        let passed = |offset: f64| if is_backward { offset >= own.offset } else { offset <= own.offset };
        if leader != crossing.slot && !beside(leading).is_some_and(passed) {
            return false;
        }
        let fired = LastFired { group, clip, event: crossing.event, marker: own.marker, is_backward };
        let name = &set.clip(clip).events[crossing.event].name;
        let is_same = |last: &&mut LastFired| {
            last.group == group && set.clip(last.clip).events[last.event].name == *name
        };
        match self.last_fired.iter_mut().find(is_same) {
            Some(last) if (last.marker, last.is_backward) == (own.marker, is_backward) => false,
            Some(last) => {
                *last = fired;
                true
            }
            None => {
                self.last_fired.push(fired);
                true
            }
        }
    }
}

/// Offset of an event from its marker in clip `of`, for the event with the same name at the same marker. `None` if
/// there is none, or more than one, or the clips have different numbers of markers.
fn same_event(set: &AnimationSet, event: (ClipId, usize), of: ClipId, marker: i64) -> Option<f64> {
    let name = &set.clip(event.0).events[event.1].name;
    let (clip, count) = (set.clip(of), set.clip(of).markers.times().len());
    if set.clip(event.0).markers.times().len() != count {
        return None;
    }
    let named = clip.events.iter().filter(|other| other.name == *name);
    let mut beside = named
        .map(|other| Beside::of(clip, Place { lap: 0, time: f64::from(other.time) }))
        .filter(|other| (other.marker - marker).rem_euclid(count as i64) == 0);
    let only = beside.next()?;
    beside.next().is_none().then_some(only.offset)
}

/// Returns the heaviest track in the sync group of the crossing's track whose clip has an event of the same name.
fn leader_of(set: &AnimationSet, slots: &[Slot], crossing: &TrackCrossing) -> Option<usize> {
    let track = &slots[crossing.slot].track;
    let name = &set.clip(track.def.clip).events[crossing.event].name;
    let has_one = |other: &Track| set.clip(other.def.clip).events.iter().any(|event| event.name == *name);
    heaviest(slots, track.def.sync_group?, crossing.seconds, has_one)
}

/// Returns the heaviest track of a sync group; of equal ones, the first.
pub(super) fn leader(slots: &[Slot], group: u8) -> Option<usize> {
    heaviest(slots, group, 0.0, |_| true)
}

/// Returns the heaviest track of a sync group that `counts` accepts, by the weights `seconds` from now.
fn heaviest(slots: &[Slot], group: u8, seconds: f64, counts: impl Fn(&Track) -> bool) -> Option<usize> {
    let mut best: Option<(usize, f32)> = None;
    for (i, slot) in slots.iter().enumerate() {
        let track = &slot.track;
        if track.def.sync_group == Some(group) && !track.is_paused && counts(track) {
            let weight = track.weight_in(seconds);
            if best.is_none_or(|(_, heaviest)| weight > heaviest) {
                best = Some((i, weight));
            }
        }
    }
    best.map(|(i, _)| i)
}
