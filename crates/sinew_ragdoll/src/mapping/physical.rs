//! Converts body poses to poses of every joint of the rig.

use super::{Follow, Mapping, with_scale_of};
use sinew_anim::{LocalTransform, Rig, local_to_model};
use sinew_math::{Affine, Transform, max};

/// Converts body poses into poses of the rig, based on the character's pose when its bodies took over. The buffers are
/// reused.
#[derive(Clone, Debug, Default)]
pub struct Physical {
    base: Vec<LocalTransform>,
    base_model: Vec<Affine>,
    /// For each body, transform from character space to the body in the base pose.
    body_from_character: Vec<Transform>,
    /// Motion of each body since the base pose, in model space.
    moved: Vec<Affine>,
    model: Vec<Affine>,
}

impl Physical {
    /// Sets a flat pose as the base: joints that no body drives keep it, driven joints keep its scale and, except the
    /// pelvis, its translation.
    pub fn rebase(&mut self, mapping: &Mapping, rig: &Rig, base: &[LocalTransform]) {
        self.base.clear();
        self.base.extend_from_slice(base);
        local_to_model(rig, base, &Affine::IDENTITY, &mut self.base_model);
        self.body_from_character.clear();
        self.body_from_character.extend(mapping.bones.iter().map(|&(joint, bone_from_body)| {
            (mapping.bone(&self.base_model[joint]) * bone_from_body).inverse()
        }));
    }

    /// Returns the base pose of the last [`rebase`](Self::rebase).
    pub fn base(&self) -> &[LocalTransform] {
        &self.base
    }

    /// Computes the pose of all joints for bodies at `world_from_body`, relative to a character at
    /// `world_from_character`. Returns the hidden stretch, metres: the largest distance between a bone's position on
    /// its body and its position in the pose, in which bones cannot stretch.
    ///
    /// # Panics
    /// If there is no base pose, or not one pose per body.
    pub fn pose(
        &mut self,
        mapping: &Mapping,
        rig: &Rig,
        world_from_character: Transform,
        world_from_body: &[Transform],
        pose: &mut [LocalTransform],
    ) -> f32 {
        let base = core::mem::take(&mut self.base);
        let stretch = self.pose_over(mapping, rig, &base, world_from_character, world_from_body, pose);
        self.base = base;
        stretch
    }

    /// Like [`pose`](Self::pose), with the undriven joints from `resting` instead of the base pose. `resting` is a later
    /// pose of the same bone lengths.
    ///
    /// # Panics
    /// As for [`pose`](Self::pose), or if `resting` has another length.
    pub fn pose_over(
        &mut self,
        mapping: &Mapping,
        rig: &Rig,
        resting: &[LocalTransform],
        world_from_character: Transform,
        world_from_body: &[Transform],
        pose: &mut [LocalTransform],
    ) -> f32 {
        assert_eq!(resting.len(), rig.joints.len(), "a base pose was given");
        assert_eq!(world_from_body.len(), mapping.bones.len(), "every body has a pose");
        let character_from_world = world_from_character.inverse();
        self.moved.clear();
        self.moved.extend(
            world_from_body
                .iter()
                .zip(&self.body_from_character)
                .map(|(&now, &base)| mapping.in_model(character_from_world * now * base)),
        );
        self.model.clear();
        let mut stretch = 0.0;
        for (joint, node) in rig.joints.iter().enumerate() {
            let parent = node.parent.map_or(Affine::IDENTITY, |parent| self.model[parent]);
            pose[joint] = resting[joint];
            if let Some(driven) = mapping.driven[joint] {
                let wanted = self.moved[driven.body] * self.base_model[joint];
                let followed = with_scale_of(&resting[joint], &(parent.inverse() * wanted));
                pose[joint].rotation = followed.rotation;
                match driven.follow {
                    Follow::Move => pose[joint].translation = followed.translation,
                    Follow::Turn => {
                        let gap = parent.point(pose[joint].translation) - wanted.translation;
                        stretch = max(stretch, mapping.character_from_model.vector(gap).length());
                    }
                }
            }
            self.model.push(parent * pose[joint].to_affine());
        }
        stretch
    }
}
