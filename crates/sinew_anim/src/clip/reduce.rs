//! Removes keys within a bound on the error.
//!
//! Remaining keys keep time and value; a key is dropped if the straight line between its neighbours reproduces it. The
//! errors of joints add up along a chain, so each channel gets a share of the bound, smaller for joints with a longer
//! reach. The error of the whole pose is then measured at all key times, and the shares are adjusted until the error is
//! close to the bound without exceeding it.

use crate::clip::sample::{channel_at, write_property};
use crate::clip::{Channel, Clip, Interpolation, Property};
use crate::pose::rest_pose;
use crate::rig::{JointIdx, LocalTransform, Rig};
use crate::tuning::{CHANNEL_SHARE, REDUCED_ENOUGH, REDUCTION_AIM};
use sinew_math::{Affine, Rotation, Vec3, clamp, max, min};

/// Bound of the difference between a clip with fewer keys and the original, in the space in which [`reduce_keys`]
/// measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyBound {
    /// Distance of a joint's origin from the original, in units of that space. 0 keeps every key.
    pub distance: f32,
    /// Angle of a joint's rotation from the original one, radians. 0 keeps every key.
    pub angle: f32,
}

impl KeyBound {
    /// Bound that keeps every key.
    pub const ALL_KEYS: Self = Self { distance: 0.0, angle: 0.0 };
}

/// Largest difference between a clip with fewer keys and the original: units of the bound's space, and radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KeyError {
    /// Distance of a joint's origin from its original position.
    pub distance: f32,
    /// Angle of a joint's rotation from the original one.
    pub angle: f32,
}

impl KeyError {
    /// Ratio to the bound; above 1 the bound is violated.
    fn over(self, bound: KeyBound) -> f32 {
        max(self.distance / bound.distance, self.angle / bound.angle)
    }
}

/// A clip with fewer keys.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduced {
    /// The reduced clip; constant channels have one key.
    pub clip: Clip,
    /// The largest error of any joint at any of the clip's key times.
    pub error: KeyError,
    /// Number of keys of all channels, before and after.
    pub keys: [usize; 2],
}

/// Number of rounds of choosing and measuring, and the share of the bound at which the search stops.
const ROUNDS: usize = 4;

/// Drops keys of linear channels such that joints stay within `bound` in model space, transformed by `root`; the bound
/// is in the unit of `root`. Other channels keep their keys, and the clip its duration. All values must be finite.
///
/// # Panics
/// As [`sample`](crate::clip::sample::sample()), and if the bound is negative or not finite.
pub fn reduce_keys(rig: &Rig, clip: &Clip, root: &Affine, bound: KeyBound) -> Reduced {
    let sound = |x: f32| (0.0..f32::INFINITY).contains(&x);
    assert!(sound(bound.distance) && sound(bound.angle), "a bound must be finite and at least 0: {bound:?}");
    let before = count(clip);
    let all = || Reduced { clip: clip.clone(), error: KeyError::default(), keys: [before, before] };
    if bound.distance <= 0.0 || bound.angle <= 0.0 || rig.joints.is_empty() || moves_twice(rig, clip) {
        return all();
    }
    let meter = Meter::new(rig, clip, root);
    let (mut best, mut share): (Option<Reduced>, f32) = (None, CHANNEL_SHARE);
    // Largest share that kept the bound, and smallest share that violated it.
    let (mut kept, mut broke) = (0.0, f32::INFINITY);
    for _ in 0..ROUNDS {
        let reduced = meter.thinned(bound, share);
        let error = meter.error(&reduced);
        let used = error.over(bound);
        let keys = count(&reduced);
        if used <= 1.0 && best.as_ref().is_none_or(|best| keys < best.keys[1]) {
            best = Some(Reduced { clip: reduced, error, keys: [before, keys] });
        }
        if (REDUCED_ENOUGH..=1.0).contains(&used) {
            break;
        }
        if used <= 1.0 {
            kept = share;
        } else {
            broke = share;
        }
        let next = share * clamp(REDUCTION_AIM / max(used, 1e-3), 0.2, 3.0);
        share = if kept < next && next < broke { next } else { 0.5 * (kept + broke) };
    }
    best.unwrap_or_else(all)
}

