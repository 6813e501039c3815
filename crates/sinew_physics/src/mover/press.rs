//! Mutual effect of a mover and dynamic bodies: hits by momentum, pushes by limited force, weight.

use super::obstacle::{Owner, Surroundings};
use super::{Bearer, Mover};
use crate::arena::Arena;
use crate::body::Body;
use crate::body::def::BodyKind;
use crate::boxes::Overlap;
use crate::mover::tuning::{BEARING_COSINE, LEAVE_RATE, LEAVE_SPEED};
use crate::world::World;
use sinew_math::{Vec3, max, min};

/// Impulse or force that a body gets from a mover.
#[derive(Clone, Copy, Debug)]
pub(super) struct Press {
    body: u32,
    push: Push,
    point: Vec3,
    /// True if the press wakes a sleeping body.
    wakes: bool,
}

#[derive(Clone, Copy, Debug)]
enum Push {
    /// Impulse, applied immediately, N·s.
    Impulse(Vec3),
    /// Force during the next step, newtons.
    Force(Vec3),
}

/// State of a mover as a body in a collision.
struct Hitter {
    velocity: Vec3,
    up: Vec3,
    inverse_mass: f32,
    grounded: bool,
    force: f32,
}

/// Computes the impulses between a mover at `center` and the dynamic bodies it touches within the step; returns the
/// mover's change of velocity, m/s.
pub(super) fn meet(
    sight: &Surroundings<'_>,
    mover: &Mover,
    center: Vec3,
    dt: f32,
    presses: &mut Vec<Press>,
) -> Vec3 {
    let mut hitter = Hitter {
        velocity: mover.velocity(),
        up: mover.def.up,
        inverse_mass: 1.0 / mover.def.mass,
        grounded: mover.ground.is_some(),
        force: mover.def.push_force,
    };
    let on = mover.ground.and_then(|footing| match footing.on {
        Bearer::Shape { body, .. } => Some(body.index),
        Bearer::Mover(_) => None,
    });
    let before = hitter.velocity;
    for obstacle in sight.obstacles {
        let Owner::Shape(index, ..) = obstacle.owner else { continue };
        let body = sight.bodies.at(index);
        if obstacle.kind != BodyKind::Dynamic || on == Some(index) {
            continue;
        }
        let reach = (body.velocity.linear.length()
            + body.velocity.angular.length() * body.reach()
            + hitter.velocity.length())
            * dt
            + mover.def.skin * 1.1;
        if !obstacle.bounds.overlaps(&sight.bounds(center, Vec3::ZERO, reach)) {
            continue;
        }
        let Some(gap) = sight.gap(obstacle, center) else { continue };
        let room = gap.distance - mover.def.skin;
        if let Some(impulse) = hitter.meet(body, gap.normal, gap.on_a, room, dt) {
            let push = Push::Impulse(-gap.normal * impulse);
            presses.push(Press { body: index, push, point: gap.on_a, wakes: true });
        }
    }
    hitter.velocity - before
}

impl Hitter {
    /// Applies the impulse that pushes the mover and a body apart to the mover, and returns it, N·s; `None` if there is
    /// none.
    fn meet(&mut self, body: &Body, normal: Vec3, point: Vec3, room: f32, dt: f32) -> Option<f32> {
        let arm = point - body.center();
        let (comes, walks) = (body.velocity.at(arm).dot(normal), -self.velocity.dot(normal));
        let closing = comes + walks;
        let deep = min(max(-room, 0.0) * LEAVE_RATE, LEAVE_SPEED);
        let excess = closing + deep - max(room, 0.0) / dt;
        if excess <= 0.0 || closing + deep <= 1e-4 {
            return None;
        }
        let turn = body.inverse_inertia_mul(arm.cross(normal)).cross(arm).dot(normal);
        let response = body.inverse_mass() + turn;
        let rise = normal.dot(self.up);
        // A body between the mover and the ground does not yield downward.
        let braced = self.grounded && rise < 0.0;
        let own = if braced { self.inverse_mass * (1.0 - rise * rise) } else { self.inverse_mass };
        let inelastic = |speed: f32| speed / (response + self.inverse_mass);
        let wanted = excess / (response + own);
        let hit = if rise > BEARING_COSINE { wanted } else { inelastic(min(max(comes, 0.0), excess)) };
        let impulse = min(wanted, hit + self.force * dt);
        self.velocity += normal * (impulse * own);
        Some(impulse)
    }
}

/// Weight of a mover, newtons along its down direction.
fn weight_of(mover: &Mover, gravity: Vec3) -> f32 {
    max(-(gravity * mover.def.gravity_scale).dot(mover.def.up), 0.0) * mover.def.mass
}

/// Returns the index of the dynamic body under a mover, the body, and the contact point.
fn bearer<'a>(bodies: &'a Arena<Body>, mover: &Mover) -> Option<(u32, &'a Body, Vec3)> {
    let footing = mover.ground?;
    let Bearer::Shape { body: id, .. } = footing.on else { return None };
    let body = bodies.get(id).filter(|body| body.kind == BodyKind::Dynamic)?;
    Some((id.index, body, footing.point))
}

/// Adds the weight of a mover on its ground as a force: an impulse of the same size would throw a light body, such as
/// the hand of a lying character.
pub(super) fn weigh(
    (bodies, gravity): (&Arena<Body>, Vec3),
    mover: &Mover,
    is_new: bool,
    presses: &mut Vec<Press>,
) {
    if let Some((body, _, point)) = bearer(bodies, mover) {
        let push = Push::Force(-mover.def.up * weight_of(mover, gravity));
        presses.push(Press { body, push, point, wakes: is_new });
    }
}

/// Returns the work of a mover's weight in the last step, joules, from the displacement and rotation of the supporting
/// body. Force and torque were constant.
pub(super) fn work_of_weight(bodies: &Arena<Body>, mover: &Mover, gravity: Vec3) -> f32 {
    let Some((_, body, point)) = bearer(bodies, mover) else { return 0.0 };
    let (from, to) = (body.previous, body.world_from_principal);
    let force = -mover.def.up * weight_of(mover, gravity);
    let torque = (point - from.translation).cross(force);
    force.dot(to.translation - from.translation)
        + torque.dot(from.rotation.angular_velocity_to(to.rotation, 1.0))
}

/// Applies the movers' forces and impulses to bodies.
pub(super) fn apply(world: &mut World, presses: &mut Vec<Press>) {
    for &Press { body: index, push, point, wakes } in presses.iter() {
        let body = world.bodies.at(index);
        if !body.is_awake() && !wakes {
            continue;
        }
        let id = world.bodies.id(index);
        match push {
            Push::Impulse(impulse) if impulse.is_finite() => {
                let before = world.body_energy(id).kinetic;
                world.apply_impulse(id, impulse, point);
                world.work.movers += world.body_energy(id).kinetic - before;
            }
            Push::Force(force) if force.is_finite() => world.apply_force(id, force, point),
            Push::Impulse(_) | Push::Force(_) => {}
        }
    }
    presses.clear();
}
