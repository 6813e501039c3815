//! Fields that the user writes.

use super::{Fields, Target};
use crate::body::force::Wrench;
use crate::registered::Registered;
use sinew_math::Vec3;

/// Number of parameters that a user's function is called with.
pub const PARAMETERS: usize = 8;

/// Input of a user's field function: the state of a body or particle, and the time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldPoint {
    /// Centre of mass of a body, or position of a particle, world, metres.
    pub position: Vec3,
    /// Velocity of the centre of mass, m/s, world.
    pub velocity: Vec3,
    /// Angular velocity, rad/s, world; 0 for a particle.
    pub angular_velocity: Vec3,
    /// Mass, kg.
    pub mass: f32,
    /// Number of steps taken before this one.
    pub step: u64,
    /// Time at the beginning of the step, seconds.
    pub time: f64,
}

/// Function for the force and torque on a body or particle at a point, from the field's parameters. It must be pure, so
/// that a snapshot of the parameters contains all state. It is a function pointer instead of a closure, because it must
/// not have state. For the same bits everywhere it must use only `+ − × ÷ √` and `sinew_math`. The torque is ignored
/// for a particle. A non-finite result quarantines the body.
pub type FieldFunction = fn(&FieldPoint, &[f32; PARAMETERS]) -> Wrench;

/// Field functions of a world.
pub(crate) type Functions = Registered<FieldFunction>;

impl Functions {
    pub(super) fn call(
        &self,
        number: u32,
        target: &Target<'_>,
        fields: &Fields<'_>,
        parameters: &[f32; PARAMETERS],
    ) -> Wrench {
        let point = FieldPoint {
            position: target.center(),
            velocity: target.velocity.linear,
            angular_velocity: target.velocity.angular,
            mass: target.mass,
            step: fields.step,
            time: fields.nanoseconds as f64 * 1e-9,
        };
        self.find(number).map_or(Wrench::default(), |function| function(&point, parameters))
    }
}