fn count(clip: &Clip) -> usize {
    clip.channels.iter().map(|channel| channel.times.len()).sum()
}

/// True if two channels move the same property; they then depend on each other, and no key is dropped.
fn moves_twice(rig: &Rig, clip: &Clip) -> bool {
    let mut moved = vec![[false; 3]; rig.joints.len()];
    clip.channels.iter().any(|c| core::mem::replace(&mut moved[c.joint][c.property as usize], true))
}

/// A clip with the data to choose its keys and to measure the error.
struct Meter<'a> {
    rig: &'a Rig,
    /// The motion without repeated keys: of a run of equal keys only the first and the last remain.
    clip: Clip,
    root: &'a Affine,
    /// All key times.
    times: Vec<f32>,
    /// Model transforms of the joints at these times, including `root`; one time after the other.
    model: Vec<Affine>,
    /// True where a joint moved since the previous time.
    moved: Vec<bool>,
    /// For each joint: the largest distance of a descendant at any key time, and the scale from its parent's axes to
    /// the space of the bound.
    reach: Vec<f32>,
    scale: Vec<f32>,
}

impl<'a> Meter<'a> {
    fn new(rig: &'a Rig, clip: &Clip, root: &'a Affine) -> Self {
        let joints = rig.joints.len();
        let mut times: Vec<f32> = Vec::new();
        for channel in &clip.channels {
            // Channels of one take share their times.
            if channel.times != times {
                times.extend_from_slice(&channel.times);
                times.sort_by(f32::total_cmp);
                times.dedup();
            }
        }
        let channels = clip.channels.iter().map(without_repeats).collect();
        let clip = Clip { name: clip.name.clone(), duration: clip.duration, channels };
        let size = times.len() * joints;
        let (model, moved) = (Vec::with_capacity(size), Vec::with_capacity(size));
        let (reach, scale) = (vec![0.0; joints], vec![0.0; joints]);
        let mut meter = Self { rig, clip, root, times, model, moved, reach, scale };
        let mut bones = vec![0.0; joints];
        let mut poses = Poses::new(rig, &meter.clip);
        for &time in &meter.times {
            poses.sample(rig, &meter.clip, root, time);
            for (i, joint) in rig.joints.iter().enumerate().filter(|(i, _)| poses.moved[*i]) {
                let parent = joint.parent.map_or(root, |parent| &poses.model[parent]);
                let bone = poses.model[i].translation - parent.translation;
                bones[i] = max(bones[i], bone.length_squared());
                meter.scale[i] = max(meter.scale[i], longest_squared(parent));
            }
            meter.model.extend_from_slice(&poses.model);
            meter.moved.extend_from_slice(&poses.moved);
        }
        meter.scale.iter_mut().for_each(|scale| *scale = scale.sqrt());
        bones.iter_mut().for_each(|bone| *bone = bone.sqrt());
        for (i, joint) in rig.joints.iter().enumerate().rev() {
            if let Some(parent) = joint.parent {
                meter.reach[parent] = max(meter.reach[parent], meter.reach[i] + bones[i]);
            }
        }
        meter
    }

