//! Free fall of connected bodies.

use super::metric::{Expected, Metric};
use crate::parts::GRAVITY;
use sinew::math::{Vec3, trig};
use sinew::physics::{BodyId, World};

/// Measures how the total momentum of some bodies changes until one of them hits another body. Only the bodies' weight
/// must change this momentum, not the forces of joints and contacts between them.
pub(crate) struct Flight {
    bodies: Vec<BodyId>,
    mass: f32,
    start: Vec3,
    /// Share of velocity lost per second, 1/s.
    damping: f32,
    fall: Option<f32>,
    landed: bool,
}

impl Flight {
    /// Creates the measurement, before the world's first step.
    pub fn new(world: &World, bodies: Vec<BodyId>) -> Self {
        Self::damped(world, bodies, 0.0)
    }

    /// Creates the measurement for bodies at rest that lose a share of their velocity per second.
    pub fn damped(world: &World, bodies: Vec<BodyId>, damping: f32) -> Self {
        let mass = bodies.iter().map(|&id| world.mass(id).mass).sum();
        let start = momentum(world, &bodies);
        Self { bodies, mass, start, damping, fall: None, landed: false }
    }

    pub fn after_step(&mut self, world: &World) {
        let is_other = |id| !self.bodies.contains(&id);
        self.landed |= self.bodies.iter().any(|&id| world.neighbors(id).any(is_other));
        if !self.landed {
            let gained = momentum(world, &self.bodies) - self.start;
            self.fall = Some(-gained.y / (self.mass * self.effective(world.time() as f32)));
        }
    }

    /// Returns true if one of the bodies has hit another body.
    pub fn landed(&self) -> bool {
        self.landed
    }

    /// Returns the time in which an undamped fall reaches the speed of this fall after `time` seconds: `(1 −
    /// e^(−c t)) / c`.
    fn effective(&self, time: f32) -> f32 {
        let c = self.damping;
        if c > 0.0 { (1.0 - trig::exp(-c * time)) / c } else { time }
    }

    /// Returns the mean acceleration until the first hit, compared with gravity.
    pub fn metric(&self) -> Metric {
        Metric::awaited("fall_m_s2", self.fall, Expected::near(GRAVITY, 1e-3))
    }
}

fn momentum(world: &World, bodies: &[BodyId]) -> Vec3 {
    bodies.iter().map(|&id| world.velocity(id).linear * world.mass(id).mass).sum()
}
