//! Bodies of a character that its clips move: led from pose to pose, and what strikes them.

use super::{Character, CharacterEvent};
use crate::character::tuning::TELEPORTED;
use crate::owner::{is_limb, together};
use sinew_math::{Vec3, max, min};
use sinew_physics::{BodyId, BodyKind, Hit, Velocity, World};

/// A blow that contacts brought.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Strike {
    /// N·s, world axes.
    pub impulse: Vec3,
    /// Fastest that what struck can make what it meets, m/s.
    pub speed: f32,
}

impl Character {
    /// Has the hit bodies go where the pose will be at the end of the next step, as far as it goes on as it did.
    pub(super) fn lead_bodies(&mut self, world: &mut World) {
        let Some(presence) = self.presence.as_mut().filter(|presence| !presence.bodies.is_empty()) else {
            return;
        };
        let mut before = core::mem::take(&mut presence.before);
        let mut now = core::mem::take(&mut self.scratch.after);
        let place = self.world_from_character;
        let is_planted = self.is_planted();
        let pose = core::mem::take(if is_planted { &mut self.planted } else { &mut self.pose });
        self.bodies_of(&pose, place, &mut now);
        if is_planted {
            self.planted = pose;
        } else {
            self.pose = pose;
        }
        let presence = self.presence.as_mut().expect("it was there");
        if before.len() != now.len() {
            before.clone_from(&now);
        }
        for (before, now) in before.iter_mut().zip(&now) {
            if (now.translation - before.translation).length_squared() > TELEPORTED * TELEPORTED {
                *before = *now;
            }
        }
        let dt = world.def().dt();
        if self.lost.is_empty() {
            world.lead_all(&presence.bodies, &before, &now, dt);
        } else {
            let is_lost = |index: usize| self.lost.iter().any(|&(lost, _)| lost == index);
            let own = presence.bodies.iter().zip(before.iter().zip(&now)).enumerate();
            for (_, (&id, (before, now))) in own.filter(|(index, _)| !is_lost(*index)) {
                world.lead_all(&[id], &[*before], &[*now], dt);
            }
        }
        (presence.before, self.scratch.after) = (now, before);
    }

    /// Has its bodies pass through the dynamic body that bears its mover, which presses it with its weight alone: feet that kicked a crate on
    /// which they ride would drive it, and themselves with it, faster and faster.
    pub(super) fn spare_bearer(&mut self, world: &mut World) {
        let ground = self.mover().and_then(|mover| world.mover_ground(mover));
        let bearer = ground.and_then(|ground| ground.shape).map(|shape| shape.body);
        let bearer = bearer.filter(|&body| world.kind(body) == BodyKind::Dynamic);
        let bearer = bearer.filter(|&body| self.held().all(|held| held != body));
        let Some(presence) = self.presence.as_mut().filter(|presence| presence.bearer != bearer) else {
            return;
        };
        let before = core::mem::replace(&mut presence.bearer, bearer).filter(|&body| world.contains(body));
        let before = before.filter(|&body| !self.passes_through(world, body));
        for &own in self.own() {
            if let Some(before) = before {
                world.enable_pair(own, before);
            }
            if let Some(bearer) = bearer {
                world.disable_pair(own, bearer);
            }
        }
    }

    /// Flinches or falls by what struck its bodies in the last step.
    pub(super) fn feel(&mut self, world: &mut World) {
        let least = self.def.in_world.feels;
        let Some(presence) = &self.presence else { return };
        if presence.bodies.is_empty() || least == f32::INFINITY {
            return;
        }
        let mut felt: Option<(usize, Strike)> = None;
        let mut note = |body: usize, strike: Strike| {
            let size = strike.impulse.length();
            if size >= least && felt.is_none_or(|(_, felt)| size > felt.impulse.length()) {
                felt = Some((body, strike));
            }
        };
        let own = |id: BodyId| self.body_index(id);
        // Its own steps are no blows: what stands comes into nobody.
        let steps = self.steps();
        let stands = |id: BodyId| steps && world.contains(id) && world.kind(id) == BodyKind::Static;
        for hit in &world.events().hits {
            match (own(hit.a.body), own(hit.b.body)) {
                (Some(_), None) if stands(hit.b.body) => {}
                (None, Some(_)) if stands(hit.a.body) => {}
                (Some(body), None) => {
                    note(body, self.taken(world, hit, [hit.a.body, hit.b.body], -hit.normal));
                }
                (None, Some(body)) => {
                    note(body, self.taken(world, hit, [hit.b.body, hit.a.body], hit.normal));
                }
                _ => {}
            }
        }
        for &(a, b) in &world.events().begin {
            match (own(a), own(b)) {
                (Some(body), None) => note(body, self.passing(world, a, b)),
                (None, Some(body)) => note(body, self.passing(world, b, a)),
                _ => {}
            }
        }
        if let Some((body, strike)) = felt {
            self.events.push(CharacterEvent::Struck { body, impulse: strike.impulse.length() });
            self.be_struck(world, body, strike);
        }
    }

