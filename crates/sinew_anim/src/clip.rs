//! Keyframed motion as the file holds it.

use crate::rig::JointIdx;

/// How values between two keys come about (glTF 2.0 §3.11).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// The earlier key holds.
    Step,
    /// Straight line; slerp for rotations.
    Linear,
    /// Cubic Hermite: each key has in-tangent, value, out-tangent; tangents are per second.
    CubicSpline,
}

/// What a channel moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Property {
    /// Three numbers a key, file units.
    Translation,
    /// Four numbers a key, x y z w.
    Rotation,
    /// Three numbers a key.
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
    /// The joint it moves.
    pub joint: JointIdx,
    /// What it moves.
    pub property: Property,
    /// How to fill in between keys.
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
