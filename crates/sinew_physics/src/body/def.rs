//! Definitions of worlds and bodies, as plain data.

use crate::body::shape::{MassProperties, Shape, ShapeDef};
use crate::boxes::Obb;
use sinew_geometry::DefError;
use sinew_math::{Rotation, Vec3};

/// Settings of a world.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct WorldDef {
    /// Gravity, m/s². Default (0, −9.81, 0).
    pub gravity: Vec3,
    /// Length of one step in integer nanoseconds, which avoids drift. Default 1/60 s (16 666 667 ns).
    pub step_nanoseconds: u64,
    /// Substeps per step, at least 1. Default 4.
    pub substeps: u32,
    /// Step quality of bodies without [their own](BodyDef::quality). Default balanced.
    pub quality: Quality,
    /// Largest number of steps per [`World::update`](crate::World::update), at least 1, so that a delayed host, or
    /// steps slower than real time, cannot cause ever longer frames. Default 15, a quarter of a second of default
    /// steps.
    pub catch_up_steps: u32,
    /// Permission for bodies to fall asleep. Default yes.
    pub sleeping: Sleeping,
    /// Thresholds of motion below which an island is at rest.
    pub sleep_thresholds: SleepThresholds,
    /// Largest speed of a body, m/s. Enforced when forces act, before joints and contacts. Default 4,000.
    pub max_speed: f32,
    /// Largest rotation of a body per substep, radians. Beyond a quarter turn (the default, 377 rad/s at 1/60 s and 4
    /// substeps) rows linearised at the substep's start are invalid. Raise it for fast tops.
    pub max_turn: f32,
    /// Least approach speed along the contact normal for which [a hit](crate::Hit) is reported, m/s, ≥ 0. Default 1:
    /// resting and rolling bodies report none.
    pub hit_speed: f32,
}

/// Accuracy of a step against its cost. Joints are exact and contacts equally hard at every level; only the substep
/// length and the number of solver sweeps differ. `docs/performance.md` has a table of the effect.
///
/// An island (bodies connected by contacts and joints) uses the highest quality of its bodies. With particles, or if
/// the world has [objects](crate::PhysicsObject), the substeps are the world's, and only sweeps change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Quality {
    /// Half of the world's substeps unless masses differ by more than a factor of 100 or a body spins fast, and half of
    /// the sweeps: for crowds in the distance. Heaps of three and more jointed bodies keep the sweeps, but do not check
    /// limits ahead: in a crash, limbs pass their limits.
    Fast,
    /// Half of the world's substeps where many contacts damp all motion, otherwise all of them.
    #[default]
    Balanced,
    /// Twice the world's substeps and twice the sweeps: for films, robots and measurements.
    Exact,
}

/// Permission for bodies and particles at rest to fall asleep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Sleeping {
    /// Resting bodies fall asleep. Default.
    #[default]
    On,
    /// Resting bodies stay awake.
    Off,
}

/// Thresholds of rest: an island sleeps when each of its bodies has stayed in place for a time. A body that creeps by
/// more than twice the distance or by the angle within the time does not sleep; a body that vibrates within them may.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct SleepThresholds {
    /// Duration for which each body must stay in place, seconds, not negative. Default 0.5.
    pub time: f32,
    /// Distance from the position at the start of that time, metres, positive. Default 0.003: with the time, bodies
    /// that creep faster than 12 mm/s stay awake.
    pub distance: f32,
    /// Rotation from the orientation at the start of that time, radians, positive. Default 0.025: 0.05 rad/s.
    pub angle: f32,
    /// Speed above which a body is not at rest even in place, m/s, positive. Default 0.2.
    pub speed: f32,
    /// Angular speed above which a body is not at rest even in place, rad/s, positive. Default 1.
    pub spin: f32,
}

impl Default for SleepThresholds {
    fn default() -> Self {
        Self { time: 0.5, distance: 0.003, angle: 0.025, speed: 0.2, spin: 1.0 }
    }
}