    /// Returns the clip with the keys that each channel needs if it may use `share` of the bound.
    fn thinned(&self, bound: KeyBound, share: f32) -> Clip {
        let channels = Vec::with_capacity(self.clip.channels.len());
        let mut clip = Clip { name: self.clip.name.clone(), duration: self.clip.duration, channels };
        for channel in &self.clip.channels {
            let tolerance = share * self.tolerance(channel.property, channel.joint, bound);
            clip.channels.push(thinned(channel, tolerance));
        }
        // The last key time must remain, for readers that derive the duration from keys.
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

    /// Error of a channel's value that alone uses up the bound, in the unit of the channel, or radians.
    fn tolerance(&self, property: Property, joint: JointIdx, bound: KeyBound) -> f32 {
        match property {
            Property::Translation => bound.distance / max(self.scale[joint], 1e-12),
            // A scale error moves descendants as far as a rotation error of the same size.
            Property::Rotation | Property::Scale => {
                min(bound.angle, bound.distance / max(self.reach[joint], 1e-12))
            }
        }
    }

    fn error(&self, reduced: &Clip) -> KeyError {
        let mut poses = Poses::new(self.rig, reduced);
        let mut worst = KeyError::default();
        let joints = self.rig.joints.len();
        for (at, &time) in self.times.iter().enumerate() {
            poses.sample(self.rig, reduced, self.root, time);
            let here = at * joints..(at + 1) * joints;
            let (was, moved) = (&self.model[here.clone()], &self.moved[here]);
            for joint in (0..joints).filter(|&joint| moved[joint] || poses.moved[joint]) {
                let (a, b) = (&was[joint], &poses.model[joint]);
                worst.distance = max(worst.distance, (a.translation - b.translation).length_squared());
                worst.angle = max(worst.angle, turned_squared(a, b));
            }
        }
        KeyError { distance: worst.distance.sqrt(), angle: worst.angle.sqrt() }
    }
}

/// Poses of a clip at ascending times. Channels that do not change cost almost nothing.
struct Poses {
    /// For each channel: its last key at or before the time, and the time until which its value is constant.
    keys: Vec<usize>,
    stays: Vec<f32>,
    is_first: bool,
    local: Vec<LocalTransform>,
    model: Vec<Affine>,
    /// True for each joint that moved since the last time.
    moved: Vec<bool>,
}

impl Poses {
    fn new(rig: &Rig, clip: &Clip) -> Self {
        let (keys, stays) = (vec![0; clip.channels.len()], vec![f32::NEG_INFINITY; clip.channels.len()]);
        let (model, moved) = (vec![Affine::IDENTITY; rig.joints.len()], vec![true; rig.joints.len()]);
        Self { keys, stays, is_first: true, local: rest_pose(rig), model, moved }
    }

    /// Samples like [`sample`](crate::clip::sample::sample()); values at keys are copied, which is cheaper.
    fn sample(&mut self, rig: &Rig, clip: &Clip, root: &Affine, time: f32) {
        self.moved.fill(core::mem::take(&mut self.is_first));
        for (i, channel) in clip.channels.iter().enumerate() {
            if time <= self.stays[i] {
                continue;
            }
            let key = &mut self.keys[i];
            while channel.times.get(*key + 1).is_some_and(|&next| next <= time) {
                *key += 1;
            }
            let (value, stays) = value_and_end(channel, *key, time);
            self.stays[i] = stays;
            self.moved[channel.joint] = true;
            write_property(&mut self.local[channel.joint], channel.property, value);
        }
        for (i, joint) in rig.joints.iter().enumerate() {
            self.moved[i] |= joint.parent.is_some_and(|parent| self.moved[parent]);
            if self.moved[i] {
                let parent = joint.parent.map_or(root, |parent| &self.model[parent]);
                self.model[i] = *parent * self.local[i].to_affine();
            }
        }
    }
}

/// Returns the channel's value at `time`, and the time until which the value stays constant (negative infinity if it
/// changes). `key` is the last key at or before `time`. At keys the value is copied.
fn value_and_end(channel: &Channel, key: usize, time: f32) -> ([f32; 4], f32) {
    if channel.interpolation != Interpolation::Linear {
        return (channel_at(channel, time), f32::NEG_INFINITY);
    }
    let Some(&next) = channel.times.get(key + 1) else { return (channel.value(key), f32::INFINITY) };
    if time < channel.times[key] {
        return (channel.value(key), f32::NEG_INFINITY);
    }
    let line = Line::between(channel, key, key + 1);
    let [a, b] = line.values;
    if a == b {
        return (a, next);
    }
    (if time == channel.times[key] { a } else { line.at(time) }, f32::NEG_INFINITY)
}

/// Square of the length of the longest axis of a map.
fn longest_squared(map: &Affine) -> f32 {
    let m = &map.linear;
    [m.x_axis, m.y_axis, m.z_axis].into_iter().map(Vec3::length_squared).fold(0.0, max)
}

/// Square of the angle between two maps, for small angles. For a rotation by `a`, the squared displacements of the
/// three unit axes sum to `8 sin²(a/2)`.
fn turned_squared(a: &Affine, b: &Affine) -> f32 {
    let (a, b) = (&a.linear, &b.linear);
    let axes = [(a.x_axis, b.x_axis), (a.y_axis, b.y_axis), (a.z_axis, b.z_axis)];
    // Uses differences, because the cosine of a small angle loses precision.
    let moved = |(a, b): (Vec3, Vec3)| {
        let [la, lb] = [a, b].map(Vec3::length);
        if min(la, lb) > 0.0 { (a * (1.0 / la) - b * (1.0 / lb)).length_squared() } else { 0.0 }
    };
    0.5 * axes.into_iter().map(moved).sum::<f32>()
}

/// Returns a linear channel without keys that equal both neighbours.
fn without_repeats(channel: &Channel) -> Channel {
    if channel.interpolation != Interpolation::Linear {
        return channel.clone();
    }
    let width = channel.property.width();
    let value = |key: usize| &channel.values[key * width..][..width];
    let last = channel.times.len() - 1;
    let says_more = |&key: &usize| {
        key == 0 || key == last || value(key) != value(key - 1) || value(key) != value(key + 1)
    };
    let kept: Vec<usize> = (0..=last).filter(says_more).collect();
    with_keys(channel, &kept)
}

/// Returns a channel without the keys that lines between the remaining keys reproduce within `tolerance`.
fn thinned(channel: &Channel, tolerance: f32) -> Channel {
    if channel.interpolation != Interpolation::Linear || channel.times.len() < 2 {
        return channel.clone();
    }
    let last = channel.times.len() - 1;
    let fit = Fit { channel, squared: tolerance * tolerance };
    let first = channel.value(0);
    if (1..=last).all(|key| fit.holds_at(key, first)) {
        return with_keys(channel, &[0]);
    }
    let (mut kept, mut from) = (vec![0], 0);
    while from < last {
        from = fit.farthest(from, last);
        kept.push(from);
    }
    with_keys(channel, &kept)
}

/// Returns a channel with a subset of its keys. Rotations take the short way from one to the next.
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
    /// Value of a key of a channel that is not a spline.
    fn value(&self, key: usize) -> [f32; 4] {
        let width = self.property.width();
        let mut value = [0.0; 4];
        value[..width].copy_from_slice(&self.values[key * width..][..width]);
        value
    }
}

