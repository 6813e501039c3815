//! Advances the time of tracks and collects the events they pass.

use super::fire::{TrackCrossing, leader};
use super::{Animator, EndAction, Slot, Track};
use crate::clip::root_motion::MotionTrack;
use crate::event::FiredEvent;
use crate::playback::playhead::{Crossing, LoopMode, Passage, Place};
use crate::playback::sync::match_place;
use crate::set::{AnimatedClip, AnimationSet};
use sinew_math::Transform;

/// Shortest clip that is looped, seconds. A shorter clip would repeat too often in an update, so its time does not
/// advance. Fed poses that are closer together in time give no velocity.
pub(super) const SHORTEST: f64 = 1e-4;

/// Part of an update in which a track plays without interruption.
#[derive(Clone, Copy)]
struct Stretch {
    /// Seconds since the update began.
    start: f64,
    seconds: f64,
}

impl Animator {
    pub(super) fn advance(&mut self, set: &AnimationSet, seconds: f64) {
        self.room.crossings.clear();
        if let Some(fed) = &mut self.fed {
            fed.advance(seconds as f32);
        }
        for slot in &mut self.slots {
            slot.motion = Transform::IDENTITY;
        }
        for i in 0..self.slots.len() {
            let track = self.slots[i].track;
            match track.def.sync_group {
                _ if track.is_paused => {}
                None => advance_alone(set, &mut self.slots[i], i, seconds, &mut self.room.crossings),
                Some(group) if leader(&self.slots, group) == Some(i) => {
                    self.advance_group(set, group, i, seconds);
                }
                Some(_) => {}
            }
        }
        self.fire(set);
        self.end_finished_tracks(set, seconds);
        let order = |event: &FiredEvent| (event.track, event.event, event.lap);
        self.events.sort_by(|a, b| a.seconds.total_cmp(&b.seconds).then(order(a).cmp(&order(b))));
    }

    /// Laps per second of a sync group: the mean of its tracks, weighted so that the blended stride of travelling
    /// clips gives the blended speed: `Σ w s r / Σ w s` with the stride `s` of a lap and its rate `r`.
    fn group_rate(&self, set: &AnimationSet, group: u8, leader: usize) -> f64 {
        let of_group = |slot: &&Slot| slot.track.def.sync_group == Some(group) && !slot.track.is_paused;
        let rate = |track: &Track| f64::from(track.def.speed) / track.playhead.length();
        let stride =
            |track: &Track| set.clip(track.def.clip).motion.as_ref().map_or(0.0, MotionTrack::stride);
        let all_stride = self.slots.iter().filter(of_group).all(|slot| stride(&slot.track) > 0.0);
        let (mut sum, mut total) = (0.0, 0.0);
        for slot in self.slots.iter().filter(of_group) {
            let stride = if all_stride { stride(&slot.track) } else { 1.0 };
            let share = f64::from(slot.track.def.weight * stride);
            sum += share * rate(&slot.track);
            total += share;
        }
        if total > 0.0 { sum / total } else { rate(&self.slots[leader].track) }
    }

    /// Advances a sync group: the leader plays at the group's rate, and the other tracks follow its phase.
    fn advance_group(&mut self, set: &AnimationSet, group: u8, leader: usize, seconds: f64) {
        let speed = self.group_rate(set, group, leader) * self.slots[leader].track.playhead.length();
        let mut ahead = self.slots[leader].track.playhead;
        let from = ahead.place();
        ahead.advance(speed * seconds);
        let clip = set.clip(self.slots[leader].track.def.clip);
        let length = ahead.length();
        for (i, slot) in self.slots.iter_mut().enumerate() {
            let track = &mut slot.track;
            if track.def.sync_group != Some(group) || track.is_paused {
                continue;
            }
            let own = set.clip(track.def.clip);
            let to = if i == leader {
                ahead.place()
            } else {
                let to =
                    match_place(ahead.place(), length, &clip.markers, track.playhead.length(), &own.markers);
                onward(track.playhead.place(), to, speed)
            };
            let own_length = track.playhead.length();
            let start = track.playhead.place();
            slot.motion = moved(own, LoopMode::Loop, start, to, own_length);
            let passage = track.playhead.move_to(to, speed < 0.0);
            // A follower's time equals the leader's at the same phase.
            let moment = |at: Place| {
                let at = if i == leader {
                    at
                } else {
                    match_place(at, own_length, &own.markers, length, &clip.markers)
                };
                let passed = ahead.distance(from, at);
                if speed == 0.0 { 0.0 } else { within(passed / speed, seconds) }
            };
            let ends = stops_after(track);
            for (event, crossing) in crossings(own, passage) {
                let moment = moment(crossing.place);
                if moment <= ends {
                    let (place, seconds) = (crossing.place, moment);
                    let is_backward = speed < 0.0;
                    self.room.crossings.push(TrackCrossing { slot: i, event, place, seconds, is_backward });
                }
            }
        }
    }

    /// Advances ramps, and performs the end action of tracks whose ramp or clip ends within the update.
    fn end_finished_tracks(&mut self, set: &AnimationSet, seconds: f64) {
        self.room.ended.clear();
        for (i, slot) in self.slots.iter_mut().enumerate() {
            let track = &mut slot.track;
            if let Some(mut ramp) = track.ramp {
                let left = ramp.left();
                track.def.weight = track.weight_in(seconds);
                if left > seconds {
                    ramp.elapsed += seconds;
                    track.ramp = Some(ramp);
                } else {
                    track.ramp = None;
                    match ramp.then {
                        EndAction::Hold | EndAction::Restart => {}
                        EndAction::Pause => track.is_paused = true,
                        EndAction::Stop => self.room.ended.push((i, left)),
                    }
                }
            }
            let is_at_end = !track.is_paused && track.playhead.is_at_end(f64::from(track.def.speed));
            match track.def.at_end {
                EndAction::Pause if is_at_end => track.is_paused = true,
                EndAction::Stop if is_at_end && self.room.ended.last().is_none_or(|&(last, _)| last != i) => {
                    self.room.ended.push((i, seconds));
                }
                _ => {}
            }
        }
        while let Some((i, moment)) = self.room.ended.pop() {
            let slot = self.slots.remove(i);
            interrupt(set, &slot.track, moment, &mut self.events);
            self.room.spare.push(slot.emptied());
        }
    }
}

