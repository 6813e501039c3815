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
                // Tangents are differences already; subtracting a constant does not change them.
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
}
