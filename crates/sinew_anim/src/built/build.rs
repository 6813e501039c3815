//! Builds a playable clip from a raw one.

use super::code::{Bounds, Key, ROTATION_BOUND, SmallestThree};
use super::curve::Curve;
use super::{BuiltClip, ClipError, Track, TrackBlock, Tracks};
use crate::clip::{Channel, Clip, Interpolation, Property};
use crate::pose::{Pose, ROTATION, SCALE, TRANSLATION};
use crate::rig::{JointIdx, Rig};
use sinew_math::lanes::WIDTH;
use sinew_math::{StableHasher, Vec3, max};
use thiserror::Error;

/// Value of joints and properties where the raw clip has no channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fill {
    /// The rig's rest pose, for clips that are shown or blended.
    #[default]
    Rest,
    /// No change, for additive clips: see [`Clip::difference_from`].
    Identity,
}

/// Options for building a clip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipBuildOptions {
    /// Value where the clip has no channel.
    pub fill: Fill,
    /// Largest error of straight lines against arcs and splines, radians. Where the error would be larger, keys are
    /// inserted.
    pub rotation_tolerance: f32,
    /// Largest error of translations and scales, as a share of the diagonal of the channel's bounding box.
    pub relative_tolerance: f32,
}

impl Default for ClipBuildOptions {
    fn default() -> Self {
        Self { fill: Fill::Rest, rotation_tolerance: 1e-4, relative_tolerance: 1e-4 }
    }
}

/// Reason why a clip cannot be built. Channels and keys are counted from 0, as in [`Clip::channels`].
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ClipBuildError {
    /// The rig has no joints.
    #[error("the rig has no joints")]
    NoJoints,
    /// The clip's duration is negative or not finite. A duration of 0 is allowed: a pose.
    #[error("the clip lasts {duration} s; it has to last 0 or longer")]
    Duration {
        /// Duration in the clip, seconds.
        duration: f32,
    },
    /// A channel moves a joint that the rig does not have.
    #[error("channel {channel} moves joint {joint} of {joints}")]
    UnknownJoint {
        /// Index of the channel in the clip.
        channel: usize,
        /// The joint that it moves.
        joint: JointIdx,
        /// Number of joints of the rig.
        joints: usize,
    },
    /// A channel has no keys.
    #[error("channel {channel} has no keys")]
    NoKeys {
        /// Index of the channel in the clip.
        channel: usize,
    },
    /// The number of a channel's values does not fit its keys.
    #[error("channel {channel} has {values} numbers where its keys take {needed}")]
    ValueCount {
        /// Index of the channel in the clip.
        channel: usize,
        /// Count of numbers in the channel.
        values: usize,
        /// Count of numbers that the channel's keys need.
        needed: usize,
    },
    /// A key's time is negative, not finite, or not after the previous key's.
    #[error(
        "channel {channel}, key {key}: its time, {time} s, is not after the one before it, or not a time"
    )]
    Time {
        /// Index of the channel in the clip.
        channel: usize,
        /// Index of the key in the channel.
        key: usize,
        /// Time in the clip, seconds.
        time: f32,
    },
    /// A key's value, or tangent, is not finite, or so large that differences overflow (above 1e18).
    #[error("channel {channel}, key {key}: its value is not finite, or above 1e18")]
    Value {
        /// Index of the channel in the clip.
        channel: usize,
        /// Index of the key in the channel.
        key: usize,
    },
    /// A key's rotation is the zero quaternion.
    #[error("channel {channel}, key {key}: its rotation is zero")]
    ZeroRotation {
        /// Index of the channel in the clip.
        channel: usize,
        /// Index of the key in the channel.
        key: usize,
    },
    /// The clip has more than 65,536 different key times.
    #[error("the keys are at {times} different times; a built clip has room for 65,536")]
    TooManyTimes {
        /// Number of different times.
        times: usize,
    },
}

