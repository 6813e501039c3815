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
    /// Both play for a while, one becoming lighter, the other heavier. Each joint turns from the old pose to the new one about
    /// one axis by the share of their weights, the way round that is shorter where the crossfade begins, and the same way
    /// for as long as it lasts, wherever the two go.
    Crossfade {
        /// Duration, seconds, 0 or above.
        seconds: f32,
        /// Easing of the weights over that time.
        easing: Easing,
    },
    /// The new one plays alone at once; what the old one was beyond it dies away (see [`Inertia`]).
    Inertial {
        /// Longest duration, seconds, 0 or above; joints that come toward the new motion by themselves take less.
        seconds: f32,
    },
}

/// Plays clips of an [`AnimationSet`] on one character.
///
/// An animator is plain data: which tracks there are, where they are, and the last two poses. It is given the set with
/// each call, the same one always. `update` takes time forward; pose, events and root motion are read afterwards. It
/// allocates nothing once it has had as many tracks and events.
#[derive(Clone, Debug)]
pub struct Animator {
    slots: Vec<Slot>,
    next_id: u64,
    /// Events of tracks that were stopped between updates.
    interrupted: Vec<FiredEvent>,
    /// Last event fired of each sync group and name of an event.
    last_fired: Vec<LastFired>,
    /// Seconds of an inertial transition that begins with the next update.
    awaits_transition: Option<f32>,
    inertia: Inertia,
    root_inertia: RootInertia,
    /// Velocity of the root in the last update that took time.
    root_velocity: RootVelocity,
    pose: Pose,
    /// The pose of the update before, and how long ago that was; 0 if there was none.
    previous: Pose,
    previous_seconds: f32,
    has_pose: bool,
    /// Pose of a clip that comes from outside.
    fed: Option<Fed>,
    events: Vec<FiredEvent>,
    root_motion: Transform,
    room: Room,
}

/// A track, and what it is sampled with.
#[derive(Clone, Debug)]
struct Slot {
    track: Track,
    cursor: Cursor,
    pose: Pose,
    /// Motion of the track's root in this update.
    motion: Transform,
    /// True if it came by a crossfade and what it takes the place of is still there: then it is not blended with the others
    /// of its layer, but follows them.
    is_crossfaded: bool,
    crossfade: Crossfade,
}

/// Memory that is kept from update to update, and holds nothing in between.
#[derive(Clone, Debug)]
struct Room {
    blender: Blender,
    cover: Blender,
    /// Leaves nothing to other poses: for what a crossfade leads away from.
    pure: Blender,
    weights: Weights,
    layers: Vec<BlendLayer<'static>>,
    /// The layers below the one that is blended.
    below: Pose,
    /// Pose before the update of the motion that a transition leads to.
    start: Pose,
    now: Pose,
    crossings: Vec<TrackCrossing>,
    ended: Vec<(usize, f64)>,
    motions: Vec<compose::WeightedMotion>,
    spare: Vec<Slot>,
}

impl Animator {
    /// Plays nothing, in the rest pose.
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

    /// Events passed in the last update, by time; at one time in the order of the tracks.
    pub fn events(&self) -> &[FiredEvent] {
        &self.events
    }

    /// Motion of the root in the last update, seen from where it was before: the mean of the tracks of layer 0 with the
    /// weights that they have after it; model space, file units. Tracks without motion count as standing. Through an inertial
    /// transition its speed changes as smoothly as the joints' do.
    pub fn root_motion(&self) -> Transform {
        self.root_motion
    }

    /// All tracks, in the order in which they were started.
    pub fn tracks(&self) -> impl ExactSizeIterator<Item = &Track> {
        self.slots.iter().map(|slot| &slot.track)
    }

    /// A track; `None` once it has been removed.
    pub fn track(&self, id: TrackId) -> Option<&Track> {
        self.tracks().find(|track| track.id == id)
    }

    /// Starts a track.
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

