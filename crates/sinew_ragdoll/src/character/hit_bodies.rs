//! Bodies of a character that its clips move, and contacts that strike them.

use super::figure::Scratch;
use super::physique::Physique;
use super::{CharacterDef, CharacterEvent};
use crate::character::tuning::{CATCHES_UP, GIVES_WAY, HAND_OVER_CHANGE, HIT_SPEED, SUDDEN, TELEPORTED};
use crate::def::RagdollDef;
use crate::owner::{is_limb, together};
use crate::ragdoll::BodyState;
use sinew_anim::LocalTransform;
use sinew_math::{Transform, Vec3, direction_and_length, max, min, normalize_or};
use sinew_physics::{BodyId, BodyKind, Hit, Push, Velocity, World};

/// A hit by a contact.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Strike {
    /// Impulse of the hit, N·s, world axes.
    pub impulse: Vec3,
    /// Largest speed that the striker can give to the body, m/s.
    pub speed: f32,
}

impl Physique {
    /// Sets the velocities that move the hit bodies to their predicted poses at the end of the next step.
    pub fn lead(
        &mut self,
        def: &CharacterDef,
        pose: &[LocalTransform],
        place: Transform,
        scratch: &mut Scratch,
        world: &mut World,
    ) {
        if self.hit.is_empty() {
            return;
        }
        let mut before = core::mem::take(&mut self.before);
        let mut now = core::mem::take(&mut scratch.after);
        scratch.hit_bodies_of(def, pose, place, &mut now);
        if before.len() != now.len() {
            before.clone_from(&now);
        }
        let dt = world.def().dt();
        let mut next = now.clone();
        for (index, (before, now)) in before.iter_mut().zip(&mut next).enumerate() {
            if (now.translation - before.translation).length_squared() > TELEPORTED * TELEPORTED {
                *before = *now;
            } else if self.has(index) {
                let away = now.translation - world.transform(self.hit[index]).translation;
                let missed = away.length();
                slow_down(before, now, SUDDEN * dt * dt / missed);
                let late = away * max(1.0 - CATCHES_UP * dt / max(missed, f32::MIN_POSITIVE), 0.0);
                (before.translation, now.translation) = (before.translation - late, now.translation - late);
            }
        }
        if self.lost.is_empty() {
            world.lead_all(&self.hit, &before, &next, dt);
        } else {
            let own = self.hit.iter().zip(before.iter().zip(&next)).enumerate();
            for (_, (&id, (before, now))) in own.filter(|(index, _)| self.has(*index)) {
                world.lead_all(&[id], &[*before], &[*now], dt);
            }
        }
        (self.before, scratch.after) = (now, before);
    }

    /// Moves the hit bodies from `now` to `next` in the next step; poses in world space.
    pub fn lead_to(&mut self, now: &[Transform], next: &[Transform], world: &mut World) {
        self.before.clear();
        self.before.extend_from_slice(now);
        let dt = world.def().dt();
        let own = self.hit.iter().zip(next).enumerate().filter(|(index, _)| self.has(*index));
        own.for_each(|(_, (&id, &next))| world.move_to(id, next, dt));
    }

    /// Bounds how much the velocities of bodies that become dynamic differ from those of the hit bodies: a lift out of
    /// the floor that has just begun must not become a speed.
    pub fn bound_change(&self, states: &mut [BodyState], world: &World) {
        if self.before.is_empty() {
            return;
        }
        let own = self.hit.iter().zip(states).enumerate().filter(|(index, _)| self.has(*index));
        for (_, (&id, state)) in own {
            let (now, velocity) = (world.velocity(id), &mut state.velocity);
            let bounded = |from: Vec3, to: Vec3, most: f32| {
                let change = to - from;
                from + change * min(most / max(change.length(), f32::MIN_POSITIVE), 1.0)
            };
            velocity.linear = bounded(now.linear, velocity.linear, HAND_OVER_CHANGE[0]);
            velocity.angular = bounded(now.angular, velocity.angular, HAND_OVER_CHANGE[1]);
        }
    }

