//! Springs and garments of a character, which are added to the pose from clips or bodies.

use super::CharacterDef;
use super::figure::{Moment, Scratch};
use super::physique::Physique;
use crate::garments::{Wearer, Worn};
use crate::springs::{SpringStep, SpringSwing};
use sinew_anim::LocalTransform;
use sinew_math::Transform;
use sinew_physics::World;

/// Springs and garments of a character.
#[derive(Clone, Debug)]
pub(super) struct Wear {
    pub springs: SpringSwing,
    pub garments: Worn,
    /// Pose with springs and garments; empty for a character without any.
    pub pose: Vec<LocalTransform>,
}

/// State of a character on which its springs and garments depend.
#[derive(Clone, Copy)]
pub(super) struct Bearer<'a> {
    pub def: &'a CharacterDef,
    /// Pose without springs and garments; `place` is the character's transform.
    pub pose: &'a [LocalTransform],
    pub place: Transform,
    pub physique: &'a Physique,
}

impl<'a> Bearer<'a> {
    fn wearer(self) -> Wearer<'a> {
        Wearer {
            rig: self.def.garments(),
            ragdoll: &self.def.ragdoll,
            pose: self.pose,
            world_from_model: self.def.mapping().world_from_model(self.place),
            bodies: self.physique.ids(),
            lost: &self.physique.lost,
        }
    }
}

impl Wear {
    pub fn new() -> Self {
        Self { springs: SpringSwing::new(), garments: Worn::default(), pose: Vec::new() }
    }

    /// Advances springs and garments of a character by a step of the world. `shown` is the figure's pose as shown last.
    /// If `is_far` is true, the springs do not swing. If `mends` is true, cloth that clips have caught is freed.
    pub fn go_on(
        &mut self,
        bearer: Bearer<'_>,
        shown: &Moment,
        (is_far, mends): (bool, bool),
        scratch: &mut Scratch,
        world: &mut World,
    ) {
        let def = bearer.def;
        if def.springs().is_empty() && def.garments().is_empty() {
            return;
        }
        let has_no_bodies = bearer.physique.ids().is_empty();
        let is_bare = self.garments.groups.is_empty() && (def.garments().is_empty() || has_no_bodies);
        self.pose.clear();
        if is_bare && is_far && self.springs.is_away() {
            return;
        }
        self.pose.extend_from_slice(bearer.pose);
        self.swing(bearer, shown, is_far, scratch, world);
        self.show_springs(def);
        self.drape(bearer, mends, world);
        self.show_garments(def);
    }

    /// Advances the springs. Those of a far character follow the pose rigidly and later resume with the motion of the
    /// shown pose.
    fn swing(
        &mut self,
        bearer: Bearer<'_>,
        shown: &Moment,
        is_far: bool,
        scratch: &mut Scratch,
        world: &World,
    ) {
        let Bearer { def, place, physique, .. } = bearer;
        let rig = def.springs();
        if rig.is_empty() {
            return;
        }
        let returns = self.springs.is_eased() && !is_far;
        let mut bodies = core::mem::take(&mut scratch.after);
        bodies.clear();
        if rig.meets_bodies() && !is_far && !returns {
            scratch.bodies_of(def, &self.pose, place, &mut bodies);
            physique.hide_lost(&mut bodies);
        }
        let step = SpringStep {
            rig,
            pose: &self.pose,
            world_from_model: def.mapping().world_from_model(place),
            bodies: &bodies,
            world: Some((world, physique.own())),
            seconds: world.def().dt(),
        };
        if is_far {
            self.springs.ease(&step);
        } else if returns {
            let root = def.mapping().world_from_model(shown.place);
            self.springs.take_up(&step, &shown.pose, root);
        } else {
            self.springs.step(&step);
        }
        scratch.after = bodies;
    }

    /// Adds the garments if the character has bodies in the world, frees cloth that clips have caught, and computes the
    /// pose of the garments' joints. The shown garment joints follow their swinging parents; the cloth itself follows
    /// the pose without springs.
    fn drape(&mut self, bearer: Bearer<'_>, mends: bool, world: &mut World) {
        self.dress(bearer, world);
        if self.garments.groups.is_empty() {
            return;
        }
        // The cloth of a character that gets up may be in the ground.
        if mends {
            bearer.wearer().mend(world, &self.garments.groups);
        }
        Bearer { pose: &self.pose, ..bearer }.wearer().turns(world, &mut self.garments);
    }

    /// Adds the garments to the world, before the first step in which the character has bodies.
    pub fn dress(&mut self, bearer: Bearer<'_>, world: &mut World) {
        let is_there = !bearer.physique.ids().is_empty();
        if !bearer.def.garments().is_empty() && self.garments.groups.is_empty() && is_there {
            self.garments.groups = bearer.wearer().put_on(world);
        }
    }

    /// Attaches the garments to the remaining bodies, at their present shape.
    pub fn rehang(&mut self, bearer: Bearer<'_>, world: &mut World) {
        if self.garments.groups.is_empty() {
            return;
        }
        let was = self.garments.lie(world);
        self.garments.take_off(world);
        self.dress(bearer, world);
        self.garments.lay(world, &was);
    }

    /// Rotates the bones of springs in the shown pose.
    fn show_springs(&mut self, def: &CharacterDef) {
        for (joint, &turn) in def.springs().joints().zip(self.springs.turns()) {
            self.pose[joint].rotation = turn;
        }
    }

    /// Rotates and moves the joints of garments in the shown pose.
    fn show_garments(&mut self, def: &CharacterDef) {
        for (joint, &turn) in def.garments().joints().zip(&self.garments.turns) {
            self.pose[joint].rotation = turn;
        }
        for (joint, &place) in def.garments().moving().zip(&self.garments.places) {
            self.pose[joint].translation = place;
        }
    }

    /// Shows springs and garments over a pose, as saved.
    pub fn show_loaded(&mut self, def: &CharacterDef, pose: &[LocalTransform]) {
        self.pose.clear();
        if !(self.springs.turns().is_empty() && self.garments.turns.is_empty()) {
            self.pose.extend_from_slice(pose);
            self.show_springs(def);
            self.show_garments(def);
        }
    }
}
