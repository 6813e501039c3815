//! Drag by a law in the velocity.

use super::def::not_negative;
use super::{Load, Target};
use sinew_geometry::DefError;
use sinew_math::Vec3;

/// Resistance of a medium, independent of the shape. With `w` the velocity relative to the medium:
///
/// ```text
/// F = −(linear + quadratic |w|) w        τ = −angular ω
/// ```
///
/// The linear part suits small slow bodies (Stokes: `6π η r` for a ball in a viscous fluid), the quadratic part fast
/// ones (Newton: `½ ρ C A`). A falling ball reaches `v = (√(c² + 4 k m g) − c) / 2k`: `m g / c` without the quadratic
/// part, `√(m g / k)` without the linear one. For drag by the exposed area of shapes use [`Wind`](super::Wind). For a
/// body that loses a share of its velocity per second use `BodyDef::linear_damping`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Drag {
    /// Linear coefficient c, N·s/m, ≥ 0. Default 0.
    pub linear: f32,
    /// Quadratic coefficient k, N·s²/m², ≥ 0. Default 0.
    pub quadratic: f32,
    /// Angular coefficient, N·m·s, ≥ 0. Default 0.
    pub angular: f32,
    /// Velocity of the medium, m/s. Default 0.
    pub flow: Vec3,
}

impl Drag {
    pub(super) fn check(&self) -> Result<(), DefError> {
        let valid = not_negative(self.linear) && not_negative(self.quadratic) && not_negative(self.angular);
        if valid && self.flow.is_finite() {
            Ok(())
        } else {
            Err(DefError::new("drag must not be negative, and its flow finite"))
        }
    }

    pub(super) fn act(&self, target: &Target<'_>, load: &mut Load) {
        let against = target.velocity.linear - self.flow;
        let speed = against.length();
        load.push_at(
            Vec3::ZERO,
            -against * (self.linear + self.quadratic * speed),
            self.linear + 2.0 * self.quadratic * speed,
        );
        load.wrench.torque -= target.velocity.angular * self.angular;
        load.spin_resistance += self.angular;
    }
}
