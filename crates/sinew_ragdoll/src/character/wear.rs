//! Springs and garments that a character wears, over the pose that clips or bodies give it.

use super::{Character, Detail, State};
use crate::garments::Wearer;
use crate::springs::SpringStep;
use sinew_physics::{GroupId, World};

impl Character {
    /// Takes what it wears forward by a step of the world, about the pose that it has now.
    pub(super) fn wear(&mut self, world: &mut World) {
        let def = self.def.clone();
        if def.springs().is_empty() && def.garments().is_empty() {
            return;
        }
        let is_far = self.level_of_detail() <= Detail::Keyed;
        let is_bare = self.worn.groups.is_empty() && (def.garments().is_empty() || self.bodies().is_empty());
        self.swung.clear();
        if is_bare && is_far && self.swing.is_away() {
            return;
        }
        self.swung.extend_from_slice(if self.is_planted() { &self.planted } else { &self.pose });
        self.swing_springs(world, is_far);
        self.show_springs();
        self.wear_garments(world);
        self.show_garments();
    }

    /// Springs of one who is far away are the pose, and return with its motion: that which was shown.
    fn swing_springs(&mut self, world: &World, is_far: bool) {
        let def = self.def.clone();
        let rig = def.springs();
        if rig.is_empty() {
            return;
        }
        let place = self.world_from_character;
        let returns = self.swing.is_eased() && !is_far;
        let mut bodies = core::mem::take(&mut self.scratch.after);
        bodies.clear();
        if rig.meets_bodies() && !is_far && !returns {
            let pose = core::mem::take(&mut self.swung);
            self.bodies_of(&pose, place, &mut bodies);
            self.hide_lost(&mut bodies);
            self.swung = pose;
        }
        let own = match (&self.ragdoll, &self.presence) {
            _ if !self.lost.is_empty() => self.kept.as_slice(),
            (Some(ragdoll), _) => ragdoll.bodies.as_slice(),
            (None, Some(presence)) => presence.bodies.as_slice(),
            (None, None) => &[],
        };
        let step = SpringStep {
            rig,
            pose: &self.swung,
            world_from_model: def.mapping().world_from_model(place),
            bodies: &bodies,
            world: Some((world, own)),
            seconds: world.def().dt(),
        };
        if is_far {
            self.swing.ease(&step);
        } else if returns {
            let root = def.mapping().world_from_model(self.shown.world_from_character);
            self.swing.take_up(&step, &self.shown.pose, root);
        } else {
            self.swing.step(&step);
        }
        self.scratch.after = bodies;
    }

    /// Puts its garments on if it has bodies to wear them, mends what its clips have caught, and looks how they lie. Their joints are shown below springs that have
    /// swung; cloth itself lies as the pose without springs has it, from near and from afar.
    fn wear_garments(&mut self, world: &mut World) {
        if self.def.garments().is_empty() {
            return;
        }
        let mut worn = core::mem::take(&mut self.worn);
        if worn.groups.is_empty() && !self.bodies().is_empty() {
            worn.groups = self.wearer(self.pose_without_springs()).put_on(world);
        }
        if !worn.groups.is_empty() {
            // Where the pose of one who is getting up has the sheet is ground.
            if self.state == State::Animated {
                self.wearer(self.pose_without_springs()).mend(world, &worn.groups);
            }
            self.wearer(&self.swung).turns(world, &mut worn);
        }
        self.worn = worn;
    }

    fn wearer<'a>(&'a self, pose: &'a [sinew_anim::LocalTransform]) -> Wearer<'a> {
        Wearer {
            rig: self.def.garments(),
            ragdoll: &self.def.ragdoll,
            pose,
            world_from_model: self.world_from_model(),
            bodies: self.bodies(),
            lost: &self.lost,
        }
    }

    /// Puts its garments on, before the first step in which it has bodies.
    pub(super) fn dress(&mut self, world: &mut World) {
        if !self.def.garments().is_empty() && self.worn.groups.is_empty() {
            self.worn.groups = self.wearer(self.pose_without_springs()).put_on(world);
        }
    }

    /// Hangs its garments on what is left of its bodies, as they lie.
    pub(super) fn rehang(&mut self, world: &mut World) {
        if self.worn.groups.is_empty() {
            return;
        }
        let was = self.worn.lie(world);
        self.undress(world);
        self.dress(world);
        self.worn.lay(world, &was);
    }

    /// Takes its garments off, before its bodies leave the world.
    pub(super) fn undress(&mut self, world: &mut World) {
        self.worn.take_off(world);
    }

    /// Turns the bones of springs as they are, in the pose that is shown.
    pub(super) fn show_springs(&mut self) {
        let def = self.def.clone();
        for (joint, &turn) in def.springs().joints().zip(self.swing.turns()) {
            self.swung[joint].rotation = turn;
        }
    }

    /// Turns and moves the joints of garments as they are, in the pose that is shown.
    pub(super) fn show_garments(&mut self) {
        let def = self.def.clone();
        for (joint, &turn) in def.garments().joints().zip(&self.worn.turns) {
            self.swung[joint].rotation = turn;
        }
        for (joint, &place) in def.garments().moving().zip(&self.worn.places) {
            self.swung[joint].translation = place;
        }
    }

    /// Has its springs start over at rest with the next step: after a cut, where the way from the place before is none.
    pub fn reset_springs(&mut self) {
        self.swing.reset();
    }

    /// Has its garments start over at rest: after a cut, where the way from the place before is none.
    ///
    /// # Panics
    /// If the world is not the one that the character is in.
    pub fn reset_garments(&mut self, world: &mut World) {
        if !self.worn.groups.is_empty() {
            self.undress(world);
            self.dress(world);
        }
    }

    /// Particles of its garments in the world, in the order of [`CharacterDef::garments`](super::CharacterDef::garments); none while it has no bodies.
    pub fn garments(&self) -> &[GroupId] {
        &self.worn.groups
    }
}