    /// Tells of what its bodies began and stopped to touch in the last step.
    pub(super) fn note_contacts(&mut self, world: &World) {
        if !self.def.in_world.tells_contacts || self.bodies().is_empty() {
            return;
        }
        let mut events = core::mem::take(&mut self.events);
        let told = world.events();
        for (pairs, begins) in [(&told.begin, true), (&told.end, false)] {
            for &(a, b) in pairs {
                match (self.body_index(a), self.body_index(b)) {
                    (Some(body), None) => events.push(CharacterEvent::Contact { body, other: b, begins }),
                    (None, Some(body)) => events.push(CharacterEvent::Contact { body, other: a, begins }),
                    _ => {}
                }
            }
        }
        self.events = events;
    }

    /// Impulse of a hit on one of its bodies by another, `way` being from that to it, N·s: no more than what comes could bring to all of it, and to a
    /// led body what comes by itself. A foot that comes down on a hand presses that to the ground however hard it is led.
    fn taken(&self, world: &World, hit: &Hit, [own, other]: [BodyId; 2], way: Vec3) -> Strike {
        let Velocity { linear, angular } = world.velocity(own);
        let led = linear + angular.cross(hit.point - world.center_of_mass(own));
        let shoves = if world.kind(own) == BodyKind::Dynamic { 0.0 } else { -led.dot(way) };
        let bounce = hit.materials.iter().fold(1.0, |most, material| max(most, 1.0 + material.restitution));
        let speed = bounce * max(hit.approach - shoves, 0.0);
        Strike { impulse: way * min(hit.impulse, self.meeting_mass(world, other) * speed), speed }
    }

    /// Mass of all of it and of what comes, as they answer to a push between them, kg; what joints hold, or nothing moves, may have any mass.
    fn meeting_mass(&self, world: &World, other: BodyId) -> f32 {
        let whole = self.def.ragdoll.total_mass;
        if world.contains(other) && is_limb(world, other) {
            let mass: f32 = together(world, other).iter().map(|&body| world.mass(body).mass).sum();
            return mass * whole / (mass + whole);
        }
        let is_free = world.contains(other)
            && world.kind(other) == BodyKind::Dynamic
            && world.joints_of(other).next().is_none();
        if !is_free {
            return whole;
        }
        let mass = world.mass(other).mass;
        mass * whole / (mass + whole)
    }

    /// Impulse that a body that goes through one of its own would give it, if the two stopped each other: N·s.
    fn passing(&self, world: &World, own: BodyId, other: BodyId) -> Strike {
        let gone = !world.contains(other) || !world.contains(own);
        if gone || world.kind(other) != BodyKind::Dynamic || world.kind(own) == BodyKind::Dynamic {
            return Strike::default();
        }
        let relative = world.velocity(other).linear - world.velocity(own).linear;
        let toward = world.center_of_mass(own) - world.center_of_mass(other);
        let way = sinew_math::normalize_or(toward, Vec3::ZERO);
        // What comes by itself, not what it walks into.
        let comes = max(world.velocity(other).linear.dot(way), 0.0);
        let closing = max(relative.dot(way), 0.0);
        let speed = min(closing, comes);
        Strike { impulse: way * (self.meeting_mass(world, other) * speed), speed }
    }
}