/// Seconds until a ramp that stops or pauses the track ends; infinite without such a ramp.
fn stops_after(track: &Track) -> f64 {
    match track.ramp {
        Some(ramp) if matches!(ramp.then, EndAction::Stop | EndAction::Pause) => ramp.left(),
        _ => f64::INFINITY,
    }
}

/// Advances a track without a leader. A track that restarts continues after the end of its ramp, a repeated clip after
/// its end.
fn advance_alone(
    set: &AnimationSet,
    slot: &mut Slot,
    i: usize,
    seconds: f64,
    crossings: &mut Vec<TrackCrossing>,
) {
    let then = slot.track.ramp.filter(|ramp| ramp.then != EndAction::Hold && ramp.left() <= seconds);
    let first = then.map_or(seconds, |ramp| ramp.left());
    go_on(set, slot, i, Stretch { start: 0.0, seconds: first }, crossings);
    if then.is_some_and(|ramp| ramp.then == EndAction::Restart) {
        slot.track.playhead.seek(f64::from(slot.track.def.start));
        go_on(set, slot, i, Stretch { start: first, seconds: seconds - first }, crossings);
    }
}

fn go_on(
    set: &AnimationSet,
    slot: &mut Slot,
    i: usize,
    mut stretch: Stretch,
    crossings: &mut Vec<TrackCrossing>,
) {
    let speed = f64::from(slot.track.def.speed);
    while let Some(left) = to_end(&slot.track).filter(|&left| left < stretch.seconds) {
        run(set, slot, i, Stretch { seconds: left, ..stretch }, crossings);
        slot.track.playhead.seek(f64::from(slot.track.def.start));
        stretch = Stretch { start: stretch.start + left, seconds: stretch.seconds - left };
        if to_end(&slot.track).is_none_or(|left| left < SHORTEST) || speed == 0.0 {
            break;
        }
    }
    run(set, slot, i, stretch, crossings);
}

/// Seconds until a clip that restarts at its end begins again; `None` if it does not.
fn to_end(track: &Track) -> Option<f64> {
    let (playhead, speed) = (&track.playhead, f64::from(track.def.speed));
    let begins_again =
        track.def.at_end == EndAction::Restart && playhead.mode() == LoopMode::Once && speed != 0.0;
    let time = playhead.place().time;
    begins_again.then(|| if speed > 0.0 { (playhead.length() - time) / speed } else { time / -speed })
}

fn run(set: &AnimationSet, slot: &mut Slot, i: usize, stretch: Stretch, out: &mut Vec<TrackCrossing>) {
    let track = &mut slot.track;
    let (clip, speed, start) = (set.clip(track.def.clip), f64::from(track.def.speed), track.playhead.place());
    let passage = track.playhead.advance(speed * stretch.seconds);
    let playhead = &track.playhead;
    let motion = moved(clip, playhead.mode(), start, playhead.place(), playhead.length());
    slot.motion = slot.motion * motion;
    for (event, crossing) in crossings(clip, passage) {
        let moment = if speed == 0.0 { 0.0 } else { within(crossing.distance / speed, stretch.seconds) };
        let (place, seconds) = (crossing.place, stretch.start + moment);
        out.push(TrackCrossing { slot: i, event, place, seconds, is_backward: speed < 0.0 });
    }
}

/// Clamps a time to the update; rounding may put it just outside.
fn within(moment: f64, seconds: f64) -> f64 {
    let inside = if moment > 0.0 { moment } else { 0.0 };
    if inside < seconds { inside } else { seconds }
}

/// Clamps a step to the direction of play; rounding of phases may reverse a tiny step.
fn onward(from: Place, to: Place, speed: f64) -> Place {
    let is_back = if speed < 0.0 { to > from } else { to < from };
    if is_back { from } else { to }
}

fn crossings(clip: &AnimatedClip, passage: Passage) -> impl Iterator<Item = (usize, Crossing)> {
    let times = clip.events.iter().map(|event| event.time).enumerate();
    times.flat_map(move |(i, time)| passage.crossings(time).map(move |crossing| (i, crossing)))
}

fn moved(clip: &AnimatedClip, mode: LoopMode, from: Place, to: Place, length: f64) -> Transform {
    clip.motion.as_ref().map_or(Transform::IDENTITY, |motion| motion.between(from, to, mode, length))
}

/// Fires the `on_interrupt` events in the rest of a stopped track's lap.
pub(super) fn interrupt(set: &AnimationSet, track: &Track, seconds: f64, out: &mut Vec<FiredEvent>) {
    let clip = track.def.clip;
    let (playhead, is_backward) = (&track.playhead, track.def.speed < 0.0);
    let (place, length) = (playhead.place(), playhead.length());
    let rest = if is_backward { -place.time } else { length - place.time };
    let events = set.clip(clip).events.iter().enumerate();
    for (event, what) in events.filter(|(_, what)| what.policy.on_interrupt) {
        let mut ahead = *playhead;
        if ahead.advance(rest).crossings(what.time).next().is_some() {
            let (track, weight, lap) = (track.id, track.def.weight, place.lap);
            out.push(FiredEvent { seconds, clip, event, track, weight, lap, is_interrupted: true });
        }
    }
}
