//! Blows: what is below the threshold lets a limb give way, what is above fells.

use super::hit_bodies::Strike;
use super::{Blow, Character, CharacterEvent, State, Toughness};
use crate::character::tuning::{
    FLINCH_HALF_LIFE, FLINCH_TIME, GIVES_WAY, LEGS_WEAKEN, LOW_STANDS, RETURNED_AFTER, TRUNK_WEAKENS,
};
use crate::drive::{DriveMode, Muscle};
use sinew_math::{Vec3, clamp, max, min, normalize_or};
use sinew_physics::{BodyHit, BodyKind, World};

/// Muscles that hold a limb that was struck until it comes back.
const GIVING: Muscle = Muscle { hertz: 3.0, damping_ratio: 1.0, strength: 0.5 };

impl Character {
    /// Hits a body with an impulse (N·s, world axes) at its centre of mass. A character that is in a world and
    /// [tough](super::InWorld::toughness) enough flinches; any other goes limp at the speed it has. Gives the work that the
    /// impulse did, joules; 0 of a body that was [cut off](Self::detach).
    ///
    /// # Panics
    /// If there is no such body or the impulse is not finite.
    pub fn hit(&mut self, world: &mut World, body: usize, impulse: Vec3) -> f32 {
        self.strike(world, body, impulse, None)
    }

    /// [`hit`](Self::hit) where a ray or a shape hit one of its bodies, at that point. `None`, and nothing happens, if it is no
    /// body of this character.
    ///
    /// # Panics
    /// If the impulse is not finite.
    pub fn hit_at(&mut self, world: &mut World, hit: &BodyHit, impulse: Vec3) -> Option<f32> {
        let body = self.body_index(hit.body)?;
        Some(self.strike(world, body, impulse, Some(hit.point)))
    }

    fn strike(&mut self, world: &mut World, body: usize, impulse: Vec3, point: Option<Vec3>) -> f32 {
        assert!(body < self.def.ragdoll.bodies.len(), "there is such a body");
        if self.has_body(body) && self.react(world, body, impulse) {
            self.push(world, body, impulse, point)
        } else {
            0.0
        }
    }

    /// Flinches or falls by a blow that contacts brought to one of its bodies. A body that forces move has had the impulse with the contact.
    pub(super) fn be_struck(&mut self, world: &mut World, body: usize, strike: Strike) {
        let is_led = world.kind(self.bodies()[body]) != BodyKind::Dynamic;
        if self.react(world, body, strike.impulse) && is_led {
            self.take_up(world, body, strike);
        }
    }

    /// Gives the impulse that a led body stopped to the body, and what would make that faster than what struck it to the bodies above it, up to
    /// the pelvis: all of it on a hand would fling the hand away.
    fn take_up(&self, world: &mut World, body: usize, strike: Strike) {
        let def = &self.def.ragdoll;
        let bodies = &self.ragdoll.as_ref().expect("it has bodies").bodies;
        let way = normalize_or(strike.impulse, Vec3::ZERO);
        let parent = |&body: &usize| body.checked_sub(1).map(|joint| def.joints[joint].parent);
        let mut left = strike.impulse.length();
        let speed = max(strike.speed, GIVES_WAY);
        for body in core::iter::successors(Some(body), parent) {
            let share = min(left, def.bodies[body].mass.mass * speed);
            world.apply_impulse_at_center(bodies[body], way * share);
            left -= share;
        }
    }

    /// Flinches or falls; false if no body may move by the blow.
    fn react(&mut self, world: &mut World, body: usize, impulse: Vec3) -> bool {
        assert!(impulse.is_finite(), "an impulse is finite");
        assert!(body < self.def.ragdoll.bodies.len(), "there is such a body");
        if self.stands_blow(Blow { body, impulse }) {
            return self.flinch(world, body, impulse);
        }
        self.go_limp(world);
        self.events.push(CharacterEvent::Hit { body });
        self.drives.hit(&self.def.ragdoll, body, impulse.length());
        true
    }

    fn stands_blow(&self, blow: Blow) -> bool {
        self.presence.is_some()
            && self.state != State::Limp
            && match self.def.in_world.toughness {
                Toughness::None => false,
                Toughness::Impulse(least) => {
                    self.steps()
                        || blow.impulse.length() < least * (1.0 + self.lowness() * (LOW_STANDS - 1.0))
                }
                Toughness::Function(fells) => !fells(self, &blow),
            }
    }

