//! Particle groups in an island: field forces on the particles, and the bodies that a group may touch.

use crate::body::Body;
use crate::boxes::Overlap;
use crate::contact::proxies::Owner;
use crate::field::{Fields, Target};
use crate::particles::ParticleGroup;
use crate::solver::view::View;
use core::ops::ControlFlow;

/// A particle group, taken out of the world until `store`.
#[derive(Clone, Debug)]
pub(crate) struct TakenGroup {
    /// Index of the group in the world.
    pub index: u32,
    pub group: ParticleGroup,
    pub near: Neighbors,
}

impl TakenGroup {
    /// Lists the field forces on the particles at their present positions, N; each force is limited to one that stops its particle, see
    /// [`crate::field`].
    pub fn compute_field_forces(&mut self, fields: &Fields<'_>, h: f32) {
        self.group.outer_forces().clear();
        for i in 0..self.group.positions().len() {
            let target = Target::of_particle(&self.group, i);
            let weight = fields.gravity * (target.mass * target.gravity_scale);
            let force = fields.load(&target).beside(weight, target.mass, h);
            self.group.outer_forces().push(force);
        }
    }
}

/// Bodies that a group is attached to or may touch in this step, and their shapes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Neighbors {
    /// World body indices, ascending.
    pub bodies: Vec<u32>,
    /// Index in `bodies` and shape number of each nearby shape.
    pub shapes: Vec<(u32, u32)>,
    /// Body and shape of each nearby shape; a body without a shape for each particle that is attached to it or has a
    /// backstop on it.
    found: Vec<(u32, Option<u32>)>,
}

impl Neighbors {
    /// Finds all shapes whose bounds the group may reach within the step, and the bodies of attachments and backstops.
    pub fn find(&mut self, group: &ParticleGroup, view: &View<'_>) {
        let movers = view.activity.movers().map(|index| view.bodies.at(index));
        let reach = 0.02 + (group.fastest() + movers.fold(0.0, fastest_point)) * view.def.dt();
        let bounds = group.bounds().expand(reach);
        self.found.clear();
        let near = |Owner { body, shape }| {
            let id = view.bodies.id(body);
            let body = view.bodies.at(body);
            let frame = body.world_from_shape(shape as usize);
            // Particles attached to a quarantined body are attached to a fixed point.
            !body.quarantined
                && group.meets(id, body.surface(shape as usize))
                && body.shapes[shape as usize].shape.aabb(&frame).overlaps(&bounds)
        };
        let _ = view.proxies.overlapping(&bounds, |owner| {
            self.found.extend(near(owner).then_some((owner.body, Some(owner.shape))));
            ControlFlow::<()>::Continue(())
        });
        self.found.extend(group.carriers().map(|body| (body.index, None)));
        self.found.sort_unstable();
        self.list();
    }

    /// Converts the sorted list of found pairs to the lists of bodies and shapes.
    fn list(&mut self) {
        self.bodies.clear();
        self.shapes.clear();
        for &(body, shape) in &self.found {
            if self.bodies.last() != Some(&body) {
                self.bodies.push(body);
            }
            if let Some(shape) = shape {
                self.shapes.push((self.bodies.len() as u32 - 1, shape));
            }
        }
    }
}

fn fastest_point(most: f32, body: &Body) -> f32 {
    sinew_math::max(most, body.fastest_point())
}
