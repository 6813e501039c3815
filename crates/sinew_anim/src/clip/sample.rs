//! Samples a clip at a time by the glTF 2.0 interpolations (Appendix C).

use crate::clip::{Channel, Clip, Interpolation, Property};
use crate::rig::{LocalTransform, Rig};
use sinew_math::{Rotation, Vec3, clamp};

/// Meaning of a time outside the clip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The first or the last pose holds outside the clip.
    #[default]
    Clamp,
    /// The clip repeats, also backward.
    Loop,
}

impl Wrap {
    /// Converts any `time` to the clip's own time, seconds in 0..=`duration`; 0 for NaN and for a clip of no
    /// duration.
    pub fn clip_time(self, time: f32, duration: f32) -> f32 {
        if duration.is_nan() || duration <= 0.0 {
            return 0.0;
        }
        match self {
            Self::Clamp => clamp(time, 0.0, duration),
            // The remainder of two floats is exact, so a long run does not drift.
            Self::Loop => {
                let rest = time % duration;
                clamp(if rest < 0.0 { rest + duration } else { rest }, 0.0, duration)
            }
        }
    }
}

/// Key at which each channel was last read, so that playing forward needs no search.
///
/// A stale cache, after another clip or a jump, costs time but never changes the pose.
#[derive(Clone, Debug, Default)]
pub struct SampleCache {
    keys: Vec<usize>,
}

/// Writes the pose of `clip` at `time` (seconds, any value, see [`Wrap`]) to `out`: one local transform per joint of
/// the rig, file units. Joints and properties without a channel, and values that are not finite, get the rig's rest
/// pose. Before a channel's first key, the value of that key holds.
///
/// # Panics
/// If `out` is not as long as the rig has joints, a channel's joint is not in the rig, or a channel has fewer values
/// than [`Channel`] promises.
pub fn sample(clip: &Clip, rig: &Rig, time: f32, wrap: Wrap, out: &mut [LocalTransform]) {
    sample_cached(clip, rig, time, wrap, &mut SampleCache::default(), out);
}

/// Like [`sample`], with a cache of the last keys: constant time per channel while time advances by small steps.
///
/// # Panics
/// As [`sample`].
pub fn sample_cached(
    clip: &Clip,
    rig: &Rig,
    time: f32,
    wrap: Wrap,
    cache: &mut SampleCache,
    out: &mut [LocalTransform],
) {
    assert_eq!(out.len(), rig.joints.len(), "a pose has one local transform per joint");
    for (target, joint) in out.iter_mut().zip(&rig.joints) {
        *target = joint.rest;
    }
    let time = wrap.clip_time(time, clip.duration);
    cache.keys.resize(clip.channels.len(), 0);
    for (channel, key) in clip.channels.iter().zip(&mut cache.keys) {
        let target = &mut out[channel.joint];
        *key = last_key_at(&channel.times, time, *key);
        let value = channel_value(channel, *key, time);
        if value.iter().all(|v| v.is_finite()) {
            write_property(target, channel.property, value);
        }
    }
}

/// Returns the index of the last key at or before `time` (0 before the first), starting the search at `hint`.
fn last_key_at(times: &[f32], time: f32, hint: usize) -> usize {
    let holds = |i: usize| times[i] <= time && times.get(i + 1).is_none_or(|&next| time < next);
    if let Some(near) = [hint, hint + 1].into_iter().find(|&i| i < times.len() && holds(i)) {
        return near;
    }
    times.partition_point(|&t| t <= time).saturating_sub(1)
}

/// Sets one property of a local transform.
pub(crate) fn write_property(target: &mut LocalTransform, property: Property, [x, y, z, w]: [f32; 4]) {
    match property {
        Property::Translation => target.translation = Vec3::new(x, y, z),
        Property::Rotation => target.rotation = Rotation::from_xyzw(x, y, z, w).normalize(),
        Property::Scale => target.scale = Vec3::new(x, y, z),
    }
}

/// Returns the value of a channel at `time`, seconds, by the file's interpolation. The fourth number is 0 except for
/// rotations, whose length is 1 only as far as keys and interpolation keep it.
pub(crate) fn channel_at(channel: &Channel, time: f32) -> [f32; 4] {
    channel_value(channel, last_key_at(&channel.times, time, 0), time)
}

/// Returns the value of a channel at `time`; `key` is the last key at or before it. The fourth number is 0 except
/// for rotations.
fn channel_value(channel: &Channel, key: usize, time: f32) -> [f32; 4] {
    let next = key + 1;
    let inside = next < channel.times.len() && time >= channel.times[key];
    if !inside || channel.interpolation == Interpolation::Step {
        return key_part(channel, key, Part::Value);
    }
    let dt = channel.times[next] - channel.times[key];
    let t = (time - channel.times[key]) / dt;
    if channel.interpolation == Interpolation::CubicSpline {
        return hermite(channel, key, t, dt);
    }
    let (a, b) = (key_part(channel, key, Part::Value), key_part(channel, next, Part::Value));
    if channel.property == Property::Rotation {
        let q = rotation_of(a).slerp(rotation_of(b), t);
        return [q.x, q.y, q.z, q.w];
    }
    core::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
}

fn rotation_of([x, y, z, w]: [f32; 4]) -> Rotation {
    Rotation::from_xyzw(x, y, z, w).normalize()
}

/// The three vectors of a cubic key, in the file's order.
#[derive(Clone, Copy)]
enum Part {
    InTangent,
    Value,
    OutTangent,
}

fn key_part(channel: &Channel, key: usize, part: Part) -> [f32; 4] {
    let width = channel.property.width();
    let start = match channel.interpolation {
        Interpolation::CubicSpline => (key * 3 + part as usize) * width,
        Interpolation::Step | Interpolation::Linear => key * width,
    };
    let mut value = [0.0; 4];
    value[..width].copy_from_slice(&channel.values[start..start + width]);
    value
}

/// Evaluates a cubic Hermite spline (glTF 2.0 Appendix C.4); tangents are per second, hence × `dt`.
fn hermite(channel: &Channel, key: usize, t: f32, dt: f32) -> [f32; 4] {
    let (t2, t3) = (t * t, t * t * t);
    let v0 = key_part(channel, key, Part::Value);
    let b0 = key_part(channel, key, Part::OutTangent);
    let v1 = key_part(channel, key + 1, Part::Value);
    let a1 = key_part(channel, key + 1, Part::InTangent);
    core::array::from_fn(|i| {
        (2.0 * t3 - 3.0 * t2 + 1.0) * v0[i]
            + dt * (t3 - 2.0 * t2 + t) * b0[i]
            + (3.0 * t2 - 2.0 * t3) * v1[i]
            + dt * (t3 - t2) * a1[i]
    })
}
