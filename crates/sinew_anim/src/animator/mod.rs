//! Animation player of one character: tracks, their weights and times, transitions, events, root motion.

mod advance;
mod compose;
mod copy;
mod crossfade;
mod fed;
mod fire;
mod root_inertia;
mod save;
mod track;

pub use track::{Easing, EndAction, Track, TrackDef, TrackId};

use crate::built::Cursor;
use crate::event::{ClipEvent, FiredEvent};
use crate::playback::inertial::Inertia;
use crate::playback::playhead::Playhead;
use crate::playback::sync;
use crate::pose::{BlendLayer, BlendOptions, Blender, Pose};
use crate::set::AnimationSet;
use crate::tuning::FILL_BELOW;
use crossfade::{Crossfade, Weights};
use fed::Fed;
use fire::{LastFired, TrackCrossing};
use root_inertia::{RootInertia, RootVelocity};
use sinew_math::Transform;
use track::{Ramp, check_speed, check_weight};

/// Transition from one motion to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transition {
    /// Both motions play for a while with opposite ramps. Each joint turns from the old pose to the new one about one
    /// axis by the share of their weights. The direction chosen at the start of the crossfade, the shorter one, is kept
    /// until its end.
    Crossfade {
        /// Duration, seconds, 0 or above.
        seconds: f32,
        /// Easing of the weights over `seconds`.
        easing: Easing,
    },
    /// Only the new motion plays from now on; the difference from the old one decays (see [`Inertia`]).
    Inertial {
        /// Longest duration, seconds, 0 or above; joints that already move toward the new motion take less.
        seconds: f32,
    },
}

/// Plays clips of an [`AnimationSet`] on one character.
///
/// An animator is plain data: its tracks, their times, and the last two poses. Pass the same set to every call.
/// `update` advances time; then read pose, events and root motion. `update` allocates only for more tracks or events
/// than before.
#[derive(Clone, Debug)]
pub struct Animator {
    slots: Vec<Slot>,
    next_id: u64,
    /// Events of tracks that were stopped between updates.
    interrupted: Vec<FiredEvent>,
    /// Last event fired, by sync group and event name.
    last_fired: Vec<LastFired>,
    /// Duration of an inertial transition that starts with the next update, seconds.
    awaits_transition: Option<f32>,
    inertia: Inertia,
    root_inertia: RootInertia,
    /// Velocity of the root in the last update with a positive duration.
    root_velocity: RootVelocity,
    pose: Pose,
    /// Pose of the previous update, and its age in seconds; 0 if there was none.
    previous: Pose,
    previous_seconds: f32,
    has_pose: bool,
    /// Pose of a clip that the user feeds.
    fed: Option<Fed>,
    events: Vec<FiredEvent>,
    root_motion: Transform,
    room: Room,
}

/// A track with its sampling state.
#[derive(Clone, Debug)]
struct Slot {
    track: Track,
    cursor: Cursor,
    pose: Pose,
    /// Motion of the track's root in this update.
    motion: Transform,
    /// True if a crossfade started the track and replaced tracks still play; the track is then applied on top of the
    /// layer's blend.
    is_crossfaded: bool,
    crossfade: Crossfade,
}

/// Buffers kept between updates, empty in between.
#[derive(Clone, Debug)]
struct Room {
    blender: Blender,
    cover: Blender,
    /// Blend options without a rest-pose share, for tracks that a crossfade replaces.
    pure: Blender,
    weights: Weights,
    layers: Vec<BlendLayer<'static>>,
    /// The blend of the layers below.
    below: Pose,
    /// Pose of the new motion before the update, for a transition.
    start: Pose,
    now: Pose,
    crossings: Vec<TrackCrossing>,
    ended: Vec<(usize, f64)>,
    motions: Vec<compose::WeightedMotion>,
    spare: Vec<Slot>,
}

