//! Mutual attraction of bodies and particles.

use super::def::{FieldDef, not_negative};
use super::gravity::{attraction, potential};
use super::target::Target;
use core::f32::consts::PI;
use sinew_geometry::DefError;
use sinew_math::Vec3;

/// Newton's gravitation between all dynamic bodies and particles that the field reaches.
///
/// Two masses at distance `d` pull each other with the **same** force `G m₁ m₂ d / (d² + ε²)^(3/2)` in opposite
/// directions (Newton's third law). The force is computed as `m₁ ((G m₂) / d²)` with `m₂` the heavier, so that masses
/// of stars in kilograms do not overflow. The moment of inertia of a star would overflow, so set one explicitly, or use
/// other units: in astronomical units, solar masses and years `G` is [`ASTRONOMICAL`](Self::ASTRONOMICAL).
///
/// Bodies that attract each other form one island. Each substep uses their current positions and applies each pair's
/// impulse to both, so the sum of momenta is constant up to rounding. Static and kinematic bodies have no mass for this
/// field; for a fixed attractor use [`PointGravity`](super::PointGravity). `gravity_scale` is ignored, because it would
/// break the third law. In a fading region a pair's force is scaled by the product of the strengths at both positions.
/// The cost is quadratic in the number of bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct MutualGravity {
    /// `G`. Default 6.6743e-11 m³/(kg s²) (CODATA 2018).
    pub constant: f32,
    /// ε (Plummer 1911), metres, ≥ 0: keeps close encounters finite. Default 0.
    pub softening: f32,
}

impl Default for MutualGravity {
    fn default() -> Self {
        Self { constant: 6.6743e-11, softening: 0.0 }
    }
}

/// A body or particle that takes part in the attraction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attractor {
    pub position: Vec3,
    pub mass: f32,
    /// Weight of the field at the attractor's position, 0..=1.
    pub weight: f32,
}

impl MutualGravity {
    /// `G = 4π²`, with lengths in astronomical units, masses in solar masses and times in years: Kepler's third law for
    /// the Earth. A step is then 1/60 of a year.
    pub const ASTRONOMICAL: f32 = 4.0 * PI * PI;

    pub(super) fn check(&self) -> Result<(), DefError> {
        let valid = self.constant.is_finite() && not_negative(self.softening);
        if valid {
            Ok(())
        } else {
            Err(DefError::new("a constant of gravitation must be finite, its softening not negative"))
        }
    }

    /// Force on `a` by `b`, N; the force on `b` is the opposite.
    pub(crate) fn force(&self, a: &Attractor, b: &Attractor) -> Vec3 {
        // Uses the heavier mass first, so that both sides of a pair get the same bits.
        let (heavy, light) = if a.mass > b.mass { (a.mass, b.mass) } else { (b.mass, a.mass) };
        let pull = attraction(b.position - a.position, self.constant * heavy, self.softening);
        pull * (light * (a.weight * b.weight))
    }

    /// Potential energy of a pair, J.
    pub(crate) fn energy(&self, a: &Attractor, b: &Attractor) -> f32 {
        potential(b.position - a.position, self.constant * b.mass, self.softening) * a.mass
    }

    /// Adds each pair's force to `forces`, which has one entry per item.
    pub(crate) fn attract(&self, attractors: &[Attractor], forces: &mut [Vec3]) {
        for (i, a) in attractors.iter().enumerate() {
            for (j, b) in attractors.iter().enumerate().skip(i + 1) {
                let force = self.force(a, b);
                forces[i] += force;
                forces[j] -= force;
            }
        }
    }
}

pub(crate) fn attractor(field: &FieldDef, target: &Target<'_>) -> Attractor {
    Attractor { position: target.center(), mass: target.mass, weight: field.weight(target) }
}