impl BuiltClip {
    /// Quantises a clip for a rig.
    ///
    /// Rotations have 48 bits (the three smallest components of the quaternion, and which one is the largest).
    /// Translations and scales have 48 bits within the bounds of their own channel. Splines and wide arcs get extra
    /// keys; a step becomes two keys at neighbouring times. If two channels move the same property, the later one
    /// counts, as in
    /// [`sample`](crate::clip::sample::sample()). A constant channel has no keys.
    ///
    /// # Errors
    /// If the clip violates the rules of [`Clip`]. The error names channel and key; see [`ClipBuildError`].
    pub fn build(clip: &Clip, rig: &Rig, options: &ClipBuildOptions) -> Result<Self, ClipBuildError> {
        check(clip, rig)?;
        let mut base = match options.fill {
            Fill::Rest => Pose::rest(rig),
            Fill::Identity => Pose::new(rig.joints.len()),
        };
        let mut bound = ClipError::default();
        let mut curves: Vec<(JointIdx, Property, Curve)> = Vec::new();
        for (i, channel) in clip.channels.iter().enumerate() {
            let moves = |c: &Channel| (c.joint, c.property) == (channel.joint, channel.property);
            if clip.channels[i + 1..].iter().any(moves) {
                continue;
            }
            let curve = Curve::of(channel, options);
            if curve.is_constant() {
                let row = first_row(channel.property);
                let rows = &mut base.blocks_mut()[channel.joint / WIDTH].0[row..][..channel.property.width()];
                for (row, value) in rows.iter_mut().zip(curve.values[0]) {
                    row[channel.joint % WIDTH] = value;
                }
            } else {
                curves.push((channel.joint, channel.property, curve));
            }
            bound = bound.merged(bound_of(channel, options));
        }
        let times = all_times(&curves)?;
        let mut built = Self {
            name: clip.name.clone(),
            duration: clip.duration,
            base,
            rotations: Tracks::default(),
            translations: Tracks::default(),
            scales: Tracks::default(),
            fill: options.fill,
            bound,
            times,
            fingerprint: 0,
        };
        curves.sort_by_key(|&(joint, ..)| joint);
        for (joint, property, curve) in &curves {
            built.add(*joint, *property, curve);
        }
        built.fingerprint = built.hash();
        Ok(built)
    }

    fn add(&mut self, joint: JointIdx, property: Property, curve: &Curve) {
        let vectors = |tracks: &mut Tracks<Bounds>| {
            let values = curve.vectors();
            let bounds = Bounds::around(&values);
            add_track(tracks, &self.times, joint, bounds, curve, |i| bounds.encode(values[i]));
        };
        match property {
            Property::Rotation => {
                let packed = |i: usize| {
                    let [x, y, z, w] = curve.values[i];
                    SmallestThree::encode(sinew_math::Rotation::from_xyzw(x, y, z, w))
                };
                add_track(&mut self.rotations, &self.times, joint, SmallestThree, curve, packed);
            }
            Property::Translation => vectors(&mut self.translations),
            Property::Scale => vectors(&mut self.scales),
        }
    }

    fn hash(&self) -> u64 {
        let mut hasher = StableHasher::default();
        let mut number = |x: f32| hasher.write(&x.to_bits().to_le_bytes());
        number(self.duration);
        number(if self.fill == Fill::Identity { 1.0 } else { 0.0 });
        self.times.iter().for_each(|&time| number(time));
        self.base.blocks().iter().for_each(|block| block.0.as_flattened().iter().for_each(|&x| number(x)));
        self.rotations.hash(&mut hasher, |_| [0.0; 6]);
        let bounds = |b: &Bounds| [b.low[0], b.low[1], b.low[2], b.step[0], b.step[1], b.step[2]];
        self.translations.hash(&mut hasher, bounds);
        self.scales.hash(&mut hasher, bounds);
        // A cursor without a clip has the value 0, so the lowest bit is set.
        hasher.finish() | 1
    }
}

impl<C> Tracks<C> {
    fn hash(&self, hasher: &mut StableHasher, code: impl Fn(&C) -> [f32; 6]) {
        for block in &self.blocks {
            hasher.write(&(block.block as u64).to_le_bytes());
            for track in &block.tracks {
                hasher.write(&track.count.to_le_bytes());
                code(&track.code).iter().for_each(|x| hasher.write(&x.to_bits().to_le_bytes()));
            }
        }
        for key in &self.keys {
            hasher.write(&key.time.to_le_bytes());
            key.packed.iter().for_each(|field| hasher.write(&field.to_le_bytes()));
        }
    }
}

