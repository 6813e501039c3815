//! Saves the state of an animator as bytes, and restores it exactly.

use super::{Animator, Easing, EndAction, Slot, Track, TrackDef, TrackId};
use crate::animator::crossfade::Crossfade;
use crate::animator::fed::Fed;
use crate::animator::fire::LastFired;
use crate::animator::root_inertia::{RootInertia, RootVelocity};
use crate::animator::track::{Ramp, is_speed};
use crate::event::FiredEvent;
use crate::playback::inertial::Inertia;
use crate::playback::playhead::{LoopMode, Place, Playhead};
use crate::pose::Pose;
use crate::rig::LocalTransform;
use crate::set::{AnimationSet, ClipId};
use sinew_math::{ReadError, Reader, Writer};

/// Magic bytes and format version.
const HEADER: &[u8; 8] = b"SNWANIM\x02";

/// Largest difference of laps within a sync group: a track that was paused catches up in one update, and fires all
/// events that it passes.
const FARTHEST: u64 = 10_000;

impl Animator {
    /// Writes all state that affects later updates; the events and root motion of the last update are not included.
    pub fn save(&self, set: &AnimationSet, out: &mut Writer) {
        out.raw(HEADER);
        out.u64(set.fingerprint());
        out.u64(self.next_id);
        out.count(self.slots.len());
        for slot in &self.slots {
            write_track(&slot.track, out);
            out.bool(slot.is_crossfaded);
            slot.crossfade.save(out);
        }
        out.count(self.interrupted.len());
        self.interrupted.iter().for_each(|event| write_event(event, out));
        out.count(self.last_fired.len());
        self.last_fired.iter().for_each(|last| write_last_fired(last, out));
        write_option(self.awaits_transition, out, |&seconds, out| out.f32(seconds));
        self.inertia.save(out);
        self.root_inertia.save(out);
        self.root_velocity.save(out);
        out.u8(u8::from(self.has_pose) | u8::from(self.fed.is_some()) << 1);
        out.f32(self.previous_seconds);
        write_pose(&self.pose, out);
        write_pose(&self.previous, out);
        if let Some(fed) = &self.fed {
            fed.save(out);
        }
    }

    /// Reads an animator that [`save`](Self::save) wrote, for the same set. The animator continues with the same
    /// bits.
    ///
    /// # Errors
    /// If the bytes are of another set, end too early, or hold an impossible state. Never panics.
    pub fn load(set: &AnimationSet, bytes: &mut Reader<'_>) -> Result<Self, ReadError> {
        if bytes.raw(HEADER.len())? != HEADER {
            return Err(bytes.error("not the state of an animator, or of another version"));
        }
        if bytes.u64()? != set.fingerprint() {
            return Err(bytes.error("the state belongs to another set of clips"));
        }
        let mut animator = Self::new(set);
        animator.next_id = bytes.u64()?;
        let mut last = None;
        for _ in 0..bytes.count(53)? {
            let track = read_track(set, bytes)?;
            if track.id.0 >= animator.next_id || last.is_some_and(|last| track.id <= last) {
                return Err(bytes.error("a track's id is out of order"));
            }
            last = Some(track.id);
            let joints = set.skeleton().len();
            let (is_crossfaded, crossfade) = (bytes.bool()?, Crossfade::load(bytes, joints)?);
            animator.slots.push(Slot { is_crossfaded, crossfade, ..Slot::new(track, joints) });
        }
        for _ in 0..bytes.count(37)? {
            animator.interrupted.push(read_event(set, bytes)?);
        }
        if !are_together(&animator.slots) {
            return Err(bytes.error("a track is far from its sync group"));
        }
        for _ in 0..bytes.count(18)? {
            animator.last_fired.push(read_last_fired(set, bytes)?);
        }
        animator.awaits_transition = read_option(bytes, |bytes| at_least_zero(bytes, Reader::f32))?;
        animator.inertia = Inertia::load(bytes, set.skeleton().len())?;
        animator.root_inertia = RootInertia::load(bytes)?;
        animator.root_velocity = RootVelocity::load(bytes)?;
        let has = bytes.u8()?;
        if has > 3 {
            return Err(bytes.error("an unknown kind"));
        }
        animator.has_pose = has & 1 != 0;
        animator.previous_seconds = at_least_zero(bytes, Reader::f32)?;
        read_pose(&mut animator.pose, bytes)?;
        read_pose(&mut animator.previous, bytes)?;
        if has & 2 != 0 {
            animator.fed = Some(Fed::load(set, bytes)?);
        }
        Ok(animator)
    }
}