impl Animator {
    /// Creates an animator without tracks, in the rest pose.
    pub fn new(set: &AnimationSet) -> Self {
        let rest = set.skeleton().rest();
        let covering = BlendOptions { fill_below: 1.0, ..BlendOptions::default() };
        let room = Room {
            blender: Blender::new(BlendOptions { fill_below: FILL_BELOW, ..BlendOptions::default() }),
            cover: Blender::new(covering),
            pure: Blender::new(BlendOptions::default()),
            weights: Weights::default(),
            layers: Vec::new(),
            below: rest.clone(),
            start: rest.clone(),
            now: rest.clone(),
            crossings: Vec::new(),
            ended: Vec::new(),
            motions: Vec::new(),
            spare: Vec::new(),
        };
        Self {
            slots: Vec::new(),
            next_id: 0,
            interrupted: Vec::new(),
            last_fired: Vec::new(),
            awaits_transition: None,
            inertia: Inertia::default(),
            root_inertia: RootInertia::default(),
            root_velocity: RootVelocity::default(),
            pose: rest.clone(),
            previous: rest.clone(),
            previous_seconds: 0.0,
            has_pose: false,
            fed: None,
            events: Vec::new(),
            root_motion: Transform::IDENTITY,
            room,
        }
    }

    /// Local transforms of all joints after the last update.
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// Events passed in the last update, by time; simultaneous ones are in the order of the tracks.
    pub fn events(&self) -> &[FiredEvent] {
        &self.events
    }

    /// Motion of the root in the last update, relative to its previous frame; model space, file units. It is the mean
    /// of the tracks of layer 0, weighted after the update. A track without motion counts as zero. During an inertial
    /// transition the root's velocity changes as smoothly as the joints'.
    pub fn root_motion(&self) -> Transform {
        self.root_motion
    }

    /// All tracks, in the order in which they were started.
    pub fn tracks(&self) -> impl ExactSizeIterator<Item = &Track> {
        self.slots.iter().map(|slot| &slot.track)
    }

    /// Returns a track; `None` after its removal.
    pub fn track(&self, id: TrackId) -> Option<&Track> {
        self.tracks().find(|track| track.id == id)
    }

    /// Starts a track and returns its id.
    ///
    /// # Panics
    /// If a number of `def` is not finite, the weight is negative, a sync group is joined without looping, or clip or mask
    /// are not of the set.
    pub fn play(&mut self, set: &AnimationSet, def: &TrackDef) -> TrackId {
        def.check();
        assert!(def.mask.is_none_or(|mask| set.has_mask(mask.0).is_some()), "a mask of the set");
        let clip = set.clip(def.clip);
        let mut playhead = Playhead::new(def.loop_mode, clip.clip.duration(), f64::from(def.start));
        if let Some(leader) = def.sync_group.and_then(|group| fire::leader(&self.slots, group)) {
            let leader = &self.slots[leader].track;
            let markers = &set.clip(leader.def.clip).markers;
            let place = sync::follow(&leader.playhead, markers, &playhead, &clip.markers);
            playhead =
                Playhead::restored(def.loop_mode, clip.clip.duration(), place, true).unwrap_or(playhead);
        }
        let id = TrackId(self.next_id);
        self.next_id += 1;
        let track = Track { id, def: *def, playhead, ramp: None, is_paused: false };
        let slot = self.room.spare.pop().unwrap_or_else(|| Slot::new(track, set.skeleton().len()));
        self.slots.push(Slot { track, ..slot });
        id
    }

