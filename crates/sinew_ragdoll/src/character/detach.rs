//! Detaching a limb: the limb's bodies in the world, and the character's remaining bodies.

use super::CharacterDef;
use super::limb::{cut_joint, shrunk};
use super::physique::Physique;
use super::tuning::FAR_BELOW;
use crate::drive::hangs_on;
use crate::ragdoll::{BodyState, Ragdoll};
use crate::tuning::TOLERATED;
use sinew_anim::JointIdx;
use sinew_math::{Affine, Transform, Vec3};
use sinew_physics::{BodyId, JointId, World};

/// Roles of parts without which a character still gets up.
const SPARED: [&str; 5] = ["Shoulder", "Arm", "Hand", "Toes", "tail"];
/// Words in the roles of fingers, without which a character also gets up.
const FINGERS: [&str; 5] = ["Thumb", "Index", "Middle", "Ring", "Little"];

impl Physique {
    /// Returns the indices of a body and of its descendants that were not detached before.
    pub fn limb_from(&self, def: &CharacterDef, first: usize) -> Vec<usize> {
        let all = 0..def.ragdoll.bodies.len();
        all.filter(|&body| hangs_on(&def.ragdoll, body, first) && self.has(body)).collect()
    }

    /// Returns the joints of the rig whose skin was detached, ascending.
    pub fn lost_joints(&self, def: &CharacterDef) -> Vec<JointIdx> {
        let carrier = |joint: JointIdx| def.mapping().body_above(&def.rig, joint);
        let is_lost = |&joint: &JointIdx| carrier(joint).is_some_and(|body| !self.has(body));
        if self.lost.is_empty() {
            return Vec::new();
        }
        (0..def.rig.joints.len()).filter(is_lost).collect()
    }

    /// Returns true if no part without which the character cannot stand was detached.
    pub fn may_get_up(&self, def: &CharacterDef) -> bool {
        self.lost.iter().all(|&(body, _)| {
            let role = &def.ragdoll.bodies[body].role;
            SPARED.iter().chain(&FINGERS).any(|part| role.contains(part))
        })
    }

    /// Cuts off a ragdoll's limb, releases its drives, and returns its bodies and joints.
    pub fn cut(
        &mut self,
        def: &CharacterDef,
        parts: &[usize],
        world: &mut World,
    ) -> (Vec<BodyId>, Vec<JointId>) {
        let ragdoll = self.ragdoll.as_ref().expect("the body exists");
        self.drives.release_bodies(world, ragdoll, parts);
        cut_joint(world, ragdoll.joints[parts[0] - 1]);
        let joints: Vec<JointId> = parts[1..].iter().map(|&part| ragdoll.joints[part - 1]).collect();
        for (&joint, &part) in joints.iter().zip(&parts[1..]) {
            world.set_joint_friction(joint, def.ragdoll.joints[part - 1].friction_torque);
        }
        (parts.iter().map(|&part| ragdoll.bodies[part]).collect(), joints)
    }

    /// Turns a limb whose bodies are kinematic or not in the world into dynamic bodies with the velocities of `states`,
    /// and returns its bodies and joints.
    pub fn cut_led(
        &self,
        def: &CharacterDef,
        parts: &[usize],
        mut states: Vec<BodyState>,
        world: &mut World,
    ) -> (Vec<BodyId>, Vec<JointId>) {
        let gone: Vec<(usize, BodyId)> = (0..states.len())
            .filter(|index| !parts.contains(index))
            .map(|index| (index, BodyId::from_bits(u64::MAX)))
            .collect();
        let ragdoll = if self.ids().is_empty() {
            Ragdoll::spawn_without(world, &def.ragdoll, &states, &def.body_settings, &gone)
        } else {
            for &part in parts {
                states[part] =
                    BodyState { world_from_body: world.transform(self.ids()[part]), ..states[part] };
            }
            let lost: Vec<usize> = gone.iter().map(|&(index, _)| index).collect();
            Ragdoll::wake_without(world, &def.ragdoll, self.ids(), &states, &lost)
        };
        let bodies = parts.iter().map(|&part| ragdoll.bodies[part]).collect();
        (bodies, parts[1..].iter().map(|&part| ragdoll.joints[part - 1]).collect())
    }

    /// Records the bodies with the indices `parts` as detached.
    pub fn lose(&mut self, parts: &[usize], bodies: &[BodyId]) {
        self.lost.extend(parts.iter().copied().zip(bodies.iter().copied()));
        self.lost.sort_unstable_by_key(|&(part, _)| part);
        self.keep_own();
    }

    /// Enables collision between the limb and the remaining bodies; pairs that overlap at the cut collide once they
    /// have separated.
    pub fn part_bodies(&mut self, bodies: &[BodyId], world: &mut World) {
        let mut parting = core::mem::take(&mut self.parting);
        for &own in self.own() {
            for &body in bodies {
                if world.overlap(own, body) > TOLERATED {
                    world.disable_pair(own, body);
                    parting.push((own, body));
                } else {
                    world.enable_pair(own, body);
                }
            }
        }
        self.parting = parting;
    }

    /// Enables collision of bodies that have separated since the cut.
    pub fn mind_parting(&mut self, world: &mut World) {
        self.parting.retain(|&(a, b)| {
            if !world.contains(a) || !world.contains(b) {
                return false;
            }
            let overlaps = world.overlap(a, b) > 0.0;
            if !overlaps {
                world.enable_pair(a, b);
            }
            overlaps
        });
    }

    /// Returns the skinning matrix of a detached joint, which shrinks its skin to the cut; `None` for a present joint.
    pub fn shrunk_joint(&self, def: &CharacterDef, joint: JointIdx, model: &[Affine]) -> Option<Affine> {
        if self.lost.is_empty() {
            return None;
        }
        let mut body = def.mapping().body_above(&def.rig, joint)?;
        if self.has(body) {
            return None;
        }
        loop {
            let above = def.ragdoll.joints[body - 1].parent;
            if self.has(above) {
                return Some(shrunk(model[def.ragdoll.bodies[body].joint].translation));
            }
            body = above;
        }
    }

    /// Moves detached bodies to a position where springs do not touch them.
    pub fn hide_lost(&self, bodies: &mut [Transform]) {
        for &(lost, _) in &self.lost {
            if let Some(body) = bodies.get_mut(lost) {
                *body = Transform::from_translation(Vec3::Y * FAR_BELOW);
            }
        }
    }
}
