//! Converts postures at times to a clip.

use super::posture::Posture;
use super::skeleton::Bone;
use crate::anim::{Channel, Clip, Interpolation, LocalTransform, Property};
use crate::math::Rotation;

/// Keys per second of the clips.
pub(super) const RATE: f32 = 30.0;

/// Makes a clip of `frames + 1` linear keys at [`RATE`]; `posture_at` takes a time in seconds.
pub(super) fn record(name: &str, frames: usize, posture_at: impl Fn(f32) -> Posture) -> Clip {
    let times: Vec<f32> = (0..=frames).map(|k| k as f32 / RATE).collect();
    let poses: Vec<Vec<LocalTransform>> = times.iter().map(|&t| posture_at(t).solve()).collect();
    let channel = |bone: Bone, property: Property, values: Vec<f32>| Channel {
        joint: bone.index(),
        property,
        interpolation: Interpolation::Linear,
        times: times.clone(),
        values,
    };
    let hips = poses.iter().flat_map(|pose| pose[Bone::Hips.index()].translation.to_array()).collect();
    let mut channels = vec![channel(Bone::Hips, Property::Translation, hips)];
    for bone in Bone::all().skip(1) {
        channels.push(channel(bone, Property::Rotation, rotations(&poses, bone)));
    }
    Clip { name: name.to_owned(), duration: times[frames], channels }
}

/// Returns the key values of a joint's rotation, each on the hemisphere of the previous one.
fn rotations(poses: &[Vec<LocalTransform>], bone: Bone) -> Vec<f32> {
    let mut last = Rotation::IDENTITY;
    let mut values = Vec::with_capacity(4 * poses.len());
    for pose in poses {
        last = pose[bone.index()].rotation.toward(last);
        values.extend([last.x, last.y, last.z, last.w]);
    }
    values
}

/// A posture at a time, seconds.
pub(super) struct Key {
    pub(super) at: f32,
    pub(super) posture: Posture,
}

/// Returns the posture at `time`. `keys` are in order of time. Every number is interpolated by [`monotone`], so that
/// equal values of two keys (a planted hand) stay constant between them.
pub(super) fn between(keys: &[Key], time: f32) -> Posture {
    let times: Vec<f32> = keys.iter().map(|key| key.at).collect();
    let mut result = keys[0].posture;
    let mut columns: Vec<Posture> = keys.iter().map(|key| key.posture).collect();
    let rows: Vec<Vec<f32>> =
        columns.iter_mut().map(|posture| posture.numbers().into_iter().map(|x| *x).collect()).collect();
    for (index, number) in result.numbers().into_iter().enumerate() {
        let values: Vec<f32> = rows.iter().map(|row| row[index]).collect();
        *number = monotone(&times, &values, time);
    }
    result
}

/// Evaluates a smooth curve through points that does not overshoot them (Fritsch and Butland 1984) and is flat at both
/// ends.
pub(super) fn monotone(times: &[f32], values: &[f32], time: f32) -> f32 {
    let last = times.len() - 1;
    if time >= times[last] {
        return values[last];
    }
    let i = times.partition_point(|&t| t <= time).saturating_sub(1);
    let width = times[i + 1] - times[i];
    let t = (time - times[i]) / width;
    if t < 0.0 {
        return values[0];
    }
    let (a, b) = (values[i], values[i + 1]);
    let (from, to) = (slope(times, values, i) * width, slope(times, values, i + 1) * width);
    let (t2, t3) = (t * t, t * t * t);
    a + (b - a) * (3.0 * t2 - 2.0 * t3) + from * (t3 - 2.0 * t2 + t) + to * (t3 - t2)
}

/// Slope of the monotone curve at key `i`: weighted harmonic mean of the two adjacent slopes, 0 at an extremum.
fn slope(times: &[f32], values: &[f32], i: usize) -> f32 {
    if i == 0 || i + 1 == times.len() {
        return 0.0;
    }
    let (before, after) = (times[i] - times[i - 1], times[i + 1] - times[i]);
    let left = (values[i] - values[i - 1]) / before;
    let right = (values[i + 1] - values[i]) / after;
    if left * right <= 0.0 {
        return 0.0;
    }
    let (wl, wr) = (2.0 * after + before, after + 2.0 * before);
    (wl + wr) * left * right / (wl * right + wr * left)
}