    /// Returns the strongest hit on the character's bodies in the last step, with the body's index; `None` below the
    /// threshold [`InWorld::feels`](super::InWorld::feels). If `steps` is true, the character balances on its feet, and
    /// contacts with static bodies do not count as hits.
    pub fn felt(&self, def: &CharacterDef, steps: bool, world: &World) -> Option<(usize, Strike)> {
        let least = def.in_world.feels;
        if self.hit.is_empty() || least == f32::INFINITY {
            return None;
        }
        let whole = def.ragdoll.total_mass;
        let mut felt: Option<(usize, Strike)> = None;
        let mut note = |body: usize, strike: Strike| {
            let size = strike.impulse.length();
            if size >= least && felt.is_none_or(|(_, felt)| size > felt.impulse.length()) {
                felt = Some((body, strike));
            }
        };
        let own = |id: BodyId| self.index_of(id);
        // The steps of a character that balances do not count as hits.
        let stands = |id: BodyId| steps && world.contains(id) && world.kind(id) == BodyKind::Static;
        for hit in &world.events().hits {
            match (own(hit.a.body), own(hit.b.body)) {
                (Some(_), None) if stands(hit.b.body) => {}
                (None, Some(_)) if stands(hit.a.body) => {}
                (Some(body), None) => {
                    note(body, taken(world, hit, [hit.a.body, hit.b.body], -hit.normal, whole));
                }
                (None, Some(body)) => {
                    note(body, taken(world, hit, [hit.b.body, hit.a.body], hit.normal, whole));
                }
                _ => {}
            }
        }
        for &(a, b) in &world.events().begin {
            match (own(a), own(b)) {
                (Some(body), None) => note(body, passing(world, a, b, whole)),
                (None, Some(body)) => note(body, passing(world, b, a, whole)),
                _ => {}
            }
        }
        felt
    }

    /// Returns the impulses of blasts, bullets and forces on the character's kinematic bodies in the last step, each
    /// with the body's index.
    pub fn pushes(&self, world: &World) -> Vec<(usize, Push)> {
        let pushed = world.events().pushed.iter();
        pushed.filter_map(|push| Some((self.index_of(push.body)?, *push))).collect()
    }

    /// Returns the impulse of all fields on the character's kinematic bodies in a step, N·s.
    pub fn field_impulse(&self, world: &World) -> Vec3 {
        let mut force = Vec3::ZERO;
        for field in world.field_ids() {
            let led = self.own().iter().filter(|&&body| world.kind(body) == BodyKind::Kinematic);
            force = led.fold(force, |sum, &body| sum + world.field_force(field, body).force);
        }
        force * world.def().dt()
    }

    /// Applies the impulses to those of their bodies that have become dynamic.
    pub fn take_pushes(&self, pushes: &[(usize, Push)], world: &mut World) {
        for &(_, Push { body, impulse, angular_impulse }) in pushes {
            if world.kind(body) == BodyKind::Dynamic {
                world.apply_impulse_at_center(body, impulse);
                world.apply_angular_impulse(body, angular_impulse);
            }
        }
    }

    /// Returns the contacts that the character's bodies began and ended in the last step, as events.
    pub fn contacts(&self, world: &World) -> impl Iterator<Item = CharacterEvent> {
        let told = world.events();
        let all = [(&told.begin, true), (&told.end, false)].into_iter();
        let all = all.flat_map(|(pairs, begins)| pairs.iter().map(move |&pair| (pair, begins)));
        all.filter_map(|((a, b), begins)| match (self.index_of(a), self.index_of(b)) {
            (Some(body), None) => Some(CharacterEvent::Contact { body, other: b, begins }),
            (None, Some(body)) => Some(CharacterEvent::Contact { body, other: a, begins }),
            _ => None,
        })
    }

    /// Applies the impulse that a body stopped while it was kinematic. Each body from it up to the pelvis takes at most
    /// the impulse that gives it the striker's speed; the rest is lost.
    pub fn take_up(&self, def: &CharacterDef, body: usize, strike: Strike, world: &mut World) {
        let (way, mut left) = direction_and_length(strike.impulse);
        for (body, share) in shares(&def.ragdoll, body, max(strike.speed, GIVES_WAY)) {
            let given = min(left, share);
            let id = self.limp().bodies[body];
            if world.kind(id) == BodyKind::Dynamic {
                world.apply_impulse_at_center(id, way * given);
            }
            left -= given;
        }
    }

