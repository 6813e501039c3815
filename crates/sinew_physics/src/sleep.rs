//! `sleep`: an island in which every body has been slow, or has stayed in its place, for a while stops being simulated.
//! Displacement counts as well as velocity: a body held between others may tremble and still sleep.

use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::{Body, Rest};
use crate::def::{Sleeping, WorldDef};
use crate::field::Fields;
use crate::islands::Islands;

/// Seconds of being slow or in place until sleep.
const TIME_TO_SLEEP: f32 = 0.5;
/// Slow: below both of these, m/s and rad/s.
const SLOW_LINEAR: f32 = 0.02;
const SLOW_ANGULAR: f32 = 0.05;
/// In place: within both of these of where it was when it was last slow, m and rad. What sets off from rest leaves them
/// before it may sleep; a body that trembles between others does not.
const PLACE_LINEAR: f32 = 0.003;
const PLACE_ANGULAR: f32 = 0.025;
/// Faster than either of these is no trembling, m/s and rad/s.
const TREMBLE_LINEAR: f32 = 0.2;
const TREMBLE_ANGULAR: f32 = 1.0;

/// Counts the calm time of every body and puts islands to sleep. `sleepers` numbers them.
pub(crate) fn sleep(
    islands: &Islands,
    bodies: &mut Arena<Body>,
    activity: &mut Activity,
    fields: &Fields<'_>,
    sleepers: &mut u32,
    def: &WorldDef,
) {
    let dt = def.dt();
    for island in islands.iter() {
        let mut least = f32::INFINITY;
        for &index in island.bodies {
            let body = bodies.at_mut(index);
            let slow = is_slow(body);
            let in_place = (slow || (stays(body) && island.groups.is_empty())) && !fields.keep_awake(body);
            if slow || !in_place {
                body.place = body.world_from_principal;
            }
            if let Rest::Awake { calm } = &mut body.rest {
                *calm = if in_place { *calm + dt } else { 0.0 };
                least = sinew_math::min(*calm, least);
            }
        }
        if def.sleeping == Sleeping::On && least >= TIME_TO_SLEEP && !island.bodies.is_empty() {
            activity.sleep(bodies, island.bodies, *sleepers);
            *sleepers = sleepers.wrapping_add(1);
        }
    }
}

fn is_slow(body: &Body) -> bool {
    body.velocity.linear.length() < SLOW_LINEAR && body.velocity.angular.length() < SLOW_ANGULAR
}

/// Trembles about its place. Bodies on springs swing about it, and must come to rest before they may sleep.
fn stays(body: &Body) -> bool {
    let (was, is) = (body.place, body.world_from_principal);
    (is.translation - was.translation).length() < PLACE_LINEAR
        && is.rotation.angle_to(was.rotation) < PLACE_ANGULAR
        && body.velocity.linear.length() < TREMBLE_LINEAR
        && body.velocity.angular.length() < TREMBLE_ANGULAR
}