impl Default for WorldDef {
    fn default() -> Self {
        Self {
            gravity: Vec3::new(0.0, -9.81, 0.0),
            step_nanoseconds: 16_666_667,
            substeps: 4,
            quality: Quality::Balanced,
            catch_up_steps: 15,
            sleeping: Sleeping::On,
            sleep_thresholds: SleepThresholds::default(),
            max_speed: 4000.0,
            max_turn: core::f32::consts::FRAC_PI_2,
            hit_speed: 1.0,
        }
    }
}

/// Longest step, nanoseconds.
const LONGEST_STEP: u64 = 1_000_000_000_000_000_000;
const MOST_SUBSTEPS: u32 = 1024;

impl WorldDef {
    /// Checks that the numbers of the definition are valid; the error phrase names the problem.
    ///
    /// # Errors
    /// Returns a phrase that names the problem, in lower case.
    pub fn check(&self) -> Result<(), DefError> {
        // The comparison is false for NaN.
        let positive = |x: f32| x > 0.0 && x < f32::INFINITY;
        if self.step_nanoseconds == 0 || self.substeps == 0 {
            return Err(DefError::new("a step must take time and have at least one substep"));
        }
        if self.step_nanoseconds > LONGEST_STEP || self.substeps > MOST_SUBSTEPS {
            return Err(DefError::new("a step must last at most 30 years and have at most 1,024 substeps"));
        }
        if self.catch_up_steps == 0 {
            return Err(DefError::new("the number of catch-up steps must be at least 1"));
        }
        if !self.gravity.is_finite() {
            return Err(DefError::new("gravity must be finite"));
        }
        if !(positive(self.max_speed) && positive(self.max_turn)) {
            return Err(DefError::new("the speed limits must be positive and finite"));
        }
        if !(0.0..f32::INFINITY).contains(&self.hit_speed) {
            return Err(DefError::new("the speed of a hit must be finite and not negative"));
        }
        let SleepThresholds { time, distance, angle, speed, spin } = self.sleep_thresholds;
        if !((0.0..f32::INFINITY).contains(&time) && [distance, angle, speed, spin].into_iter().all(positive))
        {
            return Err(DefError::new(
                "sleep thresholds must be positive and finite, and their time not negative",
            ));
        }
        Ok(())
    }

    /// Step length, seconds.
    pub fn dt(&self) -> f32 {
        self.step_nanoseconds as f32 * 1e-9
    }
}

/// Kind of a body: static, kinematic or dynamic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(alias = "RigidBodyType")]
#[doc(alias = "MotionType")]
pub enum BodyKind {
    /// Never moves.
    Static,
    /// Moves according to its velocity; contacts and forces do not affect it.
    Kinematic,
    /// Moves according to forces, contacts and joints.
    Dynamic,
}

/// Definition of a body.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
#[doc(alias = "RigidBody")]
#[doc(alias = "RigidBodyBuilder")]
pub struct BodyDef {
    /// Kind of the body. Default dynamic.
    pub kind: BodyKind,
    /// World position of the body's origin (not its centre of mass), metres.
    pub position: Vec3,
    /// Orientation, body to world.
    pub rotation: Rotation,
    /// Velocity of the centre of mass, m/s, world axes; ignored for a static body.
    pub linear_velocity: Vec3,
    /// Angular velocity, rad/s, world axes; ignored for a static body.
    pub angular_velocity: Vec3,
    /// Rate at which linear velocity decays, 1/s. Default 0.
    pub linear_damping: f32,
    /// Rate at which angular velocity decays, 1/s. Default 0.
    pub angular_damping: f32,
    /// Factor on the world's gravity. Default 1.
    pub gravity_scale: f32,
    /// Shapes; may be empty if `mass` is given.
    pub shapes: Vec<ShapeDef>,
    /// Mass, centre and inertia in the body's frame; `None`: from the shapes' densities.
    pub mass: Option<MassProperties>,
    /// Permission for the body, and its island, to fall asleep. Default yes.
    pub sleeping: Sleeping,
    /// Step quality of this body and its island; `None`: that of the [world](WorldDef::quality). Default `None`.
    pub quality: Option<Quality>,
    /// User data of the body; the library does not use it.
    pub user_data: u64,
}

