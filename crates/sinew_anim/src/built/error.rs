use super::{BuiltClip, Cursor};
use crate::clip::Clip;
use crate::clip::sample::{SampleCache, Wrap, sample_cached};
use crate::pose::Pose;
use crate::rig::{LocalTransform, Rig};
use sinew_math::{Rotation, max};

/// Largest difference between poses, over all joints and times.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClipError {
    /// Angle between rotations, radians.
    pub rotation: f32,
    /// Distance of a joint from its exact position in its parent's space, file units.
    pub translation: f32,
    /// Length of the difference between scales.
    pub scale: f32,
}

impl ClipError {
    /// Returns the component-wise maximum.
    pub fn merged(self, other: Self) -> Self {
        Self {
            rotation: max(self.rotation, other.rotation),
            translation: max(self.translation, other.translation),
            scale: max(self.scale, other.scale),
        }
    }

    /// True if no component exceeds `bound`.
    pub fn is_within(self, bound: Self) -> bool {
        self.rotation <= bound.rotation && self.translation <= bound.translation && self.scale <= bound.scale
    }

    fn between(a: &LocalTransform, b: &LocalTransform) -> Self {
        Self {
            rotation: angle_between(a.rotation, b.rotation),
            translation: (a.translation - b.translation).length(),
            scale: (a.scale - b.scale).length(),
        }
    }
}

/// Angle between two rotations, radians; unlike `Rotation::angle_to`, exact for small angles.
pub(super) fn angle_between(a: Rotation, b: Rotation) -> f32 {
    let difference = a.inverse() * b;
    let (sin, cos) = (difference.vector().length(), difference.w.abs());
    2.0 * sinew_math::trig::atan2(sin, cos)
}

impl BuiltClip {
    /// Returns the largest difference from the poses of the source clip, measured at each key time and at `between`
    /// times between each two. `rig` is the rig that the clip was built for. A clip that fills with identities needs a
    /// rig with an identity rest pose.
    ///
    /// # Panics
    /// If the rig has another number of joints, or `raw` is not fit to be sampled (see [`sample`](crate::clip::sample::sample())).
    pub fn measure_error(&self, raw: &Clip, rig: &Rig, between: usize) -> ClipError {
        let (mut cache, mut cursor) = (SampleCache::default(), Cursor::new());
        let mut pose = Pose::new(self.joints());
        let mut expected = vec![LocalTransform::default(); rig.joints.len()];
        let mut worst = ClipError::default();
        for pair in self.times.windows(2) {
            for i in 0..=between {
                let time = pair[0] + (pair[1] - pair[0]) * (i as f32 / (between + 1) as f32);
                sample_cached(raw, rig, time, Wrap::Clamp, &mut cache, &mut expected);
                self.sample(time, &mut cursor, &mut pose);
                for (a, b) in expected.iter().zip(pose.iter()) {
                    worst = worst.merged(ClipError::between(a, &b));
                }
            }
        }
        worst
    }
}