    /// Starts a track in the place of all others of its layer that are blended, not added.
    ///
    /// # Panics
    /// As [`play`](Self::play), and if the transition's time is negative or not finite.
    pub fn transition(&mut self, set: &AnimationSet, def: &TrackDef, transition: Transition) -> TrackId {
        let (Transition::Crossfade { seconds, .. } | Transition::Inertial { seconds }) = transition;
        assert!(seconds >= 0.0 && seconds.is_finite(), "a transition takes 0 s or longer, not {seconds}");
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

    /// Removes a track at once. Its events with [`on_interrupt`](crate::EventPolicy::on_interrupt) that were still to come
    /// in its lap are fired by the next update. Without effect once it has been removed.
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

    /// Takes a track's weight to another one in `seconds`, and does `then` at its end: the book's timed transition. Takes the
    /// place of a ramp that is under way. Without effect once the track has been removed.
    ///
    /// # Panics
    /// If `weight` or `seconds` is negative or not finite.
    pub fn fade(&mut self, id: TrackId, weight: f32, seconds: f32, easing: Easing, then: EndAction) {
        if let Some(track) = self.track_mut(id) {
            track.fade(weight, seconds, easing, then);
        }
    }

    /// Gives a track another weight at once, and ends its ramp. Without effect once it has been removed.
    ///
    /// # Panics
    /// If `weight` is negative or not finite.
    pub fn set_weight(&mut self, id: TrackId, weight: f32) {
        check_weight(weight);
        if let Some(track) = self.track_mut(id) {
            (track.def.weight, track.ramp) = (weight, None);
        }
    }

    /// Gives a track another speed, clip seconds per second. Without effect once it has been removed.
    ///
    /// # Panics
    /// If `speed` is not finite, or beyond [`MAX_SPEED`](crate::MAX_SPEED).
    pub fn set_speed(&mut self, id: TrackId, speed: f32) {
        check_speed(speed);
        if let Some(track) = self.track_mut(id) {
            track.def.speed = speed;
        }
    }

    /// Lets a track's time stand still, or go on. Without effect once it has been removed.
    pub fn set_paused(&mut self, id: TrackId, is_paused: bool) {
        if let Some(track) = self.track_mut(id) {
            track.is_paused = is_paused;
        }
    }

    /// Puts a track at `time`, clip seconds; no events are fired for what lies between, and one exactly there is still to
    /// come. Of a sync group the others follow if it leads. Without effect once it has been removed.
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

    /// Takes two poses of a motion that was not its own, such as that of bodies, as the last that it had; what that motion is
    /// beyond the tracks then dies away within `transition` seconds from the next update on (see [`Inertia`]). The poses are
    /// of the set's rig, `earlier` is `seconds` before `now`; 0: there is none, and the motion counts as standing. The root
    /// counts as standing, too.
    ///
    /// # Panics
    /// If a pose is of another rig, or a time is negative or not finite.
    pub fn take_over(&mut self, earlier: &Pose, now: &Pose, seconds: f32, transition: f32) {
        for time in [seconds, transition] {
            assert!(time >= 0.0 && time.is_finite(), "a transition takes 0 s or longer, not {time}");
        }
        self.previous.copy_from(earlier);
        self.pose.copy_from(now);
        self.previous_seconds = seconds;
        self.has_pose = true;
        self.inertia.clear();
        (self.root_inertia, self.root_velocity) = (RootInertia::default(), RootVelocity::default());
        self.awaits_transition = Some(transition);
    }

    /// Takes time forward by `seconds`, 0 or above.
    ///
    /// Everything of the tracks is as it would be after any number of shorter updates: what ends within this one ends in
    /// its midst, and an event's weight is that of its own moment. Only who leads a sync group, and at what speed that goes,
    /// is decided once an update.
    ///
    /// # Panics
    /// If `seconds` is negative or not finite.
    pub fn update(&mut self, set: &AnimationSet, seconds: f32) {
        assert!(seconds >= 0.0 && seconds.is_finite(), "an update takes 0 s or longer, not {seconds}");
        self.events.clear();
        self.events.append(&mut self.interrupted);
        if seconds == 0.0 && self.awaits_transition.is_some() {
            // Neither motion has gone on: the pose stays until one does.
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

    /// [`update`](Self::update), and then `on_event` for each event, in order.
    ///
    /// # Panics
    /// As [`update`](Self::update), and where `on_event` does.
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

    /// For another track: its memory alone.
    fn emptied(mut self) -> Self {
        self.crossfade.clear();
        Self { motion: Transform::IDENTITY, is_crossfaded: false, ..self }
    }
}

impl Track {
    fn fade(&mut self, to: f32, seconds: f32, easing: Easing, then: EndAction) {
        check_weight(to);
        assert!(seconds >= 0.0 && seconds.is_finite(), "a ramp takes 0 s or longer, not {seconds}");
        let (from, seconds) = (self.def.weight, f64::from(seconds));
        self.ramp = Some(Ramp { from, to, seconds, elapsed: 0.0, easing, then });
    }
}
