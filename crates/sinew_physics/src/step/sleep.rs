//! The stage `sleep` stops simulating an island whose bodies have all stayed in place for a while. The test compares
//! displacements: a squeezed body that vibrates may sleep, a creeping body may not.

use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::def::{SleepThresholds, Sleeping, WorldDef};
use crate::body::{Body, Gain, Rest, Velocity};
use crate::field::Fields;
use crate::particles::ParticleGroup;
use crate::step::islands::Islands;
use crate::step::tuning::{CREEP, GAINED, HANGING_SPEED, HANGING_SPIN, PUSHED_SPEED};
use sinew_math::Vec3;

/// Updates the rest time of every body and particle group, and puts islands to sleep. `sleepers` is the number of the
/// next sleeping island; `of_groups` permits groups to sleep. A group keeps the bodies attached to it awake; bodies it
/// touches may fall asleep before it.
pub(crate) fn sleep(
    islands: &Islands,
    (bodies, groups): (&mut Arena<Body>, &mut Arena<ParticleGroup>),
    (activity, sleepers): (&mut Activity, &mut u32),
    fields: &Fields<'_>,
    of_groups: Sleeping,
    def: &WorldDef,
) {
    let thresholds = &def.sleep_thresholds;
    for island in islands.iter() {
        let mut least = f32::INFINITY;
        for &index in island.bodies {
            let body = bodies.at_mut(index);
            let creeps_little = is_slower(
                body,
                CREEP * thresholds.distance / thresholds.time,
                thresholds.angle / thresholds.time,
            ) && !is_pushed_out(body, def.dt());
            if creeps_little {
                body.place = body.world_from_principal;
            }
            let calm = body.sleeping == Sleeping::On
                && is_slower(body, thresholds.speed, thresholds.spin)
                && !(island.joints.is_empty() && gains(body, thresholds))
                && (creeps_little || stays(body, thresholds))
                && (island.groups.is_empty() || hangs_still(body, def.dt()))
                && !fields.keep_awake(body);
            least = sinew_math::min(least, count(body, calm, def.dt()));
        }
        let resting = if of_groups == Sleeping::On { island.groups } else { &[] };
        for &index in resting {
            let group = groups.at_mut(index);
            let may = if fields.keep_group_awake(group) { Sleeping::Off } else { Sleeping::On };
            let calm = group.count_rest(may, thresholds, def.dt());
            if group.holds_bodies() {
                least = sinew_math::min(least, calm);
            }
        }
        if least >= thresholds.time && def.sleeping == Sleeping::On {
            activity.sleep(bodies, island.bodies, *sleepers);
            let mut any = !island.bodies.is_empty();
            for &index in resting {
                let group = groups.at_mut(index);
                if group.has_rested(thresholds.time) {
                    group.fall_asleep(*sleepers, island.bodies.first().copied());
                    any = true;
                }
            }
            *sleepers = sleepers.wrapping_add(u32::from(any));
        }
    }
}

/// Updates and returns the time at rest of a body, seconds; negative infinity if the body is not calm.
fn count(body: &mut Body, calm: bool, dt: f32) -> f32 {
    match &mut body.rest {
        Rest::Awake { rest_time: time } if calm => {
            *time += dt;
            *time
        }
        _ => {
            body.disturb();
            f32::NEG_INFINITY
        }
    }
}

/// True if the net load accelerates the body steadily, as for a ball that stays slow for a second at its turning point
/// on a slope. Not tested for bodies with joints, which sag for seconds against joint friction.
fn gains(body: &Body, thresholds: &SleepThresholds) -> bool {
    let Gain { velocity: Velocity { linear, angular }, time } = body.gain;
    let is_fast = |gain: Vec3, threshold: f32| gain.length() >= GAINED * threshold / thresholds.time;
    time >= 0.5 * thresholds.time
        && (is_fast(linear, thresholds.distance) || is_fast(angular, thresholds.angle))
}

fn stays(body: &Body, thresholds: &SleepThresholds) -> bool {
    let (was, is) = (body.place, body.world_from_principal);
    (is.translation - was.translation).length() < thresholds.distance
        && is.rotation.angle_to(was.rotation) < thresholds.angle
}

/// True if contacts displaced a slow body in this step.
fn is_pushed_out(body: &Body, dt: f32) -> bool {
    (body.world_from_principal.translation - body.previous.translation).length() > PUSHED_SPEED * dt
}

/// True if a body on particles hardly moved in this step. Its velocity does not show this: springs act for the coming
/// substep and give the body a velocity that its weight will cancel.
fn hangs_still(body: &Body, dt: f32) -> bool {
    let (was, is) = (body.previous, body.world_from_principal);
    (is.translation - was.translation).length() < HANGING_SPEED * dt
        && is.rotation.angle_to(was.rotation) < HANGING_SPIN * dt
}

fn is_slower(body: &Body, speed: f32, spin: f32) -> bool {
    body.velocity.linear.length() < speed && body.velocity.angular.length() < spin
}
