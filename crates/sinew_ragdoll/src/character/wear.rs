//! Springs and garments that a character wears, over the pose that clips or bodies give it.

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
    /// The pose with springs and garments as they are; empty of a character that wears none.
    pub pose: Vec<LocalTransform>,
}

/// Character that wears springs and garments.
#[derive(Clone, Copy)]
pub(super) struct Bearer<'a> {
    pub def: &'a CharacterDef,
    /// Pose without springs and garments, and place.
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

    /// Takes what it wears forward by a step of the world, about the pose that the bearer has now. `shown`: the moment that was shown last;
    /// `is_far`: springs rest; `mends`: what clips have caught is freed.
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

    /// Springs of one who is far away are the pose, and return with its motion: that which was shown.
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

    /// Puts its garments on if it has bodies to wear them, mends what its clips have caught, and looks how they lie. Their joints are shown below springs that have
    /// swung; cloth itself lies as the pose without springs has it, from near and from afar.
    fn drape(&mut self, bearer: Bearer<'_>, mends: bool, world: &mut World) {
        self.dress(bearer, world);
        if self.garments.groups.is_empty() {
            return;
        }
        // Where the pose of one who is getting up has the sheet is ground.
        if mends {
            bearer.wearer().mend(world, &self.garments.groups);
        }
        Bearer { pose: &self.pose, ..bearer }.wearer().turns(world, &mut self.garments);
    }

    /// Puts its garments on, before the first step in which it has bodies.
    pub fn dress(&mut self, bearer: Bearer<'_>, world: &mut World) {
        let is_there = !bearer.physique.ids().is_empty();
        if !bearer.def.garments().is_empty() && self.garments.groups.is_empty() && is_there {
            self.garments.groups = bearer.wearer().put_on(world);
        }
    }

    /// Hangs its garments on what is left of its bodies, as they lie.
    pub fn rehang(&mut self, bearer: Bearer<'_>, world: &mut World) {
        if self.garments.groups.is_empty() {
            return;
        }
        let was = self.garments.lie(world);
        self.garments.take_off(world);
        self.dress(bearer, world);
        self.garments.lay(world, &was);
    }

    /// Turns the bones of springs as they are, in the pose that is shown.
    fn show_springs(&mut self, def: &CharacterDef) {
        for (joint, &turn) in def.springs().joints().zip(self.springs.turns()) {
            self.pose[joint].rotation = turn;
        }
    }

    /// Turns and moves the joints of garments as they are, in the pose that is shown.
    fn show_garments(&mut self, def: &CharacterDef) {
        for (joint, &turn) in def.garments().joints().zip(&self.garments.turns) {
            self.pose[joint].rotation = turn;
        }
        for (joint, &place) in def.garments().moving().zip(&self.garments.places) {
            self.pose[joint].translation = place;
        }
    }

    /// Shows what it wears over a pose, as it was when it was saved.
    pub fn show_loaded(&mut self, def: &CharacterDef, pose: &[LocalTransform]) {
        self.pose.clear();
        if !(self.springs.turns().is_empty() && self.garments.turns.is_empty()) {
            self.pose.extend_from_slice(pose);
            self.show_springs(def);
            self.show_garments(def);
        }
    }
}
