//! Definition of a mover.

use crate::body::shape::Filter;
use core::f32::consts::PI;
use sinew_geometry::DefError;
use sinew_math::Vec3;

/// A kinematic character mover: an upright capsule that walks, falls, jumps and pushes, with no body of its own.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
#[doc(alias = "character controller")]
#[doc(alias = "KinematicCharacterController")]
pub struct MoverDef {
    /// Lowest point of the capsule, world, metres. Default the origin.
    pub position: Vec3,
    /// Unit vector from feet to head, world. Default +y.
    pub up: Vec3,
    /// Radius of the capsule, metres. Default 0.3.
    pub radius: f32,
    /// Height of the capsule from end to end, metres, at least twice the radius. Default 1.8.
    pub height: f32,
    /// Mass in hits and for the weight on the ground, kg. Default 80.
    pub mass: f32,
    /// Force with which the mover pushes obstacles and holds riders, newtons. Default 800.
    pub push_force: f32,
    /// Height of the highest step that the mover climbs or follows down, metres. Default 0.35.
    pub step_height: f32,
    /// Slope of the steepest ground that the mover walks on, radians from level, below a right angle. Default 50°.
    pub slope_limit: f32,
    /// Largest acceleration on the ground, m/s². Default 60.
    pub ground_acceleration: f32,
    /// Largest acceleration in the air, m/s². A flying mover without a wanted velocity keeps its velocity. Default 10.
    pub air_acceleration: f32,
    /// Multiple of the world's gravity. Default 1.
    pub gravity_scale: f32,
    /// Distance between the mover and obstacles, metres, above 0 and below the radius. Default 5 mm.
    pub skin: f32,
    /// Filter of the shapes and other movers that the mover collides with. Default all.
    pub filter: Filter,
    /// Momentum up to which flying bodies (faster than 2 m/s) pass through the mover, N·s; a character's limbs collide
    /// with them instead. Bodies jointed to a static or kinematic body, such as a door, do not fly. Default 0.
    pub lets_pass: f32,
    /// Number for the user's own purposes. Default 0.
    pub user_data: u64,
}

impl Default for MoverDef {
    fn default() -> Self {
        Self {
            position: Vec3::ZERO,
            up: Vec3::Y,
            radius: 0.3,
            height: 1.8,
            mass: 80.0,
            push_force: 800.0,
            step_height: 0.35,
            slope_limit: 50.0 * PI / 180.0,
            ground_acceleration: 60.0,
            air_acceleration: 10.0,
            gravity_scale: 1.0,
            skin: 0.005,
            filter: Filter::default(),
            lets_pass: 0.0,
            user_data: 0,
        }
    }
}

impl MoverDef {
    /// Returns a mover of the default size with its feet at a position.
    pub fn at(position: Vec3) -> Self {
        Self { position, ..Self::default() }
    }

    /// Checks that the numbers of the definition are valid; the error phrase names the problem.
    ///
    /// # Errors
    /// Returns a phrase that names the problem, in lower case.
    pub fn check(&self) -> Result<(), DefError> {
        // The comparison is false for NaN.
        let positive = |x: f32| x > 0.0 && x < f32::INFINITY;
        let not_negative = |x: f32| (0.0..f32::INFINITY).contains(&x);
        if !self.position.is_finite() {
            return Err(DefError::new("a mover's position is finite"));
        }
        if !(0.9999..1.0001).contains(&self.up.length()) {
            return Err(DefError::new("a mover's up has length 1"));
        }
        if !(positive(self.radius) && positive(self.height) && self.height >= 2.0 * self.radius) {
            return Err(DefError::new("a mover's radius is above 0 and its height at least twice that"));
        }
        if !(positive(self.skin) && self.skin < self.radius) {
            return Err(DefError::new("a mover's skin is above 0 and below its radius"));
        }
        if !(positive(self.mass) && not_negative(self.push_force) && not_negative(self.step_height)) {
            return Err(DefError::new(
                "a mover's mass is above 0, its push force and step height are not negative",
            ));
        }
        if !(0.0..0.5 * PI).contains(&self.slope_limit) {
            return Err(DefError::new("a mover's slope limit is at least 0 and below a right angle"));
        }
        if !(not_negative(self.ground_acceleration) && not_negative(self.air_acceleration)) {
            return Err(DefError::new("a mover's accelerations are not negative"));
        }
        if !not_negative(self.lets_pass) {
            return Err(DefError::new("a mover lets pass a momentum that is finite and not negative"));
        }
        if !self.gravity_scale.is_finite() {
            return Err(DefError::new("a mover's gravity scale is finite"));
        }
        Ok(())
    }
}