impl Fed {
    fn save(&self, out: &mut Writer) {
        out.u32(self.clip.0);
        write_pose(&self.now, out);
        write_pose(&self.before, out);
        out.f32(self.seconds);
        out.f32(self.age);
        out.bool(self.is_new);
    }

    fn load(set: &AnimationSet, bytes: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut fed = Self::new(read_clip(set, bytes)?, set.skeleton().rest());
        read_pose(&mut fed.now, bytes)?;
        read_pose(&mut fed.before, bytes)?;
        fed.seconds = at_least_zero(bytes, Reader::f32)?;
        fed.age = at_least_zero(bytes, Reader::f32)?;
        fed.is_new = bytes.bool()?;
        Ok(fed)
    }
}

/// True if the tracks of each sync group are at most [`FARTHEST`] laps from each other.
fn are_together(slots: &[Slot]) -> bool {
    slots.iter().enumerate().all(|(i, a)| {
        slots[..i].iter().all(|b| {
            let laps = [a, b].map(|slot| slot.track.playhead.lap());
            let is_one_group = a.track.def.sync_group == b.track.def.sync_group;
            a.track.def.sync_group.is_none() || !is_one_group || laps[0].abs_diff(laps[1]) <= FARTHEST
        })
    })
}

fn write_track(track: &Track, out: &mut Writer) {
    let def = &track.def;
    out.u64(track.id.0);
    out.u32(def.clip.0);
    out.f32(def.weight);
    out.f32(def.speed);
    out.f32(def.start);
    out.u8(def.loop_mode as u8);
    out.u8(def.at_end as u8);
    out.u8(def.layer);
    write_option(def.mask, out, |mask, out| out.u32(mask.0));
    write_option(def.sync_group, out, |&group, out| out.u8(group));
    let place = track.playhead.place();
    out.u64(place.lap as u64);
    out.u64(place.time.to_bits());
    out.bool(track.playhead.is_fresh());
    out.bool(track.is_paused);
    write_option(track.ramp, out, |ramp, out| {
        out.f32(ramp.from);
        out.f32(ramp.to);
        out.u64(ramp.seconds.to_bits());
        out.u64(ramp.elapsed.to_bits());
        out.u8(ramp.easing as u8);
        out.u8(ramp.then as u8);
    });
}

fn read_track(set: &AnimationSet, bytes: &mut Reader<'_>) -> Result<Track, ReadError> {
    let id = TrackId(bytes.u64()?);
    let clip = read_clip(set, bytes)?;
    let weight = at_least_zero(bytes, Reader::f32)?;
    let (speed, start) = (finite(bytes)?, finite(bytes)?);
    if !is_speed(speed) {
        return Err(bytes.error("a track is too fast"));
    }
    let loop_mode = one_of(bytes, [LoopMode::Loop, LoopMode::PingPong, LoopMode::Once])?;
    let at_end = one_of(bytes, END_ACTIONS)?;
    let layer = bytes.u8()?;
    let mask = read_option(bytes, |bytes| {
        let mask = bytes.u32()?;
        set.has_mask(mask).ok_or_else(|| bytes.error("an unknown mask"))
    })?;
    let sync_group = read_option(bytes, Reader::u8)?;
    if sync_group.is_some() && loop_mode != LoopMode::Loop {
        return Err(bytes.error("a track of a sync group does not loop"));
    }
    let def = TrackDef { clip, weight, speed, start, loop_mode, at_end, layer, mask, sync_group };
    let place = Place { lap: bytes.u64()? as i64, time: f64::from_bits(bytes.u64()?) };
    let is_fresh = bytes.bool()?;
    let length = set.clip(clip).clip.duration();
    let Some(playhead) = Playhead::restored(loop_mode, length, place, is_fresh) else {
        return Err(bytes.error("a track is outside of its clip"));
    };
    let is_paused = bytes.bool()?;
    let ramp = read_option(bytes, read_ramp)?;
    Ok(Track { id, def, playhead, ramp, is_paused })
}

fn read_ramp(bytes: &mut Reader<'_>) -> Result<Ramp, ReadError> {
    let (from, to) = (at_least_zero(bytes, Reader::f32)?, at_least_zero(bytes, Reader::f32)?);
    let (seconds, elapsed) = (at_least_zero(bytes, read_f64)?, at_least_zero(bytes, read_f64)?);
    let easing = one_of(bytes, [Easing::Linear, Easing::Smooth, Easing::In, Easing::Out])?;
    if elapsed > seconds {
        return Err(bytes.error("a ramp is past its end"));
    }
    Ok(Ramp { from, to, seconds, elapsed, easing, then: one_of(bytes, END_ACTIONS)? })
}

