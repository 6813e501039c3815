//! Limbs that are cut off: what becomes bodies of their own, and how the rest lives on.

use super::limb::{Limb, cut_joint, shrunk};
use super::memory::Stillness;
use super::tuning::FAR_BELOW;
use super::{Character, CharacterEvent, State};
use crate::drive::hangs_on;
use crate::owner::{OwnerKind, owner};
use crate::ragdoll::{BodyState, Ragdoll};
use crate::tuning::TOLERATED;
use sinew_anim::{JointIdx, local_to_model};
use sinew_math::{Affine, Transform, Vec3};
use sinew_physics::{BodyId, ContactRule, JointId, ShapeId, World, Yields};

/// Parts of roles that a character gets up without.
const SPARED: [&str; 5] = ["Shoulder", "Arm", "Hand", "Toes", "tail"];
/// Words in the roles of fingers, which it gets up without as well.
const FINGERS: [&str; 5] = ["Thumb", "Index", "Middle", "Ring", "Little"];

impl Character {
    /// Cuts a limb off: the body called so, by role or bone, and all that hang on it. They are bodies of their own from now on, as fast as they were, in
    /// whatever state the character is; who holds them goes on holding them. What they held themselves is dropped, garments hang on what is left.
    ///
    /// The character lives on. Without an arm or a hand it does all that it did. Without a leg, a foot, the head or a part of the trunk it goes limp, and does not
    /// get up again. [`bodies`](Self::bodies) keeps its order: the ids of the limb's bodies stay where they were, and [`has_body`](Self::has_body) is false of them.
    ///
    /// `None` if it has lost that body already.
    ///
    /// ```
    /// use sinew_math::Transform;
    /// use sinew_physics::{BodyDef, Shape, World, WorldDef};
    /// use sinew_ragdoll::Character;
    /// use std::sync::Arc;
    ///
    /// let mut world = World::new(WorldDef::default());
    /// world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    /// let def = Arc::new(sinew::mannequin::character());
    /// let mut knight = Character::spawn(&mut world, &def, Transform::IDENTITY);
    /// let arm = knight.detach(&mut world, "leftUpperArm").expect("it has that arm");
    /// assert_eq!(arm.parts().len(), 3, "upper arm, lower arm and hand");
    /// assert!(knight.detach(&mut world, "leftHand").is_none(), "the hand went with the arm");
    /// for _ in 0..90 {
    ///     world.step();
    ///     knight.update(&mut world);
    /// }
    /// assert!(world.transform(arm.bodies()[0]).translation.y < 0.2, "it lies on the ground");
    /// ```
    ///
    /// # Panics
    /// If no body is called so, or it is the first of the definition, the pelvis.
    #[track_caller]
    pub fn detach(&mut self, world: &mut World, bone: &str) -> Option<Limb> {
        let def = self.def.clone();
        let first = def.body_named(bone).unwrap_or_else(|| panic!("no body is called '{bone}'"));
        assert!(first > 0, "a character is what hangs on its pelvis: cut off the legs or the trunk");
        if !self.has_body(first) {
            return None;
        }
        let all = 0..def.ragdoll.bodies.len();
        let parts: Vec<usize> =
            all.filter(|&body| hangs_on(&def.ragdoll, body, first) && self.has_body(body)).collect();
        let was_clearing = self.is_clearing();
        self.end_clearing(world);
        self.drop_from(world, &parts);
        let world_from_joint = self.world_from_joints();
        let (bodies, joints) = self.part_with(world, &parts);
        let poses: Vec<Transform> = bodies.iter().map(|&body| world.transform(body)).collect();
        for &body in &bodies {
            // It pushes as any body does, and is in nobody's way.
            let rule = ContactRule::Yields(Yields::default());
            world.set_contact_rule(ShapeId { body, shape: 0 }, rule);
        }
        self.lost.extend(parts.iter().copied().zip(bodies.iter().copied()));
        self.lost.sort_unstable_by_key(|&(part, _)| part);
        self.keep_own();
        self.part_bodies(world, &bodies);
        let limb = Limb::new(def, parts, bodies, joints, &world_from_joint, &poses);
        limb.own(world);
        self.live_on(world);
        self.rehang(world);
        if was_clearing {
            self.clear(world);
        }
        self.events.push(CharacterEvent::Detached { body: first });
        Some(limb)
    }