impl Default for BodyDef {
    fn default() -> Self {
        Self {
            kind: BodyKind::Dynamic,
            position: Vec3::ZERO,
            rotation: Rotation::IDENTITY,
            linear_velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
            linear_damping: 0.0,
            angular_damping: 0.0,
            gravity_scale: 1.0,
            shapes: Vec::new(),
            mass: None,
            sleeping: Sleeping::On,
            quality: None,
            user_data: 0,
        }
    }
}

/// Shorthand constructors: `BodyDef::dynamic(shape).at(position)`. All other settings are fields.
impl BodyDef {
    /// A dynamic body of one shape, at the world's origin.
    pub fn dynamic(shape: impl Into<ShapeDef>) -> Self {
        Self { shapes: vec![shape.into()], ..Self::default() }
    }

    /// A kinematic body of one shape, at the world's origin.
    pub fn kinematic(shape: impl Into<ShapeDef>) -> Self {
        Self { kind: BodyKind::Kinematic, ..Self::dynamic(shape) }
    }

    /// A static body of one box. One such body for each of [`Cooked::boxes`](crate::cook::Cooked) makes a level. The
    /// broad phase stores shapes individually, so one body per box costs nothing extra, and every query about a body
    /// (overlap, neighbours, events) then concerns a single box.
    pub fn fixed_box(obb: &Obb) -> Self {
        let shape = Shape::Box { half_extents: obb.half_extents };
        Self { position: obb.center, rotation: obb.rotation, ..Self::fixed(shape) }
    }

    /// A static body of one shape, at the world's origin.
    pub fn fixed(shape: impl Into<ShapeDef>) -> Self {
        Self { kind: BodyKind::Static, ..Self::dynamic(shape) }
    }

    /// Sets the position of the body's origin (world, metres).
    #[must_use]
    pub fn at(self, position: Vec3) -> Self {
        Self { position, ..self }
    }

    /// Sets the body's orientation in the world.
    #[must_use]
    pub fn turned(self, rotation: Rotation) -> Self {
        Self { rotation, ..self }
    }

    /// Adds a shape.
    #[must_use]
    pub fn with(mut self, shape: impl Into<ShapeDef>) -> Self {
        self.shapes.push(shape.into());
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::shape::Shape;

    #[test]
    fn shorthand_constructors_equal_struct_fields() {
        let (ball, plank) = (Shape::Sphere { radius: 0.5 }, Shape::Box { half_extents: Vec3::ONE });
        let rotation = Rotation::from_axis_angle(Vec3::Y, 1.0);
        let heavy = ShapeDef { density: 7800.0, ..ShapeDef::new(plank.clone()) };
        let long = BodyDef {
            kind: BodyKind::Dynamic,
            position: Vec3::X,
            rotation,
            shapes: vec![ShapeDef::new(ball.clone()), heavy.clone()],
            ..BodyDef::default()
        };
        assert_eq!(BodyDef::dynamic(ball).with(heavy.clone()).at(Vec3::X).turned(rotation), long);
        let of = |kind| BodyDef { kind, shapes: vec![heavy.clone()], ..BodyDef::default() };
        assert_eq!(BodyDef::fixed(heavy.clone()), of(BodyKind::Static));
        assert_eq!(BodyDef::kinematic(heavy.clone()), of(BodyKind::Kinematic));
        assert_eq!(BodyDef::fixed(plank.clone()).shapes, [ShapeDef::new(plank)]);
    }
}
