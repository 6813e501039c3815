//! Explosions: fields that act for an instant.

use super::Fade;
use super::def::{not_negative, positive};
use super::exposed::exposed;
use crate::body::shape::Shape;
use sinew_geometry::DefError;
use sinew_math::{Transform, Vec3, max, normalize_or};

/// A blast: pressure so short that it acts as an impulse.
///
/// Each shape gets `J = impulse × fade(1 − d/radius) × A` at its centre, in the direction from the centre of the blast
/// to the centre of the shape. `d` is the distance from the blast to the shape's nearest point (0 inside). `A` is the
/// shape's area projected from the blast (for a ball `π r²`; for a box the facing faces times the cosine of their
/// angle; a particle is a ball). Static bodies are not affected; for kinematic bodies the next step only
/// [reports](crate::Events::pushed) the impulse.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Explosion {
    /// Centre of the blast, world, metres.
    pub center: Vec3,
    /// Radius of effect, metres, positive.
    pub radius: f32,
    /// Impulse per area at the centre, N·s/m² (Pa·s), ≥ 0.
    pub impulse: f32,
    /// Decrease of the impulse with distance.
    pub fade: Fade,
    /// Obstacles that shelter shapes from the blast.
    pub occlusion: Occlusion,
    /// Bits of the layers that the blast acts on.
    pub layers: u32,
}

/// Obstacles that shelter from a blast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Occlusion {
    /// No obstacles shelter. Default.
    #[default]
    None,
    /// Static bodies shelter: a shape gets no impulse if one is between the blast and the shape's centre.
    Static,
}

impl Explosion {
    /// Returns an explosion with linear fall-off, on all layers, without shelter.
    pub fn new(center: Vec3, radius: f32, impulse: f32) -> Self {
        Self { center, radius, impulse, fade: Fade::Linear, occlusion: Occlusion::None, layers: u32::MAX }
    }

    /// Checks that the numbers of the explosion are valid; the error phrase names the problem.
    ///
    /// # Errors
    /// Returns a phrase that names the problem, in lower case.
    pub fn check(&self) -> Result<(), DefError> {
        let valid = self.center.is_finite() && positive(self.radius) && not_negative(self.impulse);
        if valid {
            Ok(())
        } else {
            Err(DefError::new("an explosion's place, radius and impulse must be finite"))
        }
    }

    /// Returns the impulse on a shape, N·s, and the point at which it acts, world.
    pub(crate) fn push(&self, shape: &Shape, at: &Transform) -> (Vec3, Vec3) {
        let distance = max(shape.signed_distance(at, self.center).0, 0.0);
        if distance >= self.radius {
            return (Vec3::ZERO, at.translation);
        }
        let outward = normalize_or(at.translation - self.center, Vec3::Y);
        let mut area = 0.0;
        exposed(shape, at, outward, |panel| {
            area += panel.area * panel.normal.map_or(1.0, |normal| max(-outward.dot(normal), 0.0));
        });
        let strength = self.impulse * self.fade.strength(1.0 - distance / self.radius);
        (outward * (strength * area), at.translation)
    }
}