fn add_track<C: Copy + Default>(
    tracks: &mut Tracks<C>,
    times: &[f32],
    joint: JointIdx,
    code: C,
    curve: &Curve,
    packed: impl Fn(usize) -> [u16; 3],
) {
    let (block, lane) = (joint / WIDTH, joint % WIDTH);
    if tracks.blocks.last().is_none_or(|last| last.block != block) {
        tracks.blocks.push(TrackBlock { block, tracks: [Track::default(); WIDTH] });
    }
    let last = tracks.blocks.len() - 1;
    let count = |n: usize| u32::try_from(n).expect("65,536 keys of 2^16 joints at most");
    tracks.blocks[last].tracks[lane] =
        Track { first: count(tracks.keys.len()), count: count(curve.times.len()), code };
    let key = |(i, &time): (usize, &f32)| {
        let index = times.partition_point(|&t| t < time);
        Key { time: u16::try_from(index).expect("all times were counted"), packed: packed(i) }
    };
    tracks.keys.extend(curve.times.iter().enumerate().map(key));
}

fn first_row(property: Property) -> usize {
    match property {
        Property::Translation => TRANSLATION,
        Property::Rotation => ROTATION,
        Property::Scale => SCALE,
    }
}

fn all_times(curves: &[(JointIdx, Property, Curve)]) -> Result<Vec<f32>, ClipBuildError> {
    let mut times: Vec<f32> = curves.iter().flat_map(|(.., curve)| curve.times.iter().copied()).collect();
    times.sort_by(f32::total_cmp);
    times.dedup();
    if times.len() > 1 << 16 {
        return Err(ClipBuildError::TooManyTimes { times: times.len() });
    }
    Ok(times)
}

/// Largest error of a channel through quantisation, straight lines and rounding.
fn bound_of(channel: &Channel, options: &ClipBuildOptions) -> ClipError {
    if channel.property == Property::Rotation {
        return ClipError { rotation: ROTATION_BOUND + options.rotation_tolerance, ..ClipError::default() };
    }
    let curve = Curve::of(channel, options);
    let values = curve.vectors();
    let bounds = Bounds::around(&values);
    let size = values.iter().map(|&v| Vec3::from_array(v).length()).fold(0.0, max);
    let diagonal = 65_535.0 * Vec3::from_array(bounds.step).length();
    let curved = channel.interpolation == Interpolation::CubicSpline;
    let lines = if curved { options.relative_tolerance * diagonal } else { 0.0 };
    // The error is half a step on each axis, plus a few roundings of numbers of the value's size.
    let error = 0.5 * Vec3::from_array(bounds.step).length() + lines + 1e-6 * size;
    match channel.property {
        Property::Translation => ClipError { translation: error, ..ClipError::default() },
        Property::Scale | Property::Rotation => ClipError { scale: error, ..ClipError::default() },
    }
}

/// Checks the invariants of [`Clip`] and [`Channel`].
fn check(clip: &Clip, rig: &Rig) -> Result<(), ClipBuildError> {
    let joints = rig.joints.len();
    if joints == 0 {
        return Err(ClipBuildError::NoJoints);
    }
    let duration = clip.duration;
    if !(duration >= 0.0 && duration.is_finite()) {
        return Err(ClipBuildError::Duration { duration });
    }
    clip.channels.iter().enumerate().try_for_each(|(i, channel)| check_channel(i, channel, joints))
}

fn check_channel(index: usize, channel: &Channel, joints: usize) -> Result<(), ClipBuildError> {
    let (joint, times, values) = (channel.joint, &channel.times, &channel.values);
    if joint >= joints {
        return Err(ClipBuildError::UnknownJoint { channel: index, joint, joints });
    }
    if times.is_empty() {
        return Err(ClipBuildError::NoKeys { channel: index });
    }
    let width = channel.property.width();
    let per_key = if channel.interpolation == Interpolation::CubicSpline { 3 * width } else { width };
    let needed = times.len().saturating_mul(per_key);
    if values.len() != needed {
        return Err(ClipBuildError::ValueCount { channel: index, values: values.len(), needed });
    }
    for (key, (&time, value)) in times.iter().zip(values.chunks(per_key)).enumerate() {
        let is_late = key == 0 || times[key - 1] < time;
        if !(time >= 0.0 && time.is_finite() && is_late) {
            return Err(ClipBuildError::Time { channel: index, key, time });
        }
        if !value.iter().all(|x| x.abs() < 1e18) {
            return Err(ClipBuildError::Value { channel: index, key });
        }
        // A key of a spline has in-tangent, value and out-tangent.
        let value = if per_key == width { value } else { &value[width..2 * width] };
        if channel.property == Property::Rotation && value.iter().all(|x| x.abs() < 1e-6) {
            return Err(ClipBuildError::ZeroRotation { channel: index, key });
        }
    }
    Ok(())
}