fn write_event(event: &FiredEvent, out: &mut Writer) {
    out.u64(event.seconds.to_bits());
    out.u32(event.clip.0);
    out.count(event.event);
    out.u64(event.track.0);
    out.f32(event.weight);
    out.u64(event.lap as u64);
    out.bool(event.is_interrupted);
}

fn read_event(set: &AnimationSet, bytes: &mut Reader<'_>) -> Result<FiredEvent, ReadError> {
    let seconds = at_least_zero(bytes, read_f64)?;
    let clip = read_clip(set, bytes)?;
    let event = read_event_of(set, clip, bytes)?;
    let (track, weight) = (TrackId(bytes.u64()?), at_least_zero(bytes, Reader::f32)?);
    let (lap, is_interrupted) = (bytes.u64()? as i64, bytes.bool()?);
    Ok(FiredEvent { seconds, clip, event, track, weight, lap, is_interrupted })
}

fn write_last_fired(last: &LastFired, out: &mut Writer) {
    out.u8(last.group);
    out.u32(last.clip.0);
    out.count(last.event);
    out.u64(last.marker as u64);
    out.bool(last.is_backward);
}

fn read_last_fired(set: &AnimationSet, bytes: &mut Reader<'_>) -> Result<LastFired, ReadError> {
    let (group, clip) = (bytes.u8()?, read_clip(set, bytes)?);
    let event = read_event_of(set, clip, bytes)?;
    Ok(LastFired { group, clip, event, marker: bytes.u64()? as i64, is_backward: bytes.bool()? })
}

fn read_event_of(set: &AnimationSet, clip: ClipId, bytes: &mut Reader<'_>) -> Result<usize, ReadError> {
    let event = bytes.u32()? as usize;
    let is_there = event < set.clip(clip).events.len();
    if is_there { Ok(event) } else { Err(bytes.error("an unknown event")) }
}

fn write_pose(pose: &Pose, out: &mut Writer) {
    for local in pose.iter() {
        out.vec3(local.translation);
        out.rotation(local.rotation);
        out.vec3(local.scale);
    }
}

fn read_pose(pose: &mut Pose, bytes: &mut Reader<'_>) -> Result<(), ReadError> {
    for joint in 0..pose.len() {
        let (translation, rotation, scale) = (bytes.vec3()?, bytes.rotation()?, bytes.vec3()?);
        let length = rotation.length();
        if !(translation.is_finite() && scale.is_finite() && length > 0.99 && length < 1.01) {
            return Err(bytes.error("a joint's transform is not finite, or turns by more than a rotation"));
        }
        pose.set(joint, &LocalTransform { translation, rotation, scale });
    }
    Ok(())
}

const END_ACTIONS: [EndAction; 4] = [EndAction::Hold, EndAction::Stop, EndAction::Pause, EndAction::Restart];

fn one_of<T: Copy, const N: usize>(bytes: &mut Reader<'_>, all: [T; N]) -> Result<T, ReadError> {
    let number = usize::from(bytes.u8()?);
    all.get(number).copied().ok_or_else(|| bytes.error("an unknown kind"))
}

fn read_clip(set: &AnimationSet, bytes: &mut Reader<'_>) -> Result<ClipId, ReadError> {
    let clip = bytes.u32()?;
    set.has_clip(clip).ok_or_else(|| bytes.error("an unknown clip"))
}

fn read_f64(bytes: &mut Reader<'_>) -> Result<f64, ReadError> {
    Ok(f64::from_bits(bytes.u64()?))
}

fn finite(bytes: &mut Reader<'_>) -> Result<f32, ReadError> {
    let number = bytes.f32()?;
    if number.is_finite() { Ok(number) } else { Err(bytes.error("a number is not finite")) }
}

fn at_least_zero<'a, T: Copy + Into<f64>>(
    bytes: &mut Reader<'a>,
    read: impl Fn(&mut Reader<'a>) -> Result<T, ReadError>,
) -> Result<T, ReadError> {
    let number = read(bytes)?;
    let value: f64 = number.into();
    if value >= 0.0 && value.is_finite() {
        Ok(number)
    } else {
        Err(bytes.error("a number is negative or not finite"))
    }
}

fn write_option<T>(value: Option<T>, out: &mut Writer, write: impl Fn(&T, &mut Writer)) {
    out.bool(value.is_some());
    if let Some(value) = value {
        write(&value, out);
    }
}

fn read_option<'a, T>(
    bytes: &mut Reader<'a>,
    read: impl Fn(&mut Reader<'a>) -> Result<T, ReadError>,
) -> Result<Option<T>, ReadError> {
    if bytes.bool()? { read(bytes).map(Some) } else { Ok(None) }
}
