//! Random joint rotations within their limits.
//!
//! ```
//! use sinew_math::{Random, Range};
//! use sinew_physics::JointKind;
//! use sinew_ragdoll::limits::sample::random_turn;
//!
//! let knee = JointKind::Hinge { limit: Some(Range { lo: 0.0, hi: 2.4 }) };
//! let mut random = Random::new(1);
//! for _ in 0..100 {
//!     // Within the middle half of the range.
//!     let angle = random_turn(knee, &mut random, 0.5).to_axis_angle().1;
//!     assert!((0.6 - 1e-3..1.8 + 1e-3).contains(&angle), "{angle} rad");
//! }
//! ```

use crate::tuning::INSCRIBED;
use sinew_math::{Random, Range, Rotation, SwingTwistLimit, Vec3};
use sinew_physics::JointKind;

/// Range of random rotations of a joint without limits, radians.
const FREE: Range = Range::symmetric(1.0);

/// Returns a joint rotation (joint frame of the parent to that of the child) within `share` of each range, about its
/// centre.
///
/// # Panics
/// If the joint also translates.
pub fn random_turn(kind: JointKind, random: &mut Random, share: f32) -> Rotation {
    let within = |random: &mut Random, range: Range| {
        range.center() + 0.5 * (range.hi - range.lo) * share * random.range(-1.0, 1.0)
    };
    let free = SwingTwistLimit { swing_y: FREE, swing_z: FREE, twist: FREE };
    match kind {
        JointKind::Ball { limit } | JointKind::Universal { limit } => {
            let limit = limit.unwrap_or(free);
            let [y, z] = [limit.swing_y, limit.swing_z].map(|range| INSCRIBED * within(random, range));
            let swing = Rotation::from_scaled_axis(Vec3::new(0.0, y, z));
            let ball = matches!(kind, JointKind::Ball { .. });
            let twist = if ball { within(random, limit.twist) } else { 0.0 };
            swing * Rotation::from_axis_angle(Vec3::X, twist)
        }
        JointKind::Hinge { limit } => {
            Rotation::from_axis_angle(Vec3::X, within(random, limit.unwrap_or(FREE)))
        }
        JointKind::Fixed => Rotation::IDENTITY,
        kind => unreachable!("a ragdoll has only joints that rotate or are fixed, not {kind:?}"),
    }
}
