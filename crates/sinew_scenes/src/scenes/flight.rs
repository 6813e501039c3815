//! Free fall of bodies that hang together.

use super::metric::{Expected, Metric};
use super::parts::GRAVITY;
use sinew::math::Vec3;
use sinew::physics::{BodyId, World};

/// Watches how the momentum of some bodies changes until they meet another: by their weight alone, whatever their
/// joints and contacts do among themselves.
pub(super) struct Flight {
    bodies: Vec<BodyId>,
    mass: f32,
    start: Vec3,
    fall: Option<f32>,
    landed: bool,
}

impl Flight {
    /// Begins with the world's first step.
    pub fn new(world: &World, bodies: Vec<BodyId>) -> Self {
        let mass = bodies.iter().map(|&id| world.mass(id).mass).sum();
        let start = momentum(world, &bodies);
        Self { bodies, mass, start, fall: None, landed: false }
    }

    pub fn after_step(&mut self, world: &World) {
        let is_other = |id| !self.bodies.contains(&id);
        self.landed |= self.bodies.iter().any(|&id| world.neighbors(id).any(is_other));
        if !self.landed {
            let gained = momentum(world, &self.bodies) - self.start;
            self.fall = Some(-gained.y / (self.mass * world.time() as f32));
        }
    }

    /// Mean acceleration until then, against that of gravity.
    pub fn metric(&self) -> Metric {
        Metric::awaited("fall_m_s2", self.fall, Expected::near(GRAVITY, 1e-3))
    }
}

fn momentum(world: &World, bodies: &[BodyId]) -> Vec3 {
    bodies.iter().map(|&id| world.velocity(id).linear * world.mass(id).mass).sum()
}
