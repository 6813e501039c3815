//! Pose and transform of a character: the present ones, those one step ago, and the shown ones.

use super::CharacterDef;
use super::pose_similarity::Stance;
use sinew_anim::{Animator, LocalTransform, Pose, local_to_model};
use sinew_math::{Affine, Transform, Vec3};
use sinew_physics::Velocity;

/// Pose and transform at a given time.
#[derive(Clone, Debug)]
pub(super) struct Moment {
    pub pose: Vec<LocalTransform>,
    pub place: Transform,
}

/// Pose and transform of a character.
#[derive(Clone, Debug)]
pub(super) struct Figure {
    /// Pose from bodies or clips, without planted feet, springs and garments.
    pub pose: Vec<LocalTransform>,
    /// Transform from the character to the world.
    pub place: Transform,
    /// Pose and transform one step ago.
    pub earlier: Moment,
    /// Pose and transform as shown at the end of the last step, with feet, springs and garments.
    pub shown: Moment,
}

impl Figure {
    pub fn new(pose: Vec<LocalTransform>, place: Transform) -> Self {
        let moment = Moment { pose: pose.clone(), place };
        Self { pose, place, earlier: moment.clone(), shown: moment }
    }

    /// Copies the animator's pose.
    pub fn take(&mut self, animator: &Animator) {
        self.pose.clear();
        self.pose.extend(animator.pose().iter());
    }

    /// Stores the present pose as the previous one.
    pub fn keep_earlier(&mut self) {
        core::mem::swap(&mut self.earlier.pose, &mut self.pose);
        self.earlier.place = self.place;
        self.pose.clone_from(&self.earlier.pose);
    }

    /// Changes the character's transform while every joint keeps its world pose.
    pub fn reframe(&mut self, def: &CharacterDef, to: Transform) {
        let mapping = def.mapping();
        mapping.reframe(&mut self.pose, self.place, to);
        self.place = to;
        for moment in [&mut self.earlier, &mut self.shown] {
            mapping.reframe(&mut moment.pose, moment.place, to);
            moment.place = to;
        }
    }

    /// Moves the character's transform together with its pose.
    pub fn carry(&mut self, to: Transform) {
        let moved = to * self.place.inverse();
        self.place = to;
        self.earlier.place = moved * self.earlier.place;
        self.shown.place = moved * self.shown.place;
    }

    /// Returns the present pose in the world. Its points may be returned to the [`Scratch`].
    pub fn stance(&self, def: &CharacterDef, scratch: &mut Scratch) -> Stance {
        local_to_model(&def.rig, &self.pose, &Affine::IDENTITY, &mut scratch.model);
        let points = core::mem::take(&mut scratch.points);
        let landmarks = &def.moves().landmarks;
        landmarks.stance(def.mapping(), &scratch.model, self.place, points, &mut scratch.before)
    }

    /// Computes in `pose` the pose between the last shown pose (`alpha` 0) and `now` (1), and returns the transform
    /// between the last shown one and the present one.
    pub fn between(&self, now: &[LocalTransform], alpha: f32, pose: &mut Vec<LocalTransform>) -> Transform {
        pose.clear();
        let (from, to) = (self.shown.place, self.place);
        if self.shown.pose.len() != now.len() {
            pose.extend_from_slice(now);
            return to;
        }
        let between = |(a, b): (&LocalTransform, &LocalTransform)| LocalTransform {
            translation: a.translation * (1.0 - alpha) + b.translation * alpha,
            rotation: a.rotation.nlerp(b.rotation, alpha),
            scale: a.scale * (1.0 - alpha) + b.scale * alpha,
        };
        pose.extend(self.shown.pose.iter().zip(now).map(between));
        Transform::new(
            from.translation * (1.0 - alpha) + to.translation * alpha,
            from.rotation.nlerp(to.rotation, alpha),
        )
    }
}

/// Buffers for reuse; except for `posed` they hold no data between calls.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    /// Poses of the bodies from which the present pose was computed, or empty. While these do not change, the pose need
    /// not be computed again. This is a cache and not state: the results are the same without it.
    pub posed: Vec<Transform>,
    pub ahead: Option<Animator>,
    pub pose: Vec<LocalTransform>,
    pub resting: Pose,
    pub wanted: Vec<LocalTransform>,
    pub model: Vec<Affine>,
    pub frames: Vec<(Transform, f32)>,
    pub points: Vec<Vec3>,
    pub before: Vec<Transform>,
    pub after: Vec<Transform>,
    pub velocities: Vec<Velocity>,
}

impl Scratch {
    /// Computes the world poses of the bodies for a pose of a character at `place`.
    pub fn bodies_of(
        &mut self,
        def: &CharacterDef,
        pose: &[LocalTransform],
        place: Transform,
        out: &mut Vec<Transform>,
    ) {
        let mapping = def.mapping();
        if !mapping.bodies_from_pose(pose, place, &mut self.frames, out) {
            local_to_model(&def.rig, pose, &Affine::IDENTITY, &mut self.model);
            mapping.bodies_from_model(&self.model, place, out);
        }
    }

    /// Computes the world poses of the hit bodies for a pose: [`bodies_of`](Self::bodies_of), but feet are no lower
    /// than their drawn skin.
    pub fn hit_bodies_of(
        &mut self,
        def: &CharacterDef,
        pose: &[LocalTransform],
        place: Transform,
        out: &mut Vec<Transform>,
    ) {
        self.bodies_of(def, pose, place, out);
        let feet = def.foot_bodies();
        if !feet.is_empty() {
            local_to_model(&def.rig, pose, &def.mapping().world_from_model(place), &mut self.model);
            feet.raise(&def.ragdoll, &self.model, out);
        }
    }

    /// Returns a copy of an animator that reuses the buffers in `ahead`. Store the copy in `ahead` after use.
    pub fn sent_ahead(&mut self, animator: &Animator) -> Animator {
        match self.ahead.take() {
            Some(mut ahead) => {
                ahead.copy_from(animator);
                ahead
            }
            None => animator.clone(),
        }
    }
}
