//! The pose while clips decide it.

use super::{Character, CharacterDef, Locomotion, State, ground};
use sinew_anim::{LocalTransform, SampleCache, Wrap, crossfade, sample_cached, smoothstep};
use sinew_math::{Rotation, Transform, Vec3, clamp};
use sinew_physics::World;

/// A clip that plays, and the pose that it is faded in from.
#[derive(Clone, Debug, Default)]
pub(super) struct Motion {
    /// `None`: the rest pose.
    pub clip: Option<usize>,
    pub wrap: Wrap,
    /// Clip time at `time` 0, seconds.
    pub phase: f32,
    /// Seconds since it began.
    pub time: f32,
    /// Flat pose at `time` 0; not used when `fade` is 0.
    pub from: Vec<LocalTransform>,
    /// Seconds of the fade.
    pub fade: f32,
    /// `time` at which it is over; a looped clip never is.
    pub ends: f32,
    pub cache: SampleCache,
}

impl Motion {
    /// The looped clip of a character, at once.
    pub fn looping(def: &CharacterDef, phase: f32) -> Self {
        Self { clip: def.looped, wrap: Wrap::Loop, phase, ends: f32::INFINITY, ..Self::default() }
    }

    /// The flat pose at `time`, a pure function of it.
    pub fn pose_at(
        &mut self,
        def: &CharacterDef,
        time: f32,
        target: &mut [LocalTransform],
        pose: &mut [LocalTransform],
    ) {
        match self.clip {
            Some(clip) => {
                let at = self.phase + time;
                sample_cached(&def.clips[clip], &def.rig, at, self.wrap, &mut self.cache, target);
                def.mapping().flatten(&def.rig, target);
            }
            None => target.copy_from_slice(def.rest()),
        }
        // Before the start there is a pose, too: that of a hit right at the start asks how it got there.
        if self.fade > 0.0 && time < self.fade {
            // Aligned to the target's hemisphere: the rest pose's may lie between two that are turned far from it.
            crossfade(target, &self.from, target, smoothstep(time / self.fade), pose);
        } else {
            pose.copy_from_slice(target);
        }
    }
}

/// Velocity of a walking character, m/s, world axes.
pub(super) fn locomotion(def: &CharacterDef, world_from_character: Rotation) -> Vec3 {
    match def.locomotion {
        Locomotion::Forward { speed } if def.looped.is_some() => world_from_character * Vec3::Z * speed,
        Locomotion::Forward { .. } | Locomotion::InPlace => Vec3::ZERO,
    }
}

/// How fast the height of the character's origin follows the ground, m/s: a step of a stair takes a few frames.
const CLIMB_SPEED: f32 = 1.2;

impl Character {
    /// Evaluates the clip's pose now.
    pub(super) fn animate(&mut self) {
        let time = self.motion.time;
        self.motion.pose_at(&self.def, time, &mut self.scratch.pose, &mut self.pose);
    }

    /// Moves the origin over the ground by one step.
    pub(super) fn walk(&mut self, world: &World) {
        let dt = world.def().dt();
        let from = self.world_from_character.translation;
        let mut to = from + locomotion(&self.def, self.world_from_character.rotation) * dt;
        if let Some(height) = ground::below(world, to, ground::HIGHEST_STEP) {
            to.y += clamp(height - to.y, -CLIMB_SPEED * dt, CLIMB_SPEED * dt);
        }
        self.world_from_character.translation = to;
        self.root_velocity = (to - from) / dt;
    }

    /// World poses of the bodies as the animation has them `offset` seconds from now.
    pub(super) fn animated_bodies(&mut self, offset: f32, out: &mut Vec<Transform>) {
        debug_assert!(self.state != State::Limp, "a limp character has bodies of its own");
        let time = self.motion.time + offset;
        let mut pose = core::mem::take(&mut self.scratch.pose);
        // The present pose is evaluated again afterwards, so its buffer can hold this one.
        self.motion.pose_at(&self.def, time, &mut pose, &mut self.pose);
        self.scratch.pose = pose;
        let place = Transform::new(
            self.world_from_character.translation + self.root_velocity * offset,
            self.world_from_character.rotation,
        );
        self.bodies_of_pose(place, out);
    }

    /// World poses of the bodies for the pose that the character holds.
    pub(super) fn bodies_of_pose(&mut self, world_from_character: Transform, out: &mut Vec<Transform>) {
        sinew_anim::local_to_model(
            &self.def.rig,
            &self.pose,
            &sinew_math::Affine::IDENTITY,
            &mut self.scratch.model,
        );
        self.def.mapping().bodies_from_model(&self.scratch.model, world_from_character, out);
    }
}