    /// 1 for a body near the ground, which little can fell, to 0 for one that stands upright.
    pub(super) fn lowness(&self) -> f32 {
        match self.state {
            State::Limp | State::Preparing => 1.0,
            State::GettingUp => clamp(self.lies_still(), 0.0, 1.0),
            State::Animated | State::Flinching | State::Powered => 0.0,
        }
    }

    /// Gives a body an impulse, and what that did.
    fn push(&self, world: &mut World, body: usize, impulse: Vec3, point: Option<Vec3>) -> f32 {
        let id = self.ragdoll.as_ref().expect("it has bodies").bodies[body];
        let before = world.body_energy(id).kinetic;
        match point {
            Some(point) => world.apply_impulse(id, impulse, point),
            None => world.apply_impulse_at_center(id, impulse),
        }
        world.body_energy(id).kinetic - before
    }

    /// Lets the limb that was struck give way; false if none may. Of one whose bodies are being brought to where a clip begins all do.
    pub(super) fn flinch(&mut self, world: &mut World, body: usize, impulse: Vec3) -> bool {
        if self.state == State::Preparing {
            self.drives.hit(&self.def.ragdoll, body, impulse.length());
            self.events.push(CharacterEvent::Flinched { body });
            return true;
        }
        if self.state == State::GettingUp || self.state == State::Animated && !self.gives_way() {
            self.events.push(CharacterEvent::Flinched { body });
            return false;
        }
        if self.state == State::Animated {
            self.take_bodies(world, DriveMode::Keyed);
            self.state = State::Flinching;
        }
        if self.state == State::Flinching {
            for root in self.limb_of(body) {
                self.drives.set_from(&self.def.ragdoll, root, DriveMode::Powered(GIVING), 0.0);
            }
            self.flinching = FLINCH_TIME + RETURNED_AFTER * FLINCH_HALF_LIFE;
        }
        self.drives.hit(&self.def.ragdoll, body, impulse.length());
        self.events.push(CharacterEvent::Flinched { body });
        if self.steps() {
            self.tense();
            self.shove(world, impulse);
        }
        self.drive_bodies(world);
        true
    }

    /// Tenses the legs and the trunk of a character that stands: a blow takes less of their strength.
    fn tense(&mut self) {
        for (index, body) in self.def.ragdoll.bodies.iter().enumerate() {
            let is_leg = ["Leg", "Foot", "Toes"].iter().any(|part| body.role.ends_with(part));
            let is_trunk = ["hips", "spine", "chest", "upperChest"].contains(&body.role.as_str());
            if index == 0 || is_leg {
                self.drives.steady(index, LEGS_WEAKEN);
            } else if is_trunk {
                self.drives.steady(index, TRUNK_WEAKENS);
            }
        }
    }

    /// The bodies from which a blow to one makes all below give way: the limb that it is of, up to the trunk. Of the pelvis, what
    /// hangs on it, since the pelvis itself is held.
    fn limb_of(&self, body: usize) -> Vec<usize> {
        let def = &self.def.ragdoll;
        let parent = |body: usize| body.checked_sub(1).map(|joint| def.joints[joint].parent);
        let children = |body: usize| def.joints.iter().filter(move |joint| joint.parent == body).count();
        if body == 0 {
            return def.joints.iter().filter(|joint| joint.parent == 0).map(|joint| joint.child).collect();
        }
        let mut root = body;
        // Where several limbs branch off is the trunk.
        while let Some(above) = parent(root).filter(|&above| above != 0 && children(above) == 1) {
            root = above;
        }
        vec![root]
    }

    /// Has a limb that gave way go on doing so: something holds it.
    pub(super) fn flinch_on(&mut self) {
        self.flinching = max(self.flinching, FLINCH_TIME + RETURNED_AFTER * FLINCH_HALF_LIFE);
    }

    /// Lets a limb that gave way come back; true once it has.
    pub(super) fn come_back(&mut self, dt: f32) -> bool {
        let back = RETURNED_AFTER * FLINCH_HALF_LIFE;
        let before = self.flinching;
        self.flinching -= dt;
        if before > back && self.flinching <= back {
            self.drives.set_all(DriveMode::Keyed, FLINCH_HALF_LIFE);
        }
        self.flinching <= 0.0
    }
}
