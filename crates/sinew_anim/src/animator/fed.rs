//! A clip whose pose comes from the user.

use super::Animator;
use super::advance::SHORTEST;
use crate::pose::Pose;
use crate::rig::LocalTransform;
use crate::set::{AnimationSet, ClipId};
use crate::tuning::LONGEST_EXTRAPOLATION;
use sinew_math::{Rotation, min};

/// A fed clip, with the last two poses that it got.
#[derive(Clone, Debug)]
pub(super) struct Fed {
    pub clip: ClipId,
    pub now: Pose,
    /// The previous pose; `now` at the start.
    pub before: Pose,
    /// Seconds between both poses.
    pub seconds: f32,
    /// Seconds since the update for which `now` was given.
    pub age: f32,
    /// True until the first update with `now`.
    pub is_new: bool,
}

impl Animator {
    /// Sets the pose of a clip from the next update on; the clip's tracks then show this pose instead of its channels.
    /// For motion from another engine or from hand tracking, use a clip without channels, and call this method before
    /// each update.
    ///
    /// Events and root motion remain those of the clip. In an update without a new pose, as in an animator that looks
    /// ahead, joints continue at their last velocity for at most 0.1 s. Only one clip at a time can have such a pose.
    /// Only the first call allocates.
    ///
    /// # Panics
    /// If the clip is not in the set, or the pose has another number of joints.
    pub fn feed(&mut self, set: &AnimationSet, clip: ClipId, pose: &Pose) {
        assert!(set.has_clip(clip.0).is_some(), "a clip of the set");
        assert_eq!(pose.len(), set.skeleton().len(), "a pose of the same rig");
        match &mut self.fed {
            Some(fed) if fed.clip == clip => fed.take(pose),
            fed => *fed = Some(Fed::new(clip, pose)),
        }
    }
}

impl Fed {
    pub fn new(clip: ClipId, pose: &Pose) -> Self {
        Self { clip, now: pose.clone(), before: pose.clone(), seconds: 0.0, age: 0.0, is_new: true }
    }

    fn take(&mut self, pose: &Pose) {
        if !self.is_new {
            core::mem::swap(&mut self.now, &mut self.before);
        }
        self.now.copy_from(pose);
        self.is_new = true;
    }

    pub fn copy_from(&mut self, other: &Self) {
        self.now.copy_from(&other.now);
        self.before.copy_from(&other.before);
        (self.clip, self.seconds) = (other.clip, other.seconds);
        (self.age, self.is_new) = (other.age, other.is_new);
    }

    pub fn advance(&mut self, seconds: f32) {
        if self.is_new {
            (self.seconds, self.age, self.is_new) = (self.age + seconds, 0.0, false);
        } else {
            self.age += seconds;
        }
    }

    pub fn sample(&self, pose: &mut Pose) {
        let ahead = min(self.age, LONGEST_EXTRAPOLATION);
        if self.is_new || ahead == 0.0 || self.seconds < SHORTEST as f32 {
            return pose.copy_from(if self.is_new { &self.before } else { &self.now });
        }
        for joint in 0..self.now.len() {
            pose.set(joint, &onward(&self.before.get(joint), &self.now.get(joint), ahead / self.seconds));
        }
    }
}

/// Extrapolates a joint by `share` of its last displacement.
fn onward(before: &LocalTransform, now: &LocalTransform, share: f32) -> LocalTransform {
    let turn = (now.rotation * before.rotation.inverse()).to_scaled_axis();
    LocalTransform {
        translation: now.translation + (now.translation - before.translation) * share,
        rotation: (Rotation::from_scaled_axis(turn * share) * now.rotation).normalize(),
        scale: now.scale + (now.scale - before.scale) * share,
    }
}
