//! Bodies of a character in the world: hit bodies that its clips move, or a ragdoll with drives. Detached bodies no
//! longer belong to them.

use super::CharacterDef;
use super::figure::Scratch;
use crate::drive::Drives;
use crate::mapping::Physical;
use crate::owner::{OwnerKind, owner};
use crate::ragdoll::{BodyState, Ragdoll};
use sinew_anim::Inertia;
use sinew_math::Transform;
use sinew_physics::{BodyId, ContactRule, Velocity, World};

/// Bodies of a character.
#[derive(Clone, Debug)]
pub(super) struct Physique {
    /// Hit bodies, which are also the ragdoll's bodies while there is one.
    pub hit: Vec<BodyId>,
    /// Poses of the bodies in the clips one step ago; empty if unknown.
    pub before: Vec<Transform>,
    pub ragdoll: Option<Ragdoll>,
    pub drives: Drives,
    pub physical: Physical,
    /// Motion of joints without bodies, which decays after the bodies have taken over.
    pub lingering: Inertia,
    /// Detached bodies, by index, with their ids.
    pub lost: Vec<(usize, BodyId)>,
    /// Remaining bodies; empty if none was detached.
    pub kept: Vec<BodyId>,
    /// Pairs of own and detached bodies that overlap. They pass through each other until they have separated.
    pub parting: Vec<(BodyId, BodyId)>,
}

impl Physique {
    pub fn new(def: &CharacterDef) -> Self {
        Self {
            hit: Vec::new(),
            before: Vec::new(),
            ragdoll: None,
            drives: Drives::new(&def.ragdoll),
            physical: Physical::default(),
            lingering: Inertia::default(),
            lost: Vec::new(),
            kept: Vec::new(),
            parting: Vec::new(),
        }
    }

    /// Returns the bodies in the order of the definition, including detached ones; empty for a character without
    /// bodies.
    pub fn ids(&self) -> &[BodyId] {
        self.ragdoll.as_ref().map_or(&self.hit, |ragdoll| &ragdoll.bodies)
    }

    /// Returns the remaining bodies.
    pub fn own(&self) -> &[BodyId] {
        if self.lost.is_empty() { self.ids() } else { &self.kept }
    }

    /// Returns true if a body, by index in the definition, was not detached.
    pub fn has(&self, body: usize) -> bool {
        self.lost.iter().all(|&(lost, _)| lost != body)
    }

    /// Returns the index in the definition of one of the character's bodies.
    pub fn index_of(&self, id: BodyId) -> Option<usize> {
        self.ids().iter().position(|&body| body == id).filter(|&body| self.has(body))
    }

    /// Returns the indices of detached bodies.
    pub fn lost_indices(&self) -> Vec<usize> {
        self.lost.iter().map(|&(body, _)| body).collect()
    }

    /// Updates the list of remaining bodies after a change of the bodies.
    pub fn keep_own(&mut self) {
        let lost = self.lost_indices();
        let mut kept = core::mem::take(&mut self.kept);
        kept.clear();
        if !lost.is_empty() {
            let own = self.ids().iter().enumerate().filter(|(index, _)| !lost.contains(index));
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

    /// Takes ownership of the character's bodies and joints in the world, so that no other call removes them.
    fn mark_own(&self, def: &CharacterDef, world: &mut World) {
        let def = &def.ragdoll;
        if let Some(ragdoll) = &self.ragdoll {
            return ragdoll.own(world, def, OwnerKind::Character);
        }
        let has = |&(index, _): &(usize, BodyId)| self.has(index);
        let own = self.ids().iter().copied().enumerate().filter(has);
        let (parts, bodies): (Vec<usize>, Vec<BodyId>) = own.unzip();
        world.own_bodies(&owner(def, OwnerKind::Character), &bodies, &parts);
    }

    /// Adds hit bodies to the world.
    pub fn enter(&mut self, def: &CharacterDef, poses: &[Transform], rule: ContactRule, world: &mut World) {
        let at = |&world_from_body: &Transform| BodyState { world_from_body, velocity: Velocity::default() };
        let states: Vec<BodyState> = poses.iter().map(at).collect();
        let (ragdoll, settings) = (&def.ragdoll, &def.body_settings);
        self.hit = Ragdoll::spawn_kinematic_without(world, ragdoll, &states, settings, rule, &self.lost);
        self.keep_own();
        self.mark_own(def, world);
    }

    /// Removes the hit bodies from the world.
    pub fn remove_hit(&mut self, world: &mut World) {
        let lost = self.lost_indices();
        for (_, body) in self.hit.drain(..).enumerate().filter(|(index, _)| !lost.contains(index)) {
            world.disown_body(body);
            world.remove_body(body);
        }
        self.before.clear();
        self.keep_own();
    }

    /// Makes the bodies dynamic, with joints between them.
    pub fn wake(&mut self, def: &CharacterDef, states: &[BodyState], rule: ContactRule, world: &mut World) {
        let ragdoll = if self.hit.is_empty() {
            let ragdoll = Ragdoll::spawn_without(world, &def.ragdoll, states, &def.body_settings, &self.lost);
            if rule != ContactRule::Push {
                ragdoll.set_rule(world, rule);
            }
            ragdoll
        } else {
            let lost = self.lost_indices();
            let ragdoll = Ragdoll::wake_without(world, &def.ragdoll, &self.hit, states, &lost);
            ragdoll.set_rule(world, rule);
            ragdoll
        };
        self.ragdoll = Some(ragdoll);
        self.keep_own();
        self.mark_own(def, world);
    }

    /// Sets all drives to those of a fall.
    pub fn let_go(&mut self, def: &CharacterDef, world: &mut World) {
        if let Some(ragdoll) = &self.ragdoll {
            self.drives.release(world, ragdoll);
        }
        self.drives.set_all(def.falling, 0.0);
    }

    /// Sets the contact rules of the bodies while the character has a ragdoll.
    pub fn set_rule(&self, world: &mut World, rule: ContactRule) {
        if let Some(ragdoll) = &self.ragdoll {
            ragdoll.set_rule(world, rule);
        }
    }

    /// Drives the bodies toward poses at velocities, for the next step.
    pub fn drive(
        &mut self,
        def: &CharacterDef,
        targets: &[Transform],
        velocities: &[Velocity],
        world: &mut World,
    ) {
        if let Some(ragdoll) = &self.ragdoll {
            self.drives.apply(world, &def.ragdoll, ragdoll, targets, velocities);
        }
    }

    /// Computes the poses of the ragdoll's bodies in `scratch.after`; detached bodies are in their rest pose relative
    /// to the remaining ones.
    pub fn poses(&self, def: &CharacterDef, world: &World, scratch: &mut Scratch) {
        let ragdoll = self.ragdoll.as_ref().expect("the ragdoll has bodies");
        ragdoll.poses(world, &mut scratch.after);
        let bind = |body: usize| def.ragdoll.bodies[body].character_from_body;
        for &(body, _) in &self.lost {
            let above = def.ragdoll.joints[body - 1].parent;
            let rest = bind(above).inverse() * bind(body);
            scratch.after[body] = scratch.after[above] * rest;
        }
    }
}
