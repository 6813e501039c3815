//! A motion as one pose per frame, for capture and clean-up.

use crate::clip::sample::{SampleCache, Wrap, sample_cached};
use crate::clip::{Channel, Clip, Interpolation, Property};
use crate::rig::{JointIdx, LocalTransform, Rig};
use sinew_math::Rotation;

/// Poses of one rig at equal time steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Take {
    /// Seconds from frame to frame, above 0.
    pub frame_time: f64,
    /// Joints of the rig, at least 1.
    pub joints: usize,
    /// Local transforms, frame by frame, `joints` for each.
    pub poses: Vec<LocalTransform>,
}

impl Take {
    /// Largest number of frames of a take, hours of motion. It bounds the memory that a file can request.
    pub const MOST_FRAMES: usize = 1 << 20;

    /// Samples a clip every `frame_time` seconds, from its start to its end. The last frame is the one nearest to the
    /// end.
    ///
    /// # Panics
    /// If `frame_time` is not above 0, the rig has no joints, or the take would have more than
    /// [`MOST_FRAMES`](Self::MOST_FRAMES) frames; and under the conditions of
    /// [`sample`](crate::clip::sample::sample()).
    pub fn of(rig: &Rig, clip: &Clip, frame_time: f64) -> Self {
        assert!(frame_time > 0.0, "frame_time must be positive, not {frame_time} s");
        assert!(!rig.joints.is_empty(), "the rig must have joints");
        let joints = rig.joints.len();
        let frames = frames_of(clip.duration, frame_time);
        assert!(frames <= Self::MOST_FRAMES, "{frames} frames exceed the limit of a take");
        let mut poses = vec![LocalTransform::default(); frames * joints];
        let mut cache = SampleCache::default();
        for (frame, pose) in poses.chunks_exact_mut(joints).enumerate() {
            let time = (frame as f64 * frame_time) as f32;
            sample_cached(clip, rig, time, Wrap::Clamp, &mut cache, pose);
        }
        Self { frame_time, joints, poses }
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.poses.len() / self.joints
    }

    /// Seconds from the first to the last frame.
    pub fn duration(&self) -> f64 {
        self.frames().saturating_sub(1) as f64 * self.frame_time
    }

    /// Time of a frame, seconds.
    pub fn time(&self, frame: usize) -> f32 {
        (frame as f64 * self.frame_time) as f32
    }

    /// Number of frames in a time (seconds), rounded.
    pub fn frames_in(&self, seconds: f32) -> usize {
        (f64::from(seconds) / self.frame_time).round() as usize
    }

    /// Returns the pose of a frame.
    ///
    /// # Panics
    /// If the frame is out of range.
    pub fn pose(&self, frame: usize) -> &[LocalTransform] {
        &self.poses[frame * self.joints..(frame + 1) * self.joints]
    }

    /// Returns the pose of a frame, mutable.
    ///
    /// # Panics
    /// If the frame is out of range.
    pub fn pose_mut(&mut self, frame: usize) -> &mut [LocalTransform] {
        &mut self.poses[frame * self.joints..(frame + 1) * self.joints]
    }

    /// Iterates over the local transforms of one joint, frame by frame.
    pub fn of_joint(&self, joint: JointIdx) -> impl Iterator<Item = LocalTransform> + '_ {
        self.poses.iter().skip(joint).step_by(self.joints).copied()
    }

    /// Converts the take to a clip with one key per frame. Joints in the rest pose get no channel, other constant
    /// joints one key.
    ///
    /// # Panics
    /// If the take does not fit the rig.
    pub fn to_clip(&self, rig: &Rig, name: &str) -> Clip {
        assert_eq!(self.joints, rig.joints.len(), "the take must fit the rig");
        let times: Vec<f32> = (0..self.frames()).map(|frame| self.time(frame)).collect();
        let mut channels = Vec::new();
        for (joint, rest) in rig.joints.iter().map(|joint| joint.rest).enumerate() {
            for property in [Property::Translation, Property::Rotation, Property::Scale] {
                let mut last = rest.rotation;
                let key = |local: LocalTransform| {
                    last = local.rotation.toward(last);
                    numbers(LocalTransform { rotation: last, ..local }, property)
                };
                let values: Vec<f32> = self.of_joint(joint).flat_map(key).collect();
                if let Some(keys) = keys_needed(&values, &numbers(rest, property)) {
                    let (times, values) =
                        (times[..keys].to_vec(), values[..keys * property.width()].to_vec());
                    channels.push(Channel {
                        joint,
                        property,
                        interpolation: Interpolation::Linear,
                        times,
                        values,
                    });
                }
            }
        }
        Clip { name: name.to_owned(), duration: self.duration() as f32, channels }
    }
}

/// Number of frames in a clip's duration (seconds), including the first and the last.
pub(crate) fn frames_of(duration: f32, frame_time: f64) -> usize {
    (f64::from(duration) / frame_time).round() as usize + 1
}

fn numbers(local: LocalTransform, property: Property) -> Vec<f32> {
    let Rotation { x, y, z, w } = local.rotation;
    match property {
        Property::Translation => local.translation.to_array().to_vec(),
        Property::Rotation => vec![x, y, z, w],
        Property::Scale => local.scale.to_array().to_vec(),
    }
}

/// Number of keys needed: all, one for constant values, none for rest values.
fn keys_needed(values: &[f32], rest: &[f32]) -> Option<usize> {
    let first = &values[..rest.len()];
    let alike = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-6 * (1.0 + b.abs()));
    if values.chunks_exact(rest.len()).any(|key| !alike(key, first)) {
        return Some(values.len() / rest.len());
    }
    (!alike(first, rest)).then_some(1)
}