    /// Applies an impulse to a body, at `point` or at its centre of mass, and returns the work, joules.
    ///
    /// The part that would make the body faster than [`HIT_SPEED`] goes to the bodies above it in its chain; otherwise
    /// a strong hit would throw a hand away. What exceeds the shares of all these bodies goes to the struck body.
    pub fn push(
        &self,
        def: &CharacterDef,
        body: usize,
        impulse: Vec3,
        point: Option<Vec3>,
        world: &mut World,
    ) -> f32 {
        let (way, mut left) = direction_and_length(impulse);
        let whole: f32 = shares(&def.ragdoll, body, HIT_SPEED).map(|(_, share)| share).sum();
        let mut beyond = max(left - whole, 0.0);
        let mut work = 0.0;
        for (of, share) in shares(&def.ragdoll, body, HIT_SPEED) {
            let given = min(left, share);
            left -= given;
            let size = given + core::mem::take(&mut beyond);
            let id = self.limp().bodies[of];
            if size <= 0.0 || world.kind(id) != BodyKind::Dynamic {
                continue;
            }
            let before = world.body_energy(id).kinetic;
            match point.filter(|_| of == body) {
                Some(point) => world.apply_impulse(id, way * size, point),
                None => world.apply_impulse_at_center(id, way * size),
            }
            work += world.body_energy(id).kinetic - before;
        }
        work
    }
}

/// Moves the earlier pose `before` of a body toward its present pose until `share` of its motion is left; does nothing
/// if `share` is 1 or more. So a jump is not extrapolated, which would make the body overshoot by the length of the
/// jump.
fn slow_down(before: &mut Transform, now: &Transform, share: f32) {
    if share < 1.0 {
        let translation = now.translation + (before.translation - now.translation) * share;
        *before = Transform::new(translation, now.rotation.nlerp(before.rotation, share));
    }
}

/// Returns the indices of a body and of each body above it up to the pelvis, each with the impulse that gives it this
/// speed (m/s), N·s.
fn shares(def: &RagdollDef, body: usize, speed: f32) -> impl Iterator<Item = (usize, f32)> {
    let parent = |&body: &usize| body.checked_sub(1).map(|joint| def.joints[joint].parent);
    core::iter::successors(Some(body), parent).map(move |body| (body, def.bodies[body].mass.mass * speed))
}

/// Returns the impulse of another body on one of the character's bodies. `way` is the direction from the other body to
/// the character's. The impulse is at most the one that the striker could give to the whole character, `whole` kg. The
/// motion of a kinematic body toward the striker does not count, so that its own speed does not increase the hit.
fn taken(world: &World, hit: &Hit, [own, other]: [BodyId; 2], way: Vec3, whole: f32) -> Strike {
    let Velocity { linear, angular } = world.velocity(own);
    let led = linear + angular.cross(hit.point - world.center_of_mass(own));
    let shoves = if world.kind(own) == BodyKind::Dynamic { 0.0 } else { -led.dot(way) };
    let bounce = hit.materials.iter().fold(1.0, |most, material| max(most, 1.0 + material.restitution));
    let speed = bounce * max(hit.approach - shoves, 0.0);
    Strike { impulse: way * min(hit.impulse, meeting_mass(world, other, whole) * speed), speed }
}

/// Returns the effective mass of the character and the striker for a push between them, kg. The mass of a striker that
/// is jointed or cannot move counts as infinite.
fn meeting_mass(world: &World, other: BodyId, whole: f32) -> f32 {
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

/// Returns the hit of a body that passes through one of the character's bodies, as if the two stopped each other.
fn passing(world: &World, own: BodyId, other: BodyId, whole: f32) -> Strike {
    let gone = !world.contains(other) || !world.contains(own);
    if gone || world.kind(other) != BodyKind::Dynamic || world.kind(own) == BodyKind::Dynamic {
        return Strike::default();
    }
    let relative = world.velocity(other).linear - world.velocity(own).linear;
    let toward = world.center_of_mass(own) - world.center_of_mass(other);
    let way = normalize_or(toward, Vec3::ZERO);
    // Only the striker's own motion counts.
    let comes = max(world.velocity(other).linear.dot(way), 0.0);
    let closing = max(relative.dot(way), 0.0);
    let speed = min(closing, comes);
    Strike { impulse: way * (meeting_mass(world, other, whole) * speed), speed }
}
