//! Clips with no more keys than a bound on the error asks for.
//!
//! Keys stay where they are and say what they said; those that the straight line between their neighbours tells as well are
//! left out. How far a joint is off adds up along the chain above it, so each channel gets a share of the bound, smaller the
//! farther its joint reaches; then the error is measured in the whole pose, at all times of keys, and the shares are
//! corrected until the bound is used up and kept.

use crate::clip::{Channel, Clip, Interpolation, Property};
use crate::pose::local_to_model;
use crate::rig::{JointIdx, LocalTransform, Rig};
use crate::sample::{SampleCache, Wrap, sample_cached};
use sinew_math::{Affine, Rotation, Vec3, clamp, max, min};

/// How far joints may be from where they were, in the space that [`reduce_keys`] measures in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyBound {
    /// Of a joint's origin, units of that space. 0 keeps every key.
    pub distance: f32,
    /// Of its turn, radians. 0 keeps every key.
    pub angle: f32,
}

impl KeyBound {
    /// Every key stays.
    pub const ALL_KEYS: Self = Self { distance: 0.0, angle: 0.0 };
}

/// How far joints are from where they were, at most: units and radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KeyError {
    /// Of a joint's origin.
    pub distance: f32,
    /// Of its turn.
    pub angle: f32,
}

impl KeyError {
    /// As a share of the bound: above 1 it is broken.
    fn over(self, bound: KeyBound) -> f32 {
        max(self.distance / bound.distance, self.angle / bound.angle)
    }
}

/// A clip with fewer keys.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduced {
    /// The clip; what has one key does not move.
    pub clip: Clip,
    /// The largest error of any joint at any time that the clip had a key at.
    pub error: KeyError,
    /// Keys of all channels, before and after.
    pub keys: [usize; 2],
}

/// Rounds of choosing and measuring, and the share of the bound that is good enough to stop at.
const ROUNDS: usize = 5;
const GOOD_ENOUGH: f32 = 0.8;
/// Share of the bound for each channel to begin with: errors of different joints hardly ever add up.
const FIRST_SHARE: f32 = 0.5;
/// The share aims at this much of the bound.
const AIM: f32 = 0.92;

/// Leaves out the keys of linear channels that are not needed for joints to stay within `bound` in model space, times
/// `root`: the root's unit is the bound's. Other channels keep their keys. The clip lasts as long as before.
///
/// # Panics
/// As [`sample`](crate::sample()), and if the bound is negative or not finite.
pub fn reduce_keys(rig: &Rig, clip: &Clip, root: &Affine, bound: KeyBound) -> Reduced {
    let sound = |x: f32| (0.0..f32::INFINITY).contains(&x);
    assert!(sound(bound.distance) && sound(bound.angle), "a bound is not negative, and finite: {bound:?}");
    let before = count(clip);
    let all = Reduced { clip: clip.clone(), error: KeyError::default(), keys: [before, before] };
    if bound.distance <= 0.0 || bound.angle <= 0.0 {
        return all;
    }
    let mut meter = Meter::new(rig, clip, root);
    let (mut best, mut share): (Option<Reduced>, f32) = (None, FIRST_SHARE);
    for _ in 0..ROUNDS {
        let reduced = meter.thinned(bound, share);
        let error = meter.error(&reduced);
        let used = error.over(bound);
        let keys = count(&reduced);
        if used <= 1.0 && best.as_ref().is_none_or(|best| keys < best.keys[1]) {
            best = Some(Reduced { clip: reduced, error, keys: [before, keys] });
        }
        if (GOOD_ENOUGH..=1.0).contains(&used) {
            break;
        }
        share *= clamp(AIM / max(used, 1e-3), 0.2, 3.0);
    }
    best.unwrap_or(all)
}

fn count(clip: &Clip) -> usize {
    clip.channels.iter().map(|channel| channel.times.len()).sum()
}

/// A clip, and what is needed to choose its keys and to measure what that did.
struct Meter<'a> {
    rig: &'a Rig,
    clip: &'a Clip,
    root: &'a Affine,
    /// All times of keys.
    times: Vec<f32>,
    /// Per joint: how far it is to the farthest that hangs on it at any time, and how much longer a length of its
    /// parent's axes is in the space of the bound.
    reach: Vec<f32>,
    scale: Vec<f32>,
}

