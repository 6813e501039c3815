//! Turns an animated character into a physical one at the speed of the animation.
//!
//! ```
//! use sinew_math::{Transform, Vec3};
//! use sinew_ragdoll::hand_over::{SpeedBound, body_velocity};
//!
//! // An arm that a clip moved by 5 cm within a step, and a capture's glitch of 3 m.
//! let (before, dt) = (Transform::IDENTITY, 1.0 / 60.0);
//! let after = |way| Transform::from_translation(Vec3::X * way);
//! let speed = |way| body_velocity(before, after(way), Vec3::ZERO, dt, SpeedBound::default()).linear.x;
//! assert!((speed(0.05) - 3.0).abs() < 1e-4);
//! assert!((speed(3.0) - 30.0).abs() < 1e-4);
//! ```

use crate::def::RagdollDef;
use sinew_math::{Transform, Vec3};
use sinew_physics::Velocity;

/// Largest speeds of a body at its hand-over. Glitches of motion capture exceed them; people do not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedBound {
    /// Largest linear speed, m/s. Default 30.
    pub linear: f32,
    /// Largest angular speed, rad/s. Default 40.
    pub angular: f32,
}

impl Default for SpeedBound {
    fn default() -> Self {
        Self { linear: 30.0, angular: 40.0 }
    }
}

/// Returns the velocity of a body that moves from `before` to `after` within `dt` seconds: linear at its centre of mass
/// (`center` in the body's frame), and angular. The result is exact for motion at constant velocity with a rotation
/// below half a turn.
///
/// # Panics
/// If `dt` is not positive.
pub fn body_velocity(
    before: Transform,
    after: Transform,
    center: Vec3,
    dt: f32,
    bound: SpeedBound,
) -> Velocity {
    assert!(dt > 0.0, "the time between two poses must be positive, not {dt} s");
    Velocity {
        linear: shortened((after.point(center) - before.point(center)) / dt, bound.linear),
        angular: shortened(before.rotation.angular_velocity_to(after.rotation, dt), bound.angular),
    }
}

/// Computes [`body_velocity`] of all bodies of a ragdoll; `velocities` is cleared and filled. Bodies with these
/// velocities have the linear and angular momentum of the animated pose, whether clips, blends or transitions produced
/// the two poses.
///
/// # Panics
/// If `dt` is not positive, or there is not one pose per body.
pub fn body_velocities(
    def: &RagdollDef,
    before: &[Transform],
    after: &[Transform],
    dt: f32,
    bound: SpeedBound,
    velocities: &mut Vec<Velocity>,
) {
    assert_eq!(
        [before.len(), after.len()],
        [def.bodies.len(); 2],
        "each body needs one pose before and one after"
    );
    velocities.clear();
    let poses = before.iter().zip(after).zip(&def.bodies);
    velocities.extend(
        poses.map(|((&before, &after), body)| body_velocity(before, after, body.mass.center, dt, bound)),
    );
}

/// Returns `v` shortened to the length `longest`; zero if `v` is not finite.
fn shortened(v: Vec3, longest: f32) -> Vec3 {
    let length = v.length();
    if !v.is_finite() {
        Vec3::ZERO
    } else if length > longest {
        v * (longest / length)
    } else {
        v
    }
}
