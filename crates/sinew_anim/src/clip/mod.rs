//! Keyframed motion as stored in a file.

pub mod reduce;
pub mod root_motion;
pub mod sample;
pub mod take;

use crate::rig::{JointIdx, LocalTransform};
use sinew_math::Rotation;

/// Interpolation of values between two keys (glTF 2.0 §3.11).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// The value of the earlier key holds until the next key.
    Step,
    /// Linear interpolation; slerp for rotations.
    Linear,
    /// Cubic Hermite: each key has in-tangent, value and out-tangent; tangents are per second.
    CubicSpline,
}

/// Property of a joint that a channel moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Property {
    /// Three numbers per key, file units.
    Translation,
    /// Four numbers per key, x y z w.
    Rotation,
    /// Scale, three numbers per key.
    Scale,
}

impl Property {
    /// Numbers per value: 3 or 4.
    pub fn width(self) -> usize {
        if self == Self::Rotation { 4 } else { 3 }
    }
}

/// Keys of one property of one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Joint that the channel moves.
    pub joint: JointIdx,
    /// The property that the channel moves.
    pub property: Property,
    /// Interpolation between keys.
    pub interpolation: Interpolation,
    /// Key times, seconds, strictly increasing, at least one.
    pub times: Vec<f32>,
    /// Key values: `times.len() × property.width()` numbers, three times as many for a cubic spline.
    pub values: Vec<f32>,
}

/// A motion: channels over the joints of one rig.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clip {
    /// Name in the file, or `""`.
    pub name: String,
    /// Latest key time, seconds.
    pub duration: f32,
    /// Channels; joints without one keep their rest pose.
    pub channels: Vec<Channel>,
}

impl Clip {
    /// Converts the clip to differences from `reference`, for additive layers: rotations become `reference⁻¹ · key`,
    /// translations `key − reference`, scales `key ÷ reference`, with the reference of the same joint, in the
    /// parent's axes. Interpolations and tangents keep their meaning. Build the result with
    /// [`Fill::Identity`](crate::Fill), so that joints without a channel do not change.
    ///
    /// # Panics
    /// If a channel's joint is not in `reference`, or a scale of the reference is 0 where a channel scales.
    pub fn difference_from(&self, reference: &[LocalTransform]) -> Self {
        let mut clip = self.clone();
        for channel in &mut clip.channels {
            let from = &reference[channel.joint];
            let width = channel.property.width();
            let is_cubic = channel.interpolation == Interpolation::CubicSpline;
            for (i, number) in channel.values.chunks_exact_mut(width).enumerate() {
                // Tangents are derivatives, so subtracting a constant does not change them.
                let is_tangent = is_cubic && i % 3 != 1;
                match (channel.property, number) {
                    (Property::Rotation, [x, y, z, w]) => {
                        let q = from.rotation.inverse() * Rotation::from_xyzw(*x, *y, *z, *w);
                        (*x, *y, *z, *w) = (q.x, q.y, q.z, q.w);
                    }
                    (Property::Translation, [x, y, z]) if !is_tangent => {
                        (*x, *y, *z) =
                            (*x - from.translation.x, *y - from.translation.y, *z - from.translation.z);
                    }
                    (Property::Scale, [x, y, z]) => {
                        assert!(
                            from.scale.cmpne(sinew_math::Vec3::ZERO).all(),
                            "a reference's scale is not 0"
                        );
                        (*x, *y, *z) = (*x / from.scale.x, *y / from.scale.y, *z / from.scale.z);
                    }
                    _ => {}
                }
            }
        }
        clip
    }

    /// Returns the clip played backwards, with the same name and duration.
    pub fn reversed(&self) -> Self {
        let channels = self.channels.iter().map(|channel| channel.reversed(self.duration)).collect();
        Self { name: self.name.clone(), duration: self.duration, channels }
    }
}

impl Channel {
    /// Returns the channel of a clip of `duration` seconds played backwards.
    fn reversed(&self, duration: f32) -> Self {
        let width = self.property.width();
        let per_key = if self.interpolation == Interpolation::CubicSpline { 3 * width } else { width };
        let mut times: Vec<f32> = self.times.iter().rev().map(|time| duration - time).collect();
        let mut keys: Vec<&[f32]> = self.values.chunks_exact(per_key).rev().collect();
        let mut values = Vec::with_capacity(self.values.len());
        match self.interpolation {
            Interpolation::Linear => values.extend(keys.concat()),
            Interpolation::Step => {
                // The value before a key of the reversed clip is the one that holds after it.
                if times[0] > 0.0 {
                    times.insert(0, 0.0);
                } else if keys.len() > 1 {
                    keys.remove(0);
                }
                keys.extend(keys.last().copied());
                values.extend(keys.concat());
                values.truncate(times.len() * width);
            }
            Interpolation::CubicSpline => {
                for key in keys {
                    let (into, rest) = key.split_at(width);
                    let (value, out) = rest.split_at(width);
                    values.extend(out.iter().map(|tangent| -tangent));
                    values.extend(value);
                    values.extend(into.iter().map(|tangent| -tangent));
                }
            }
        }
        Self { times, values, ..*self }
    }
}