impl<'a> Meter<'a> {
    fn new(rig: &'a Rig, clip: &'a Clip, root: &'a Affine) -> Self {
        let joints = rig.joints.len();
        let mut meter =
            Self { rig, clip, root, times: Vec::new(), reach: vec![0.0; joints], scale: vec![0.0; joints] };
        for channel in &clip.channels {
            // Channels of one take share their times.
            if channel.times != meter.times {
                meter.times.extend_from_slice(&channel.times);
                meter.times.sort_by(f32::total_cmp);
                meter.times.dedup();
            }
        }
        let mut bones = vec![0.0; joints];
        let mut poses = Poses::new(rig);
        for &time in &meter.times {
            poses.sample(rig, clip, root, time);
            for (i, joint) in rig.joints.iter().enumerate() {
                let parent = joint.parent.map_or(root, |parent| &poses.model[parent]);
                let bone = poses.model[i].translation - parent.translation;
                bones[i] = max(bones[i], bone.length());
                meter.scale[i] = max(meter.scale[i], longest(parent));
            }
        }
        for (i, joint) in rig.joints.iter().enumerate().rev() {
            if let Some(parent) = joint.parent {
                meter.reach[parent] = max(meter.reach[parent], meter.reach[i] + bones[i]);
            }
        }
        meter
    }

    /// The clip with the keys that channels need which may use up `share` of the bound each.
    fn thinned(&self, bound: KeyBound, share: f32) -> Clip {
        let mut clip = Clip { channels: Vec::with_capacity(self.clip.channels.len()), ..self.clip.clone() };
        clip.channels.clear();
        for channel in &self.clip.channels {
            let tolerance = share * self.tolerance(channel.property, channel.joint, bound);
            clip.channels.push(thinned(channel, tolerance));
        }
        // The end of the last channel is that of the clip, for those who tell its length from its keys.
        let lasts = |channel: &Channel| channel.times.last().is_some_and(|&time| time >= self.clip.duration);
        if !clip.channels.iter().any(lasts)
            && let Some(index) = self.clip.channels.iter().position(lasts)
        {
            let whole = &self.clip.channels[index];
            let last = whole.times.len() - 1;
            clip.channels[index] = with_keys(whole, &if last == 0 { vec![0] } else { vec![0, last] });
        }
        clip
    }

    /// How far a value of a channel may be off that uses up the bound alone: its own units, or radians.
    fn tolerance(&self, property: Property, joint: JointIdx, bound: KeyBound) -> f32 {
        match property {
            Property::Translation => bound.distance / max(self.scale[joint], 1e-12),
            // A scale that is off by as much moves what hangs on the joint as far as a turn would.
            Property::Rotation | Property::Scale => {
                min(bound.angle, bound.distance / max(self.reach[joint], 1e-12))
            }
        }
    }

    fn error(&mut self, reduced: &Clip) -> KeyError {
        let (mut was, mut is) = (Poses::new(self.rig), Poses::new(self.rig));
        let mut worst = KeyError::default();
        for &time in &self.times {
            was.sample(self.rig, self.clip, self.root, time);
            is.sample(self.rig, reduced, self.root, time);
            for (a, b) in was.model.iter().zip(&is.model) {
                worst.distance = max(worst.distance, (a.translation - b.translation).length_squared());
                worst.angle = max(worst.angle, turned_squared(a, b));
            }
        }
        KeyError { distance: worst.distance.sqrt(), angle: worst.angle.sqrt() }
    }
}

/// A pose of a clip, and its buffers.
struct Poses {
    cache: SampleCache,
    local: Vec<LocalTransform>,
    model: Vec<Affine>,
}

impl Poses {
    fn new(rig: &Rig) -> Self {
        let local = vec![LocalTransform::default(); rig.joints.len()];
        Self { cache: SampleCache::default(), local, model: Vec::new() }
    }

    fn sample(&mut self, rig: &Rig, clip: &Clip, root: &Affine, time: f32) {
        sample_cached(clip, rig, time, Wrap::Clamp, &mut self.cache, &mut self.local);
        local_to_model(rig, &self.local, root, &mut self.model);
    }
}

/// Length of the longest axis of a map.
fn longest(map: &Affine) -> f32 {
    let m = &map.linear;
    [m.x_axis, m.y_axis, m.z_axis].into_iter().map(Vec3::length).fold(0.0, max)
}

