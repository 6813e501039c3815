//! `sleep`: an island in which every body has stayed in its place for a while stops being simulated. Displacement
//! counts, not velocity: a body held between others may tremble and still sleep, one that creeps may not.

use crate::arena::Arena;
use crate::body::{Body, Rest, Velocity};
use crate::def::Sleeping;
use crate::islands::IslandTask;

/// Seconds of staying in place until sleep.
const TIME_TO_SLEEP: f32 = 0.5;
/// In place: within both of these of where it was when the time began, m and rad. A drift of 2 cm/s or 0.05 rad/s leaves
/// them in that time; a body that trembles between others does not, and may sleep.
const PLACE_LINEAR: f32 = 0.02 * TIME_TO_SLEEP;
const PLACE_ANGULAR: f32 = 0.05 * TIME_TO_SLEEP;
/// Faster than either of these is no trembling, m/s and rad/s.
const TREMBLE_LINEAR: f32 = 0.2;
const TREMBLE_ANGULAR: f32 = 1.0;

/// Counts the calm time of every body and puts islands to sleep. `sleepers` numbers them.
pub(crate) fn sleep(
    tasks: &[IslandTask],
    bodies: &mut Arena<Body>,
    sleepers: &mut u32,
    sleeping: Sleeping,
    dt: f32,
) {
    for task in tasks {
        let mut least = f32::INFINITY;
        for &index in &task.island.bodies {
            let body = bodies.at_mut(index);
            let in_place = stays(body) && (!task.island.has_particles || slow(body));
            if !in_place {
                body.place = body.world_from_principal;
            }
            if let Rest::Awake { calm } = &mut body.rest {
                *calm = if in_place { *calm + dt } else { 0.0 };
                least = sinew_math::min(*calm, least);
            }
        }
        if sleeping == Sleeping::On && least >= TIME_TO_SLEEP && !task.island.bodies.is_empty() {
            for &index in &task.island.bodies {
                let body = bodies.at_mut(index);
                body.rest = Rest::Asleep { island: *sleepers };
                body.velocity = Velocity::default();
                body.previous = body.world_from_principal;
            }
            *sleepers = sleepers.wrapping_add(1);
        }
    }
}

/// What hangs on springs swings about its place, and must come to rest before it may sleep.
fn slow(body: &Body) -> bool {
    body.velocity.linear.length() * TIME_TO_SLEEP < PLACE_LINEAR
        && body.velocity.angular.length() * TIME_TO_SLEEP < PLACE_ANGULAR
}

fn stays(body: &Body) -> bool {
    let (was, is) = (body.place, body.world_from_principal);
    (is.translation - was.translation).length() < PLACE_LINEAR
        && is.rotation.angle_to(was.rotation) < PLACE_ANGULAR
        && body.velocity.linear.length() < TREMBLE_LINEAR
        && body.velocity.angular.length() < TREMBLE_ANGULAR
}
