//! The stage `finalize` writes the state that the islands computed to the bodies.

use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::def::WorldDef;
use crate::body::{Body, Velocity};
use crate::contact::events::{Events, Push};
use crate::context::StepContext;
use crate::solver::SolvedBody;
use crate::step::islands::Islands;
use crate::step::tuning::FASTEST_KINEMATIC;
use sinew_math::{Vec3, max};

/// `finalize`: writes poses and velocities. A body with a non-finite state keeps its old pose, stops and is
/// quarantined. Kinematic bodies move according to their velocity, and the forces on them are reported. Clears the
/// forces of the step.
pub(crate) fn finalize(
    islands: &Islands,
    bodies: &mut Arena<Body>,
    activity: &mut Activity,
    events: &mut Events,
    def: &WorldDef,
    context: &StepContext<'_>,
) {
    let rest = &def.sleep_thresholds;
    let gain = (rest.distance / rest.angle, max(1.0 - context.dt / max(rest.time, context.dt), 0.0));
    events.quarantined.clear();
    events.limited.clear();
    events.pushed.clear();
    for SolvedBody { index, pose, velocity, is_limited } in &islands.solution().bodies {
        let body = bodies.at_mut(*index);
        body.previous = body.world_from_principal;
        body.force = Vec3::ZERO;
        body.torque = Vec3::ZERO;
        if pose.is_finite() && velocity.linear.is_finite() && velocity.angular.is_finite() {
            body.world_from_principal = *pose;
            let change = Velocity {
                linear: velocity.linear - body.velocity.linear,
                angular: velocity.angular - body.velocity.angular,
            };
            body.gain.add(&change, context.dt, gain);
            body.velocity = *velocity;
            if *is_limited {
                let id = bodies.id(*index);
                events.limited.push(id);
            }
        } else {
            body.velocity = Default::default();
            body.quarantined = true;
            activity.note(*index, body);
            let id = bodies.id(*index);
            events.quarantined.push(id);
        }
    }
    for &index in activity.kinematic() {
        let id = bodies.id(index);
        let body = bodies.at_mut(index);
        body.previous = body.world_from_principal;
        let (force, torque) = (core::mem::take(&mut body.force), core::mem::take(&mut body.torque));
        if force != Vec3::ZERO || torque != Vec3::ZERO {
            let (impulse, angular_impulse) = (force * context.dt, torque * context.dt);
            events.pushed.push(Push { body: id, impulse, angular_impulse });
        }
        if body.velocity.reaches(FASTEST_KINEMATIC) {
            events.limited.push(id);
        }
        let carried = body.carried(context.h, context.substeps);
        if (carried * body.principal_from_body).is_finite() {
            body.world_from_principal = carried;
        } else {
            body.velocity = Default::default();
            body.quarantined = true;
            events.quarantined.push(id);
        }
    }
    events.limited.sort_unstable();
}