    /// True if a body, by index in the definition, was not cut off.
    pub fn has_body(&self, body: usize) -> bool {
        self.lost.iter().all(|&(lost, _)| lost != body)
    }

    /// Joints of the rig whose skin went with what was cut off, ascending: what is drawn of the character leaves them out.
    pub fn lost_joints(&self) -> Vec<JointIdx> {
        let carrier = |joint: JointIdx| self.def.mapping().body_above(&self.def.rig, joint);
        let is_lost = |&joint: &JointIdx| carrier(joint).is_some_and(|body| !self.has_body(body));
        if self.lost.is_empty() {
            return Vec::new();
        }
        (0..self.def.rig.joints.len()).filter(is_lost).collect()
    }

    /// True if nothing is missing that it would need to stand.
    pub(super) fn may_get_up(&self) -> bool {
        self.lost.iter().all(|&(body, _)| {
            let role = &self.def.ragdoll.bodies[body].role;
            SPARED.iter().chain(&FINGERS).any(|part| role.contains(part))
        })
    }

    /// Bodies in the world that are still its own.
    pub(super) fn own(&self) -> &[BodyId] {
        if self.lost.is_empty() { self.bodies() } else { &self.kept }
    }

    /// Finds which bodies are its own, after its bodies or what it has lost have changed.
    pub(super) fn keep_own(&mut self) {
        let lost: Vec<usize> = self.lost.iter().map(|&(body, _)| body).collect();
        let mut kept = core::mem::take(&mut self.kept);
        kept.clear();
        if !lost.is_empty() {
            let own = self.bodies().iter().enumerate().filter(|(index, _)| !lost.contains(index));
            kept.extend(own.map(|(_, &id)| id));
        }
        self.kept = kept;
        if let Some(ragdoll) = &mut self.ragdoll {
            ragdoll.colliding.retain(|pair| {
                let is_lost = |id: BodyId| lost.iter().any(|&index| ragdoll.bodies[index] == id);
                !is_lost(pair.0) && !is_lost(pair.1)
            });
            ragdoll.lost = lost;
        }
    }

    /// Makes its bodies and joints in the world its own, so that no other call takes them out.
    pub(super) fn mark_own(&self, world: &mut World) {
        let def = &self.def.ragdoll;
        if let Some(ragdoll) = &self.ragdoll {
            return ragdoll.own(world, def, OwnerKind::Character);
        }
        let has = |&(index, _): &(usize, BodyId)| self.has_body(index);
        let own = self.bodies().iter().copied().enumerate().filter(has);
        let (parts, bodies): (Vec<usize>, Vec<BodyId>) = own.unzip();
        world.own_bodies(&owner(def, OwnerKind::Character), &bodies, &parts);
    }

    /// Poses of its bodies, in `scratch.after`; one that was cut off is where it would be at rest.
    pub(super) fn body_poses(&mut self, world: &World) {
        let ragdoll = self.ragdoll.as_ref().expect("it has bodies");
        ragdoll.poses(world, &mut self.scratch.after);
        for &(body, _) in &self.lost {
            let above = self.def.ragdoll.joints[body - 1].parent;
            self.scratch.after[body] = self.scratch.after[above] * self.rest_below(above, body);
        }
    }

    /// Pose of a body seen from one that it hangs on, at rest.
    fn rest_below(&self, above: usize, body: usize) -> Transform {
        let bind = |body: usize| self.def.ragdoll.bodies[body].character_from_body;
        bind(above).inverse() * bind(body)
    }

    /// World transform of every joint of the rig in the pose that is shown.
    fn world_from_joints(&self) -> Vec<Affine> {
        let mut places = Vec::new();
        local_to_model(&self.def.rig, self.pose(), &self.world_from_model(), &mut places);
        places
    }

