//! `sleep`: an island in which every body has stayed in its place for a while stops being simulated. It is displacement
//! that counts: a body held between others may tremble and still sleep, one that creeps may not.

use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::{Body, Rest};
use crate::def::{SleepThresholds, Sleeping, WorldDef};
use crate::field::Fields;
use crate::islands::Islands;

/// What hangs on particles swings about its place, and must come to rest before it may sleep: below both of these, m/s and
/// rad/s.
const SLOW_LINEAR: f32 = 0.02;
const SLOW_ANGULAR: f32 = 0.05;

/// Counts the calm time of every body and puts islands to sleep. `sleepers` numbers them.
pub(crate) fn sleep(
    islands: &Islands,
    bodies: &mut Arena<Body>,
    activity: &mut Activity,
    fields: &Fields<'_>,
    sleepers: &mut u32,
    def: &WorldDef,
) {
    let thresholds = &def.sleep_thresholds;
    for island in islands.iter() {
        let mut least = f32::INFINITY;
        for &index in island.bodies {
            let body = bodies.at_mut(index);
            let calm = body.sleeping == Sleeping::On
                && stays(body, thresholds)
                && (island.groups.is_empty() || is_slow(body))
                && !fields.keep_awake(body);
            least = sinew_math::min(least, count(body, calm, def.dt()));
        }
        let rests = least >= thresholds.time && !island.bodies.is_empty();
        if rests && def.sleeping == Sleeping::On {
            activity.sleep(bodies, island.bodies, *sleepers);
            *sleepers = sleepers.wrapping_add(1);
        }
    }
}

/// For how long a body has been calm, seconds.
fn count(body: &mut Body, calm: bool, dt: f32) -> f32 {
    match &mut body.rest {
        Rest::Awake { calm: time } if calm => {
            *time += dt;
            *time
        }
        _ => {
            body.disturb();
            0.0
        }
    }
}

fn stays(body: &Body, thresholds: &SleepThresholds) -> bool {
    let (was, is) = (body.place, body.world_from_principal);
    (is.translation - was.translation).length() < thresholds.distance
        && is.rotation.angle_to(was.rotation) < thresholds.angle
        && body.velocity.linear.length() < thresholds.speed
        && body.velocity.angular.length() < thresholds.spin
}

fn is_slow(body: &Body) -> bool {
    body.velocity.linear.length() < SLOW_LINEAR && body.velocity.angular.length() < SLOW_ANGULAR
}
