//! Buoyancy and drag of a fluid.

use super::def::not_negative;
use super::exposed::{exposed, stream_force};
use super::{Load, Target, WaterPlane};
use crate::body::shape::Shape;
use sinew_geometry::DefError;
use sinew_math::{Transform, Vec3};

/// A fluid below a plane, at rest or in uniform flow.
///
/// *Buoyancy* (Archimedes): the weight of the displaced fluid, `−ρ V g`, at the centre of the submerged volume, with
/// `g` the world's gravity. Volume and centre are computed per shape in closed form (ball, box, capsule); overlapping
/// shapes displace twice. A body of density `ρ_b` floats with the share `ρ_b/ρ` submerged, and the lever between the
/// two centres rights it.
///
/// *Drag*, in proportion to the submerged share of the shape. Linear: the displaced fluid moves along as a body of the
/// same form, and loses its relative velocity and spin at a rate of `damping` per second: `F = −c ρ V w`,
/// `τ = −c ρ J ω` with `J` the shape's moment of volume. Quadratic: as for [`Wind`](super::Wind), `½ ρ C_d A |w|²`.
/// With linear drag alone, a sinking body reaches `(ρ_b/ρ − 1) g / c`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Buoyancy {
    /// Pose of the surface: the fluid is below y = 0 in this frame. Default: y = 0 of the world.
    pub world_from_surface: Transform,
    /// Density ρ of the fluid, kg/m³, ≥ 0. Default 1000: fresh water.
    pub density: f32,
    /// Velocity of the fluid, m/s, world. Default 0.
    pub flow: Vec3,
    /// Linear damping c, 1/s, ≥ 0. Default 1.
    pub damping: f32,
    /// Drag coefficient C_d, ≥ 0. Default 0.5.
    pub drag: f32,
}

impl Default for Buoyancy {
    fn default() -> Self {
        Self {
            world_from_surface: Transform::IDENTITY,
            density: 1000.0,
            flow: Vec3::ZERO,
            damping: 1.0,
            drag: 0.5,
        }
    }
}

impl Buoyancy {
    pub(super) fn check(&self) -> Result<(), DefError> {
        if !(super::def::is_pose(&self.world_from_surface) && self.flow.is_finite()) {
            return Err(DefError::new("a surface and its flow must be finite"));
        }
        let valid = not_negative(self.density) && not_negative(self.damping) && not_negative(self.drag);
        if valid {
            Ok(())
        } else {
            Err(DefError::new("a fluid's density, damping and drag must not be negative"))
        }
    }

    fn plane(&self) -> WaterPlane {
        let normal = self.world_from_surface.rotation * Vec3::Y;
        WaterPlane { normal, height: normal.dot(self.world_from_surface.translation) }
    }

    pub(super) fn act(&self, target: &Target<'_>, gravity: Vec3, load: &mut Load) {
        let plane = self.plane();
        target.for_each_shape(|shape, at| {
            let submerged = shape.submerged(at, &plane);
            if submerged.volume > 0.0 {
                let arm = submerged.center() - target.center();
                load.push_at(arm, -gravity * (self.density * submerged.volume), 0.0);
                self.brake(target, shape, at, arm, submerged.volume, load);
            }
        });
    }

    /// Adds the drag on a shape with `volume` under water, centred at `arm` from the centre of mass.
    fn brake(
        &self,
        target: &Target<'_>,
        shape: &Shape,
        at: &Transform,
        arm: Vec3,
        volume: f32,
        load: &mut Load,
    ) {
        let stream = |point: Vec3| self.flow - target.velocity_at(point);
        let rate = self.damping * self.density * volume;
        load.push_at(arm, stream(target.center() + arm) * rate, rate);
        let share = volume / shape.volume();
        let moment = shape.mass_properties(self.density * share).inertia.rotated(at.rotation);
        load.wrench.torque -= moment * target.velocity.angular * self.damping;
        let d = moment.diagonal;
        load.spin_resistance += self.damping * (d.x + d.y + d.z);
        if self.drag > 0.0 {
            exposed(shape, at, stream(at.translation), |panel| {
                let (force, brake) = stream_force(&panel, stream(panel.point), self.density, self.drag, 0.0);
                load.push_at(panel.point - target.center(), force * share, brake * share);
            });
        }
    }

    /// Potential energy of the displaced fluid, J: `ρ |g| V` times the depth of its centre.
    pub(super) fn energy(&self, target: &Target<'_>, gravity: Vec3) -> f32 {
        let plane = self.plane();
        let pull = -gravity.dot(plane.normal);
        let mut sum = 0.0;
        target.for_each_shape(|shape, at| {
            let submerged = shape.submerged(at, &plane);
            sum -= self.density * pull * submerged.volume * plane.above(submerged.center());
        });
        sum
    }
}