    /// Lets go of what these bodies hold.
    fn drop_from(&mut self, world: &mut World, parts: &[usize]) {
        let holds = self.presence.iter().flat_map(|presence| &presence.holds);
        let dropped: Vec<BodyId> =
            holds.filter(|hold| parts.contains(&(hold.body as usize))).map(|hold| hold.held).collect();
        for held in dropped {
            self.release(world, held);
        }
    }

    /// Bodies and joints of what is cut off, free of drives, at the velocities that they have: those that it has, or new ones of a character without any.
    fn part_with(&mut self, world: &mut World, parts: &[usize]) -> (Vec<BodyId>, Vec<JointId>) {
        if self.ragdoll.is_some() {
            self.slow_led(world, parts);
            let ragdoll = self.ragdoll.as_ref().expect("it has one");
            self.drives.release_bodies(world, ragdoll, parts);
            cut_joint(world, ragdoll.joints[parts[0] - 1]);
            let joints: Vec<JointId> = parts[1..].iter().map(|&part| ragdoll.joints[part - 1]).collect();
            for (&joint, &part) in joints.iter().zip(&parts[1..]) {
                world.set_joint_friction(joint, self.def.ragdoll.joints[part - 1].friction_torque);
            }
            return (parts.iter().map(|&part| ragdoll.bodies[part]).collect(), joints);
        }
        let mut states = self.carried();
        let def = self.def.clone();
        let gone: Vec<(usize, BodyId)> = (0..states.len())
            .filter(|index| !parts.contains(index))
            .map(|index| (index, BodyId::from_bits(u64::MAX)))
            .collect();
        let ragdoll = if self.bodies().is_empty() {
            Ragdoll::spawn_without(world, &def.ragdoll, &states, &def.body_settings, &gone)
        } else {
            let bodies = self.bodies().to_vec();
            for &part in parts {
                states[part] = BodyState { world_from_body: world.transform(bodies[part]), ..states[part] };
            }
            let lost: Vec<usize> = gone.iter().map(|&(index, _)| index).collect();
            Ragdoll::wake_without(world, &def.ragdoll, &bodies, &states, &lost)
        };
        let bodies = parts.iter().map(|&part| ragdoll.bodies[part]).collect();
        (bodies, parts[1..].iter().map(|&part| ragdoll.joints[part - 1]).collect())
    }

    /// Has what was cut off and what is left collide, but for what overlaps where it was cut: that does as soon as it is apart.
    fn part_bodies(&mut self, world: &mut World, bodies: &[BodyId]) {
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

    /// Has bodies collide that have come apart since they were cut.
    pub(super) fn mind_parting(&mut self, world: &mut World) {
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

    /// Goes on without what was cut off.
    fn live_on(&mut self, world: &mut World) {
        self.scratch.posed.clear();
        if let Some(presence) = &mut self.presence {
            presence.stumble = None;
        }
        match self.state {
            // What lay still may fall.
            State::Limp => {
                let touched = self.stillness.touched;
                self.stillness = Stillness { touched, ..self.stillness };
                (self.stillness.settled, self.stillness.calm_steps) = (false, 0);
            }
            State::Preparing => self.go_limp(world),
            _ if !self.may_get_up() => self.go_limp(world),
            _ => {}
        }
    }

    /// The matrix by which a skin's joint that was cut off is drawn: all of its skin in the point where it was cut; `None` of a joint that it has.
    pub(super) fn shrunk_joint(&self, joint: JointIdx, model: &[Affine]) -> Option<Affine> {
        if self.lost.is_empty() {
            return None;
        }
        let mut body = self.def.mapping().body_above(&self.def.rig, joint)?;
        if self.has_body(body) {
            return None;
        }
        loop {
            let above = self.def.ragdoll.joints[body - 1].parent;
            if self.has_body(above) {
                return Some(shrunk(model[self.def.ragdoll.bodies[body].joint].translation));
            }
            body = above;
        }
    }

    /// Puts the bodies that were cut off where springs do not meet them.
    pub(super) fn hide_lost(&self, bodies: &mut [Transform]) {
        for &(lost, _) in &self.lost {
            if let Some(body) = bodies.get_mut(lost) {
                *body = Transform::from_translation(Vec3::Y * FAR_BELOW);
            }
        }
    }
}
