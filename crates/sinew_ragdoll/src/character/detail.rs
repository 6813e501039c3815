//! As much of a character as the distance to whoever looks asks for.

use super::{Character, HitBodies, State};
use sinew_math::max;
use sinew_physics::World;

/// Share that a character has of its world while its clips move it, from nothing to all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Detail {
    /// Nothing: its clips stand still, nothing stops or carries it, and an update costs nothing.
    Frozen,
    /// A mover and its clips; nothing sees its limbs.
    Keyed,
    /// Hit bodies besides, which give no way: blows below the threshold are told of and do nothing.
    HitBodies,
    /// Everything. Default.
    #[default]
    Full,
}

/// Distances at which [`Detail`] changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distances {
    /// Up to here full, metres. Default 15.
    pub full: f32,
    /// Up to here with hit bodies, metres. Default 40.
    pub hit_bodies: f32,
    /// Up to here keyed, beyond it frozen, metres. Default 120.
    pub keyed: f32,
    /// Share by which a distance must be passed for less detail, so that it does not change to and fro. Default 0.1.
    pub slack: f32,
}

impl Default for Distances {
    fn default() -> Self {
        Self { full: 15.0, hit_bodies: 40.0, keyed: 120.0, slack: 0.1 }
    }
}

impl Distances {
    /// Detail at a distance, metres, for a character that has that much `now`. `NaN` is far away.
    pub fn detail(&self, distance: f32, now: Detail) -> Detail {
        let up_to = |limit: f32, detail: Detail| {
            let limit = if now >= detail { limit * (1.0 + max(self.slack, 0.0)) } else { limit };
            distance <= limit
        };
        if up_to(self.full, Detail::Full) {
            Detail::Full
        } else if up_to(self.hit_bodies, Detail::HitBodies) {
            Detail::HitBodies
        } else if up_to(self.keyed, Detail::Keyed) {
            Detail::Keyed
        } else {
            Detail::Frozen
        }
    }
}

impl Character {
    /// Detail that it has, or will have once its clips move it again. Full for a character that is in no world.
    pub fn level_of_detail(&self) -> Detail {
        self.presence.as_ref().map_or(Detail::Full, |presence| presence.detail)
    }

    /// Gives it as much detail as that: at once if its clips move it, else once they do again, for what flinches, lies or gets up goes on
    /// until then. The pose and the place are the same before and after. Less than hit bodies takes its bodies out of the world,
    /// unless it holds something; they come back with other ids. Without a world nothing happens.
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
        let Some(presence) = &mut self.presence else { return };
        presence.before.clear();
        for body in presence.bodies.drain(..) {
            world.remove_body(body);
        }
    }
}
