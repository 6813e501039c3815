//! Support forces of a hanging world.

use super::metric::{Expected, Metric};
use crate::parts::GRAVITY;
use sinew::math::{Vec3, max};
use sinew::physics::{BodyKind, JointId, World};

/// Joints to static bodies in a world without contacts. The sum of their forces must equal the world's weight plus the
/// rate of change of its momentum.
pub(crate) struct Support {
    /// Joints to static bodies; true if the joint's first body is the static one.
    joints: Vec<(JointId, bool)>,
    /// Weight of the world, N.
    weight: f32,
    /// Momentum of the world, N·s.
    momentum: Vec3,
    /// Largest error of the support force, as a share of the weight.
    error: f32,
}

impl Support {
    pub fn new(world: &World) -> Self {
        let is_static = |id| world.kind(id) == BodyKind::Static;
        let anchored = |id: JointId| {
            let (a, b) = world.joint_bodies(id);
            (is_static(a) || is_static(b)).then(|| (id, is_static(a)))
        };
        let mass: f32 = world.body_ids().map(|id| world.mass(id).mass).sum();
        Self {
            joints: world.joint_ids().filter_map(anchored).collect(),
            weight: mass * GRAVITY,
            momentum: world.momentum().linear,
            error: 0.0,
        }
    }

    pub fn after_step(&mut self, world: &World) {
        // The reaction of a joint acts on its second body.
        let on_world = |&(id, static_first): &(JointId, bool)| {
            let force = world.reaction(id).force;
            if static_first { force } else { -force }
        };
        let carried: Vec3 = self.joints.iter().map(on_world).sum();
        let momentum = world.momentum().linear;
        let gained = (momentum - self.momentum) / world.def().dt();
        self.momentum = momentum;
        let unexplained = carried + Vec3::NEG_Y * self.weight - gained;
        self.error = max(self.error, unexplained.length() / self.weight);
    }

    pub fn metric(&self) -> Metric {
        Metric::new("support_error", self.error, Expected::AtMost(0.001))
    }
}