    /// Starts a track that replaces all blended (not additive) tracks of its layer; returns the new track's id.
    ///
    /// # Panics
    /// As [`play`](Self::play), and if the transition's time is negative or not finite.
    pub fn transition(&mut self, set: &AnimationSet, def: &TrackDef, transition: Transition) -> TrackId {
        let (Transition::Crossfade { seconds, .. } | Transition::Inertial { seconds }) = transition;
        assert!(
            seconds >= 0.0 && seconds.is_finite(),
            "the duration of a transition must be finite and at least 0, not {seconds}"
        );
        let is_replaced =
            |slot: &Slot| slot.track.def.layer == def.layer && !set.clip(slot.track.def.clip).is_difference();
        match transition {
            Transition::Crossfade { seconds, easing } => {
                let mut is_crossfaded = false;
                for slot in self.slots.iter_mut().filter(|slot| is_replaced(slot)) {
                    slot.track.fade(0.0, seconds, easing, EndAction::Stop);
                    is_crossfaded = true;
                }
                let id = self.play(set, &TrackDef { weight: 0.0, ..*def });
                self.fade(id, def.weight, seconds, easing, EndAction::Hold);
                if let Some(slot) = self.slots.last_mut() {
                    slot.is_crossfaded = is_crossfaded && !set.clip(def.clip).is_difference();
                }
                id
            }
            Transition::Inertial { seconds } => {
                let id = self.play(set, def);
                let stopped = |slot: &Slot| slot.track.id != id && is_replaced(slot);
                while let Some(i) = self.slots.iter().position(stopped) {
                    self.remove(set, i);
                }
                self.awaits_transition = Some(seconds);
                id
            }
        }
    }

    /// Removes a track immediately. The next update fires the remaining
    /// [`on_interrupt`](crate::EventPolicy::on_interrupt) events of its lap. Does nothing if the track was removed.
    pub fn stop(&mut self, set: &AnimationSet, id: TrackId) {
        if let Some(i) = self.slots.iter().position(|slot| slot.track.id == id) {
            self.remove(set, i);
        }
    }

    fn remove(&mut self, set: &AnimationSet, i: usize) {
        let slot = self.slots.remove(i);
        advance::interrupt(set, &slot.track, 0.0, &mut self.interrupted);
        self.room.spare.push(slot.emptied());
    }

    /// Ramps a track's weight to another value in `seconds`, then performs `then`. Replaces a running ramp. Does
    /// nothing if the track was removed.
    ///
    /// # Panics
    /// If `weight` or `seconds` is negative or not finite.
    pub fn fade(&mut self, id: TrackId, weight: f32, seconds: f32, easing: Easing, then: EndAction) {
        if let Some(track) = self.track_mut(id) {
            track.fade(weight, seconds, easing, then);
        }
    }

    /// Sets a track's weight immediately and ends its ramp. Does nothing if the track was removed.
    ///
    /// # Panics
    /// If `weight` is negative or not finite.
    pub fn set_weight(&mut self, id: TrackId, weight: f32) {
        check_weight(weight);
        if let Some(track) = self.track_mut(id) {
            (track.def.weight, track.ramp) = (weight, None);
        }
    }

    /// Sets a track's speed, clip seconds per second. Does nothing if the track was removed.
    ///
    /// # Panics
    /// If `speed` is not finite, or beyond [`MAX_SPEED`](crate::MAX_SPEED).
    pub fn set_speed(&mut self, id: TrackId, speed: f32) {
        check_speed(speed);
        if let Some(track) = self.track_mut(id) {
            track.def.speed = speed;
        }
    }

    /// Pauses or resumes a track. Does nothing if the track was removed.
    pub fn set_paused(&mut self, id: TrackId, is_paused: bool) {
        if let Some(track) = self.track_mut(id) {
            track.is_paused = is_paused;
        }
    }

    /// Moves a track to `time`, clip seconds, without firing events in between; an event exactly at `time` has not been
    /// passed yet. If the track leads a sync group, the other tracks of the group follow. Does nothing if the track was
    /// removed.
    ///
    /// # Panics
    /// If `time` is not finite.
    pub fn seek(&mut self, id: TrackId, time: f32) {
        let Some(track) = self.track_mut(id) else { return };
        track.playhead.seek(f64::from(time));
        if let Some(group) = track.def.sync_group {
            self.last_fired.retain(|last| last.group != group);
        }
    }

