//! Free fall of many bodies at once.

use super::metric::{Expected, Metric};
use super::parts::GRAVITY;
use sinew::math::Vec3;
use sinew::physics::{BodyKind, World};

/// Watches how the momentum of all bodies changes until one of them meets something static: by the weight alone,
/// whatever their joints and contacts do among themselves.
pub(super) struct Flight {
    start: Vec3,
    mass: f32,
    fall: Option<f32>,
    landed: bool,
}

impl Flight {
    /// Begins now.
    pub fn new(world: &World) -> Self {
        let mass = world.body_ids().map(|id| world.mass(id).mass).sum();
        Self { start: world.momentum().linear, mass, fall: None, landed: false }
    }

    pub fn after_step(&mut self, world: &World) {
        let is_static = |id| world.kind(id) == BodyKind::Static;
        let falling = world.body_ids().filter(|&id| world.kind(id) == BodyKind::Dynamic);
        self.landed |= falling.into_iter().any(|id| world.neighbors(id).any(is_static));
        if !self.landed {
            let gained = world.momentum().linear - self.start;
            self.fall = Some(-gained.y / (self.mass * world.time() as f32));
        }
    }

    /// Mean acceleration until the first touch, against gravity.
    pub fn metric(&self) -> Metric {
        Metric::awaited("fall_m_s2", self.fall, Expected::near(GRAVITY, 1e-3))
    }
}
