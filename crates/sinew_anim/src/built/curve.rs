//! Chooses the keys of a channel such that straight lines between them are accurate enough.

use super::build::ClipBuildOptions;
use super::error::angle_between;
use crate::clip::sample::channel_at;
use crate::clip::{Channel, Interpolation, Property};
use sinew_math::{Rotation, Vec3, abs3, max, trig};

/// Values of a channel at times, with straight lines between them; rotations have length 1 and share a hemisphere.
pub(super) struct Curve {
    pub times: Vec<f32>,
    pub values: Vec<[f32; 4]>,
}

/// Deepest subdivision: 2^10 parts.
const DEEPEST: u32 = 10;

impl Curve {
    pub fn of(channel: &Channel, options: &ClipBuildOptions) -> Self {
        let tolerance = match channel.property {
            Property::Rotation => options.rotation_tolerance,
            Property::Translation | Property::Scale => options.relative_tolerance * extent(channel),
        };
        let mut times = vec![channel.times[0]];
        for pair in channel.times.windows(2) {
            match channel.interpolation {
                // The earlier value holds until the last representable time before the key.
                Interpolation::Step => times.extend([pair[1].next_down(), pair[1]]),
                Interpolation::Linear if channel.property == Property::Rotation => {
                    split_turn(channel, pair[0], pair[1], tolerance, &mut times);
                }
                Interpolation::Linear => times.push(pair[1]),
                Interpolation::CubicSpline => {
                    split_cubic(channel, pair[0], pair[1], tolerance, 0, &mut times);
                }
            }
        }
        times.dedup();
        let mut curve = Self { values: Vec::with_capacity(times.len()), times };
        for &time in &curve.times {
            let value = straight(channel, time);
            curve.values.push(match curve.values.last() {
                Some(&last) if dot(last, value) < 0.0 && channel.property == Property::Rotation => {
                    value.map(|x| -x)
                }
                _ => value,
            });
        }
        curve
    }

    /// True if the curve is constant except for rounding.
    pub fn is_constant(&self) -> bool {
        let first = self.values[0];
        let size = first.iter().fold(0.0, |size, x| max(size, x.abs()));
        let same = |value: &[f32; 4]| (0..4).all(|i| (value[i] - first[i]).abs() <= 2e-7 * size);
        self.values.iter().all(same)
    }

    /// Returns the first three numbers of each value.
    pub fn vectors(&self) -> Vec<[f32; 3]> {
        self.values.iter().map(|&[x, y, z, _]| [x, y, z]).collect()
    }
}

fn dot(a: [f32; 4], b: [f32; 4]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
}

/// Length of the diagonal of the box around a channel's keys.
fn extent(channel: &Channel) -> f32 {
    let values = channel.times.iter().map(|&time| vector(channel_at(channel, time)));
    let first = vector(channel_at(channel, channel.times[0]));
    let (low, high) =
        values.fold((first, first), |(low, high), v| (sinew_math::min3(low, v), sinew_math::max3(high, v)));
    (high - low).length()
}

fn vector([x, y, z, _]: [f32; 4]) -> Vec3 {
    Vec3::new(x, y, z)
}

fn rotation([x, y, z, w]: [f32; 4]) -> Rotation {
    Rotation::from_xyzw(x, y, z, w)
}

/// Returns a channel's value at a time; rotations have length 1.
fn straight(channel: &Channel, time: f32) -> [f32; 4] {
    let value = channel_at(channel, time);
    if channel.property == Property::Rotation {
        let q = rotation(value).normalize();
        return [q.x, q.y, q.z, q.w];
    }
    value
}

/// Splits a rotation at constant speed into equal parts such that the error of `nlerp` is at most `tolerance` radians
/// in each. For angles up to a sixth of a circle the error is 0.0037 times the cube of the angle, by the series of
/// `nlerp` and `slerp`.
fn split_turn(channel: &Channel, from: f32, to: f32, tolerance: f32, times: &mut Vec<f32>) {
    let ends = [from, to].map(|time| rotation(straight(channel, time)));
    let angle = angle_between(ends[0], ends[1]);
    let largest = trig::cbrt(tolerance / 0.0037);
    let mut parts = 1_u32;
    while angle > largest * parts as f32 && parts < 1 << DEEPEST {
        parts *= 2;
    }
    times.extend((1..parts).map(|i| from + (to - from) * (i as f32 / parts as f32)));
    times.push(to);
}

/// Halves a piece of a spline until a straight line is within `tolerance` of the spline.
fn split_cubic(channel: &Channel, from: f32, to: f32, tolerance: f32, depth: u32, times: &mut Vec<f32>) {
    let middle = 0.5 * (from + to);
    let splittable = depth < DEEPEST && from < middle && middle < to;
    if splittable && !is_straight(channel, from, to, tolerance) {
        split_cubic(channel, from, middle, tolerance, depth + 1, times);
        split_cubic(channel, middle, to, tolerance, depth + 1, times);
    } else {
        times.push(to);
    }
}

/// True if a straight line is accurate at seven positions, within half of the tolerance; the other half is for the
/// positions between.
fn is_straight(channel: &Channel, from: f32, to: f32, tolerance: f32) -> bool {
    let (a, b) = (straight(channel, from), straight(channel, to));
    (1..8).all(|i| {
        let share = i as f32 / 8.0;
        let curve = straight(channel, from + (to - from) * share);
        let error = match channel.property {
            Property::Rotation => angle_between(rotation(a).nlerp(rotation(b), share), rotation(curve)),
            Property::Translation | Property::Scale => {
                let line = vector(a) + (vector(b) - vector(a)) * share;
                // The length of the difference is at least its largest component.
                abs3(line - vector(curve)).length()
            }
        };
        error <= 0.5 * tolerance
    })
}
