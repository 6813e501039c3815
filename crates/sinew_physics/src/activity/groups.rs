//! Wakes sleeping particle groups, and the bodies that fell asleep with them.

use super::Activity;
use crate::arena::Arena;
use crate::body::def::{BodyKind, Sleeping, WorldDef};
use crate::body::{Body, Rest};
use crate::contact::proxies::{Owner, Proxies};
use crate::particles::ParticleGroup;
use core::ops::ControlFlow;
use sinew_math::{Vec3, max, normalize_or};

impl Activity {
    /// Wakes sleeping groups that a body approaches or a field pulls, or that must not sleep; bodies that sleep with a
    /// woken group; and bodies that rested on removed particles.
    pub fn wake_groups(
        &mut self,
        bodies: &mut Arena<Body>,
        groups: &mut Arena<ParticleGroup>,
        proxies: &Proxies,
        may: Sleeping,
        def: &WorldDef,
    ) {
        let (dt, distance) = (def.dt(), def.sleep_thresholds.distance);
        let mut way = None;
        for (_, group) in groups.iter_mut() {
            if may == Sleeping::Off && !group.is_awake() {
                group.wake();
            } else if !group.is_awake() {
                let way = *way.get_or_insert_with(|| self.longest_way(bodies, dt));
                if is_disturbed(group, bodies, proxies, way, dt) {
                    group.wake();
                }
            }
            if group.is_awake() && group.slept_with().is_some() {
                if let Some(partner) = sleeping_partner(bodies, group) {
                    self.wake(bodies, partner);
                }
                group.wake_particles();
            }
            if group.is_awake() && group.strays(distance) {
                self.wake_borne(bodies, group, distance, (proxies, def));
                group.settle(distance);
            }
        }
    }

    /// Wakes bodies that rested on particles that have moved away by `distance` metres.
    pub fn wake_borne(
        &mut self,
        bodies: &mut Arena<Body>,
        group: &ParticleGroup,
        distance: f32,
        (proxies, def): (&Proxies, &WorldDef),
    ) {
        let down = normalize_or(def.gravity, Vec3::ZERO);
        self.wake_met(bodies, group, (proxies, &group.left()), |shape, at| {
            group.bore(shape, at, distance, down)
        });
    }

    /// Longest path of any point of an active or kinematic body in a step, metres.
    fn longest_way(&self, bodies: &Arena<Body>, dt: f32) -> f32 {
        self.movers().fold(0.0, |most, index| max(most, bodies.at(index).fastest_point() * dt))
    }
}

/// True if a body may disturb its contacts: it moves, or the user has changed it.
fn comes(body: &Body) -> bool {
    let leads = body.kind == BodyKind::Kinematic && !body.velocity.is_zero();
    body.is_active() || leads || body.changed
}

fn is_disturbed(group: &ParticleGroup, bodies: &Arena<Body>, proxies: &Proxies, way: f32, dt: f32) -> bool {
    let Some(support) = group.sleep_support() else { return true };
    let pulls = group.carriers().any(|body| bodies.get(body).is_none_or(comes));
    let near = |Owner { body: index, shape }| {
        let (body, shape) = (bodies.at(index), shape as usize);
        let touches = comes(body)
            && !body.quarantined
            && group.meets(bodies.id(index), body.surface(shape))
            && group.is_near(
                &body.shapes[shape].shape,
                &body.world_from_shape(shape),
                body.fastest_point() * dt,
            );
        if touches { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    pulls || proxies.overlapping(&support.bounds.expand(way), near).is_break()
}

/// True if the body sleeps in the island with number `island`.
fn sleeps_in(bodies: &Arena<Body>, index: u32, island: u32) -> bool {
    bodies.try_at(index).is_some_and(|body| body.rest == Rest::Asleep { island })
}

/// Index of a body that fell asleep with a group and still sleeps.
pub(crate) fn sleeping_partner(bodies: &Arena<Body>, group: &ParticleGroup) -> Option<u32> {
    let island = group.slept_with()?;
    group.partner().filter(|&index| sleeps_in(bodies, index, island))
}

/// Wakes a sleeping group if the bodies that fell asleep with the group are awake.
pub(crate) fn follow(bodies: &Arena<Body>, group: &mut ParticleGroup) {
    if group.partner().is_some() && sleeping_partner(bodies, group).is_none() {
        group.wake_particles();
    }
}

/// Recomputes the surroundings stored for sleeping groups.
pub(crate) fn store_sleep_supports(bodies: &Arena<Body>, groups: &mut Arena<ParticleGroup>) {
    for (_, group) in groups.iter_mut() {
        let Some(island) = group.slept_with() else { continue };
        let partner = (0..bodies.slot_count() as u32).find(|&index| sleeps_in(bodies, index, island));
        group.store_sleep_support(partner);
    }
}
