//! `sleep`: an island in which every body has been slow for a while stops being simulated.

use crate::arena::Arena;
use crate::body::{Body, Rest, Velocity};
use crate::def::Sleeping;
use crate::islands::IslandTask;

/// Slow: below both of these, m/s and rad/s.
const SLOW_LINEAR: f32 = 0.02;
const SLOW_ANGULAR: f32 = 0.05;
/// Seconds of being slow until sleep.
const TIME_TO_SLEEP: f32 = 0.5;

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
            let slow =
                body.velocity.linear.length() < SLOW_LINEAR && body.velocity.angular.length() < SLOW_ANGULAR;
            if let Rest::Awake { calm } = &mut body.rest {
                *calm = if slow { *calm + dt } else { 0.0 };
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
