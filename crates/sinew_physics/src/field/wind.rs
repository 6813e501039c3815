//! Wind: moving air.

use super::def::{not_negative, positive};
use super::exposed::{exposed, face_force, stream_force};
use super::noise::turbulence;
use super::{Load, Target};
use sinew_geometry::DefError;
use sinew_math::Vec3;

/// Moving air, with drag and lift by the area that shapes expose to the air.
///
/// The formulas hold for each flat panel (the faces of a box, the strip of a capsule's cylinder) that faces the stream
/// `w`, the air's velocity minus the panel's own, with `ŵ = w/|w|`, outward normal `n`, area `A` and `c = −n·ŵ > 0`:
///
/// ```text
/// drag  = ½ ρ C_d |w|² A c ŵ        lift = ½ ρ C_l |w|² A c (−n − c ŵ)
/// ```
///
/// Round panels (a ball, the ends of a capsule, a particle) have only drag, with `A c = π r²` (Keckeisen et al., "Wind
/// Effects on Cloth", 2004; the projected areas `A c` of a convex body add up to its shadow, so the drag is the
/// standard `½ ρ C_d A |w|²`). Lee sides get no force, and bodies do not shelter others. A force acts at its panel, so
/// a plate turns in the wind, and spin is damped. Terminal velocity of a ball in still air: `√(2 m g / (ρ C_d π r²))`.
///
/// A particle sheet with [faces](crate::particles::GroupDef::faces) is thin. The air presses on either side along the
/// normal, by the square of the normal velocity, and slides along the sheet without friction. With `n` on the lee side
///
/// ```text
/// pressure = ½ ρ C_d (w·n)² A n        lift = ½ ρ C_l |w| (w·n) A (n − c ŵ), c = n·ŵ > 0
/// ```
///
/// for each face in three equal parts, each of which moves with one of its corners. A flat sheet at rest gets `½ ρ C_d
/// A |w|² cos²θ` in a wind at `θ` from its normal, and falls flat through still air at `√(2 m g / (ρ C_d A))`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Wind {
    /// Velocity of the air, m/s, world. Default 0: still air.
    pub velocity: Vec3,
    /// Density ρ of the air, kg/m³, ≥ 0. Default 1.225: sea level, 15 °C.
    pub density: f32,
    /// Drag coefficient C_d, ≥ 0. Default 1: between a ball (0.47) and a plate (1.2).
    pub drag: f32,
    /// Lift coefficient C_l, ≥ 0. Default 0.
    pub lift: f32,
    /// Time-varying gusts. Default none.
    pub gusts: Option<Gusts>,
}

/// Gusts: a velocity added to the wind's, smooth in space and time. A seed gives the same gusts on every machine.
///
/// Value noise: random vectors on a lattice of positions and times, blended by `u² (3 − 2u)` along each of the four
/// axes. The mean is 0; each component is within ± `speed`, with a standard deviation of about a third of `speed`
/// (√(0.743⁴/3)). The noise uses the time at the start of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Gusts {
    /// Largest absolute value of each component, m/s, ≥ 0.
    pub speed: f32,
    /// Distance over which gusts change, metres, positive.
    pub length: f32,
    /// Time over which gusts change, seconds, at least a nanosecond.
    pub time: f32,
    /// Seed of the noise; equal seeds give equal gusts.
    pub seed: u64,
}

impl Default for Wind {
    fn default() -> Self {
        Self { velocity: Vec3::ZERO, density: 1.225, drag: 1.0, lift: 0.0, gusts: None }
    }
}

impl Wind {
    pub(super) fn check(&self) -> Result<(), DefError> {
        if !self.velocity.is_finite() {
            return Err(DefError::new("a wind's velocity must be finite"));
        }
        if !(not_negative(self.density) && not_negative(self.drag) && not_negative(self.lift)) {
            return Err(DefError::new("a wind's density, drag and lift must not be negative"));
        }
        match &self.gusts {
            Some(g)
                if !(not_negative(g.speed) && positive(g.length) && g.time >= 1e-9 && positive(g.time)) =>
            {
                Err(DefError::new("gusts need a speed that is not negative, and a positive length and time"))
            }
            _ => Ok(()),
        }
    }

    /// Velocity of the air at a world point and time, m/s.
    pub fn at(&self, point: Vec3, nanoseconds: u64) -> Vec3 {
        match &self.gusts {
            None => self.velocity,
            Some(gusts) => self.velocity + gusts.at(point, nanoseconds),
        }
    }

    pub(super) fn act(&self, target: &Target<'_>, nanoseconds: u64, load: &mut Load) {
        if let Some(parts) = target.face_parts() {
            let stream = self.at(target.center(), nanoseconds) - target.velocity.linear;
            for area in parts {
                let (force, brake) = face_force(area, stream, self.density, self.drag, self.lift);
                load.push_at(Vec3::ZERO, force, brake);
            }
            return;
        }
        target.for_each_shape(|shape, at| {
            let air = self.at(at.translation, nanoseconds);
            let stream = air - target.velocity_at(at.translation);
            exposed(shape, at, stream, |panel| {
                let stream = air - target.velocity_at(panel.point);
                let (force, brake) = stream_force(&panel, stream, self.density, self.drag, self.lift);
                load.push_at(panel.point - target.center(), force, brake);
            });
        });
    }
}

impl Gusts {
    fn at(&self, point: Vec3, nanoseconds: u64) -> Vec3 {
        let period = u64::max((self.time * 1e9) as u64, 1);
        let (cell, within) = (nanoseconds / period, (nanoseconds % period) as f32 / period as f32);
        turbulence(point / self.length, (cell, within), self.seed) * self.speed
    }
}