/// Square of the angle between two maps, as far as they turn, for small angles: of a turn by `a`, the squares of what
/// its three unit axes move by sum up to `8 sin²(a/2)`.
fn turned_squared(a: &Affine, b: &Affine) -> f32 {
    let (a, b) = (&a.linear, &b.linear);
    let axes = [(a.x_axis, b.x_axis), (a.y_axis, b.y_axis), (a.z_axis, b.z_axis)];
    let moved = |(a, b): (Vec3, Vec3)| {
        let lengths = a.length() * b.length();
        if lengths > 0.0 {
            (a * (b.length() / lengths) - b * (a.length() / lengths)).length_squared()
        } else {
            0.0
        }
    };
    0.5 * axes.into_iter().map(moved).sum::<f32>()
}

/// A channel without the keys that lines between the others tell within `tolerance`.
fn thinned(channel: &Channel, tolerance: f32) -> Channel {
    if channel.interpolation != Interpolation::Linear || channel.times.len() < 2 {
        return channel.clone();
    }
    let last = channel.times.len() - 1;
    let line = Line { channel, tolerance };
    if (1..=last).all(|key| line.off(key, channel.value(0)) <= tolerance) {
        return with_keys(channel, &[0]);
    }
    let (mut kept, mut from) = (vec![0], 0);
    while from < last {
        from = line.farthest(from, last);
        kept.push(from);
    }
    with_keys(channel, &kept)
}

/// A channel with those of its keys only. Rotations take the short way from one to the next.
fn with_keys(channel: &Channel, kept: &[usize]) -> Channel {
    let mut values = Vec::with_capacity(kept.len() * channel.property.width());
    let mut last = None;
    for &key in kept {
        let value = channel.value(key);
        match channel.property {
            Property::Rotation => {
                let [x, y, z, w] = value;
                let q = Rotation::from_xyzw(x, y, z, w);
                let q = last.map_or(q, |last| q.toward(last));
                values.extend([q.x, q.y, q.z, q.w]);
                last = Some(q);
            }
            Property::Translation | Property::Scale => values.extend_from_slice(&value[..3]),
        }
    }
    Channel { times: kept.iter().map(|&key| channel.times[key]).collect(), values, ..channel.clone() }
}

impl Channel {
    /// A key of a channel that is no spline.
    fn value(&self, key: usize) -> [f32; 4] {
        let width = self.property.width();
        let mut value = [0.0; 4];
        value[..width].copy_from_slice(&self.values[key * width..][..width]);
        value
    }
}

/// Straight lines from key to key of a channel.
struct Line<'a> {
    channel: &'a Channel,
    tolerance: f32,
}

impl Line<'_> {
    /// The last key to which a line from `from` can go: by ever wider steps until one is too wide, and back by halves.
    fn farthest(&self, from: usize, last: usize) -> usize {
        let (mut good, mut step) = (from + 1, 2);
        let mut bad = loop {
            let to = usize::min(from + step, last);
            if to <= good {
                return good;
            }
            if !self.holds(from, to) {
                break to;
            }
            (good, step) = (to, 2 * step);
        };
        while bad - good > 1 {
            let middle = good + (bad - good) / 2;
            if self.holds(from, middle) { good = middle } else { bad = middle }
        }
        good
    }

    /// Whether all keys between two are near the line between these.
    fn holds(&self, from: usize, to: usize) -> bool {
        let channel = self.channel;
        let (start, span) = (channel.times[from], channel.times[to] - channel.times[from]);
        let (a, b) = (channel.value(from), channel.value(to));
        let turns = channel.property == Property::Rotation;
        let [qa, qb] = [a, b].map(|[x, y, z, w]| Rotation::from_xyzw(x, y, z, w));
        (from + 1..to).all(|key| {
            let t = (channel.times[key] - start) / span;
            let between = if turns {
                let q = qa.slerp(qb, t);
                [q.x, q.y, q.z, q.w]
            } else {
                core::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
            };
            self.off(key, between) <= self.tolerance
        })
    }

    /// How far a key is from a value: units, or radians for small angles.
    fn off(&self, key: usize, value: [f32; 4]) -> f32 {
        let own = self.channel.value(key);
        let squared = |sign: f32| {
            own.iter().zip(&value).fold(0.0, |sum: f32, (a, b)| {
                let d = a - sign * b;
                sum + d * d
            })
        };
        match self.channel.property {
            // A quaternion goes half as far as what it turns, and means the same with all signs turned.
            Property::Rotation => 2.0 * min(squared(1.0), squared(-1.0)).sqrt(),
            Property::Translation | Property::Scale => squared(1.0).sqrt(),
        }
    }
}