    fn track_mut(&mut self, id: TrackId) -> Option<&mut Track> {
        self.slots.iter_mut().map(|slot| &mut slot.track).find(|track| track.id == id)
    }

    /// Uses two poses from outside, such as those of bodies, as the animator's last motion. Their difference to the
    /// tracks decays within `transition` seconds from the next update on (see [`Inertia`]). The poses are of the set's
    /// rig; `earlier` is `seconds` before `now`. If `seconds` is 0, the initial velocity is zero. The initial velocity
    /// of the root is zero, too.
    ///
    /// # Panics
    /// If a pose is of another rig, or a time is negative or not finite.
    pub fn take_over(&mut self, earlier: &Pose, now: &Pose, seconds: f32, transition: f32) {
        for time in [seconds, transition] {
            assert!(
                time >= 0.0 && time.is_finite(),
                "the duration of a transition must be finite and at least 0, not {time}"
            );
        }
        self.previous.copy_from(earlier);
        self.pose.copy_from(now);
        self.previous_seconds = seconds;
        self.has_pose = true;
        self.inertia.clear();
        (self.root_inertia, self.root_velocity) = (RootInertia::default(), RootVelocity::default());
        self.awaits_transition = Some(transition);
    }

    /// Advances time by `seconds`, 0 or above.
    ///
    /// The result equals any number of shorter updates: a ramp or clip that ends within this update ends at its exact
    /// time, and an event has the weight at its own time. Only the leader of a sync group and its speed are chosen once
    /// per update.
    ///
    /// # Panics
    /// If `seconds` is negative or not finite.
    pub fn update(&mut self, set: &AnimationSet, seconds: f32) {
        assert!(
            seconds >= 0.0 && seconds.is_finite(),
            "seconds must be finite and at least 0, not {seconds}"
        );
        self.events.clear();
        self.events.append(&mut self.interrupted);
        if seconds == 0.0 && self.awaits_transition.is_some() {
            // Neither motion has advanced, so the pose stays.
            self.root_motion = Transform::IDENTITY;
            return;
        }
        let begins = self.awaits_transition.take().filter(|_| self.has_pose);
        if begins.is_some() {
            let mut start = core::mem::take(&mut self.room.start);
            self.compose(set, &mut start);
            self.room.start = start;
        }
        self.advance(set, f64::from(seconds));
        self.settle_crossfades(set);
        self.move_root(seconds, begins);
        self.finish_pose(set, seconds, begins);
    }

    /// Calls [`update`](Self::update), then `on_event` for each event, in order of time.
    ///
    /// # Panics
    /// As [`update`](Self::update), and if `on_event` panics.
    pub fn update_with(
        &mut self,
        set: &AnimationSet,
        seconds: f32,
        mut on_event: impl FnMut(&FiredEvent, &ClipEvent),
    ) {
        self.update(set, seconds);
        self.events.iter().for_each(|fired| on_event(fired, set.event(fired)));
    }
}

impl Slot {
    fn new(track: Track, joints: usize) -> Self {
        Self {
            track,
            cursor: Cursor::new(),
            pose: Pose::new(joints),
            motion: Transform::IDENTITY,
            is_crossfaded: false,
            crossfade: Crossfade::default(),
        }
    }

    /// Resets a slot and keeps its memory for another track.
    fn emptied(mut self) -> Self {
        self.crossfade.clear();
        Self { motion: Transform::IDENTITY, is_crossfaded: false, ..self }
    }
}

impl Track {
    fn fade(&mut self, to: f32, seconds: f32, easing: Easing, then: EndAction) {
        check_weight(to);
        assert!(
            seconds >= 0.0 && seconds.is_finite(),
            "the duration of a ramp must be finite and at least 0, not {seconds}"
        );
        let (from, seconds) = (self.def.weight, f64::from(seconds));
        self.ramp = Some(Ramp { from, to, seconds, elapsed: 0.0, easing, then });
    }
}
