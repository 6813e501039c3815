//! Fields that the user writes.

use super::{Fields, Target};
use crate::body::force::Wrench;
use crate::registered::Registered;
use sinew_math::Vec3;

/// Number of parameters that a user's function is called with.
pub const PARAMETERS: usize = 8;

/// Input of a user's field function: something that it acts on, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldPoint {
    /// Centre of mass of a body, or position of a particle, world, metres.
    pub position: Vec3,
    /// m/s.
    pub velocity: Vec3,
    /// rad/s; 0 of a particle.
    pub angular_velocity: Vec3,
    /// kg.
    pub mass: f32,
    /// Number of steps taken before this one.
    pub step: u64,
    /// Time at the beginning of the step, seconds.
    pub time: f64,
}

/// Force and torque on an item at a point, from the field's parameters: a pure function, so that a snapshot of the
/// parameters contains everything that decides. A function pointer instead of a closure, because it must not have
/// state. For the same bits everywhere it must use only `+ − × ÷ √` and `sinew_math`. The torque is ignored for a
/// particle. A non-finite result quarantines the body.
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
