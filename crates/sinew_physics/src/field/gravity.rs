//! External gravity: uniform, and toward a point.

use super::Target;
use super::def::not_negative;
use sinew_geometry::DefError;
use sinew_math::Vec3;

/// Uniform acceleration in addition to the world's own gravity: `F = s m a`, with `s` the gravity scale of the body or
/// group.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct UniformGravity {
    /// Acceleration, m/s², world axes.
    pub acceleration: Vec3,
}

impl UniformGravity {
    pub(super) fn check(&self) -> Result<(), DefError> {
        if self.acceleration.is_finite() {
            Ok(())
        } else {
            Err(DefError::new("an acceleration must be finite"))
        }
    }

    pub(super) fn force(&self, target: &Target<'_>) -> Vec3 {
        self.acceleration * (target.mass * target.gravity_scale)
    }

    pub(super) fn energy(&self, target: &Target<'_>) -> f32 {
        -self.force(target).dot(target.center())
    }
}

/// Attraction toward a fixed point: a planet far heavier than all bodies around it.
///
/// Newton's law with Plummer's softening: with `d` the vector to the centre, `a = μ d / (|d|² + ε²)^(3/2)`, scaled by
/// the gravity scale of the body or group. With ε = 0 the force is zero at the centre itself.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct PointGravity {
    /// Centre of attraction, world, metres.
    pub center: Vec3,
    /// `μ = G M`, m³/s². Negative values repel. Default 0.
    pub strength: f32,
    /// ε, metres, ≥ 0: limits the attraction within this distance. Default 0.
    pub softening: f32,
}

impl Default for PointGravity {
    fn default() -> Self {
        Self { center: Vec3::ZERO, strength: 0.0, softening: 0.0 }
    }
}

impl PointGravity {
    pub(super) fn check(&self) -> Result<(), DefError> {
        let valid = self.center.is_finite() && self.strength.is_finite() && not_negative(self.softening);
        if valid { Ok(()) } else { Err(DefError::new("a centre of gravity and its strength must be finite")) }
    }

    pub(super) fn force(&self, target: &Target<'_>) -> Vec3 {
        let pull = attraction(self.center - target.center(), self.strength, self.softening);
        pull * (target.mass * target.gravity_scale)
    }

    /// Potential energy, J: `−μ m / √(d² + ε²)`.
    pub(super) fn energy(&self, target: &Target<'_>) -> f32 {
        let depth = potential(self.center - target.center(), self.strength, self.softening);
        depth * (target.mass * target.gravity_scale)
    }
}

/// Acceleration toward a mass at `apart`, m/s². Divides by the distance one power at a time, so that no intermediate
/// factor overflows.
pub(super) fn attraction(apart: Vec3, strength: f32, softening: f32) -> Vec3 {
    let distance = (apart.length_squared() + softening * softening).sqrt();
    if distance > 0.0 { (apart / distance) * (strength / distance / distance) } else { Vec3::ZERO }
}

/// Potential energy per mass, m²/s²; 0 at infinity.
pub(super) fn potential(apart: Vec3, strength: f32, softening: f32) -> f32 {
    let distance = (apart.length_squared() + softening * softening).sqrt();
    if distance > 0.0 { -strength / distance } else { 0.0 }
}
