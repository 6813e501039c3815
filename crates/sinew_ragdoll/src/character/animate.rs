//! The pose while clips decide it.

use super::{Character, CharacterEvent, ground};
use crate::character::tuning::{CLIMB_SPEED, HIGHEST_STEP};
use sinew_anim::Animator;
use sinew_math::{Affine, Transform, Vec3, clamp};
use sinew_physics::World;

impl Character {
    /// Takes the clips forward by a step, and the character over the ground with them.
    pub(super) fn animate(&mut self, world: &mut World) {
        let dt = world.def().dt();
        self.keep_pace(dt);
        self.animator.update(self.def.set(), dt);
        self.events.extend(self.animator.events().iter().map(|&fired| CharacterEvent::Clip(fired)));
        self.keep_earlier();
        self.take_pose();
        if let Some(to) = self.ride(world, self.step_of(&self.animator)) {
            self.world_from_character = to;
            self.climbing = 0.0;
            return;
        }
        let from = self.world_from_character;
        let mut to = from * self.step_of(&self.animator);
        let own = self.presence.as_ref().map(|presence| presence.bodies.as_slice());
        if let Some(height) = ground::below(world, to.translation, HIGHEST_STEP, own) {
            to.translation.y += clamp(height - to.translation.y, -CLIMB_SPEED * dt, CLIMB_SPEED * dt);
        }
        self.world_from_character = to;
        let way = to.translation - from.translation;
        self.speed = Vec3::new(way.x, 0.0, way.z).length() / dt;
        self.climbing = (to.translation.y - from.translation.y) / dt;
    }

    /// Motion of the character in the last update of an animator, in its own space.
    pub(super) fn step_of(&self, animator: &Animator) -> Transform {
        let root = self.def.mapping().character_from_model();
        let turn = root.to_rigid().rotation;
        let step = animator.root_motion();
        Transform::new(root.vector(step.translation), turn * step.rotation * turn.inverse())
    }

    /// The animator's pose becomes the character's.
    pub(super) fn take_pose(&mut self) {
        self.pose.clear();
        self.pose.extend(self.animator.pose().iter());
    }

    /// Remembers the present pose as the one before the next.
    pub(super) fn keep_earlier(&mut self) {
        core::mem::swap(&mut self.earlier.pose, &mut self.pose);
        self.earlier.world_from_character = self.world_from_character;
        self.pose.clone_from(&self.earlier.pose);
    }

    /// A copy of the animator, in the place of the last one: it is to be put back into [`Scratch`](super::Scratch).
    pub(super) fn sent_ahead(&mut self) -> Animator {
        match self.scratch.ahead.take() {
            Some(mut ahead) => {
                ahead.copy_from(&self.animator);
                ahead
            }
            None => self.animator.clone(),
        }
    }

    /// Poses of the bodies as an animator that is sent ahead has them after `seconds` more, seen from where the character
    /// stands now. `place` is where the animator has brought it until then.
    pub(super) fn bodies_ahead(
        &mut self,
        ahead: &mut Animator,
        place: &mut Transform,
        seconds: f32,
        out: &mut Vec<Transform>,
    ) {
        ahead.update(self.def.set(), seconds);
        *place = self.gone_on(*place, ahead, seconds);
        let mut pose = core::mem::take(&mut self.scratch.pose);
        pose.clear();
        pose.extend(ahead.pose().iter());
        self.place_feet(self.planting.ahead(seconds), &mut pose);
        self.clear_floor(seconds, &mut pose);
        self.hold_feet(*place, seconds, &mut pose);
        self.bodies_of(&pose, *place, out);
        self.scratch.pose = pose;
    }

    /// World poses of the bodies for a pose of a character at `place`.
    pub(super) fn bodies_of(
        &mut self,
        pose: &[sinew_anim::LocalTransform],
        place: Transform,
        out: &mut Vec<Transform>,
    ) {
        let (mapping, scratch) = (self.def.mapping(), &mut self.scratch);
        if !mapping.bodies_from_pose(pose, place, &mut scratch.frames, out) {
            sinew_anim::local_to_model(&self.def.rig, pose, &Affine::IDENTITY, &mut scratch.model);
            mapping.bodies_from_model(&scratch.model, place, out);
        }
    }
}
