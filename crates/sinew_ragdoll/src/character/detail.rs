//! As much of a character as the distance to whoever looks asks for.

use super::distances::Detail;
use super::{Character, HitBodies, State};
use sinew_physics::World;

impl Character {
    /// Detail that it has, or will have once its clips move it again. Full for a character that is in no world.
    pub fn level_of_detail(&self) -> Detail {
        self.presence.as_ref().map_or(Detail::Full, |presence| presence.detail)
    }

    /// Gives it as much detail as that: at once if its clips move it, else once they do again, for what flinches, lies or gets up goes on
    /// until then. The pose and the place are the same before and after. Less than hit bodies takes its bodies out of the world,
    /// unless it holds something; they come back with other ids. Its springs ease to the pose with less than hit bodies, whatever it does, and cost nothing from there
    /// until they return with the motion of the pose. Without a world nothing happens.
    pub fn set_level_of_detail(&mut self, world: &mut World, detail: Detail) {
        if let Some(presence) = &mut self.presence {
            presence.detail = detail;
        }
        self.settle_detail(world);
    }

    pub(super) fn is_frozen(&self) -> bool {
        self.level_of_detail() == Detail::Frozen && self.state == State::Animated
    }

    /// True if its limbs may give way.
    pub(super) fn gives_way(&self) -> bool {
        self.level_of_detail() == Detail::Full
    }

    /// Brings bodies and mover in or out as its detail asks.
    pub(super) fn settle_detail(&mut self, world: &mut World) {
        let Some(presence) = &self.presence else { return };
        if self.state != State::Animated || self.ragdoll.is_some() {
            return;
        }
        let detail = presence.detail;
        let wants = detail >= Detail::HitBodies && self.def.in_world.hit_bodies != HitBodies::Absent;
        if wants && presence.bodies.is_empty() {
            self.enter_bodies(world);
        } else if !wants && !presence.bodies.is_empty() && presence.holds.is_empty() {
            self.remove_bodies(world);
        }
        if detail == Detail::Frozen {
            self.sit_down(world);
        } else {
            self.stand_up(world, 1.0);
        }
    }

    fn remove_bodies(&mut self, world: &mut World) {
        self.undress(world);
        let Some(presence) = &mut self.presence else { return };
        presence.before.clear();
        self.remove_hit_bodies(world);
    }
}