/// The straight line between two keys of a channel.
struct Line {
    property: Property,
    start: f32,
    span: f32,
    values: [[f32; 4]; 2],
}

impl Line {
    fn between(channel: &Channel, from: usize, to: usize) -> Self {
        let (start, end) = (channel.times[from], channel.times[to]);
        let values = [channel.value(from), channel.value(to)];
        Self { property: channel.property, start, span: end - start, values }
    }

    fn at(&self, time: f32) -> [f32; 4] {
        let [a, b] = self.values;
        let t = (time - self.start) / self.span;
        if self.property == Property::Rotation {
            let [a, b] = [a, b].map(|[x, y, z, w]| Rotation::from_xyzw(x, y, z, w));
            let q = a.slerp(b, t);
            return [q.x, q.y, q.z, q.w];
        }
        core::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
    }
}

/// A channel with the squared tolerance of its keys.
struct Fit<'a> {
    channel: &'a Channel,
    squared: f32,
}

impl Fit<'_> {
    /// Returns the last key that a line from `from` can reach: growing steps until one fails, then bisection.
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

    /// True if all keys between two keys are near the line between these. Tests the middle first, where errors are
    /// largest.
    fn holds(&self, from: usize, to: usize) -> bool {
        let line = Line::between(self.channel, from, to);
        let holds = |key: usize| self.holds_at(key, line.at(self.channel.times[key]));
        let middle = from + (to - from) / 2;
        holds(middle) && (from + 1..middle).all(holds) && (middle + 1..to).all(holds)
    }

    /// True if a key is near a value: in the unit of the channel, or radians for small angles.
    fn holds_at(&self, key: usize, value: [f32; 4]) -> bool {
        let own = self.channel.value(key);
        let squared = |sign: f32| {
            own.iter().zip(&value).fold(0.0, |sum: f32, (a, b)| {
                let d = a - sign * b;
                sum + d * d
            })
        };
        match self.channel.property {
            // Two quaternions differ by half of the angle, and −q is the same rotation.
            Property::Rotation => 4.0 * min(squared(1.0), squared(-1.0)) <= self.squared,
            Property::Translation | Property::Scale => squared(1.0) <= self.squared,
        }
    }
}
