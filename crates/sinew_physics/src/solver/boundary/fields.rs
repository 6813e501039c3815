//! Applies fields and lasting forces in `integrate_velocity`: the forces on bodies and particles that depend on their positions and
//! velocities at the beginning of a substep.

use crate::body::Velocity;
use crate::body::force::Wrench;
use crate::field::{Attractor, Target, attractor, least};
use crate::solver::IslandSolver;
use crate::solver::body::SolverBody;
use crate::solver::boundary::groups::TakenGroup;
use crate::solver::view::View;
use crate::spatial::{Vec6, angular, linear};
use sinew_math::Vec3;

/// Memory for bodies that attract each other.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct Attraction {
    /// The moving bodies, then the particles of the groups.
    attractors: Vec<Attractor>,
    forces: Vec<Vec3>,
}

impl IslandSolver {
    /// Records whether any force of this step depends on the motion within the step.
    pub(in crate::solver) fn look_for_fields(&mut self, view: &View<'_>) {
        let lasting = |body: &SolverBody| !view.bodies.at(body.index).forces.list.is_empty();
        self.forces_vary = !view.fields.is_empty() || self.bodies[..self.links.len()].iter().any(lasting);
    }

    /// Adds the forces at the beginning of a substep to bodies and particles, in addition to those that are constant for the whole step.
    pub(in crate::solver) fn add_fields(&mut self, view: &View<'_>, groups: &mut [TakenGroup]) {
        for (body, v) in self.bodies[..self.links.len()].iter_mut().zip(&self.velocities) {
            let load = view.fields.load(&target(view, body, v));
            let of = view.bodies.at(body.index);
            let lasting = of.forces.sum(of, body.pose);
            let other = Wrench { force: body.force + lasting.force, torque: body.torque + lasting.torque };
            let Wrench { force, torque } = load.with(other, body.mass, least(body.inertia), self.h);
            (body.force, body.torque) = (force, torque);
        }
        for taken in groups.iter_mut() {
            taken.compute_field_forces(&view.fields, self.h);
        }
        self.attract(view, groups);
    }

    /// Clears the field forces at the end of a substep.
    pub fn drop_fields(&mut self, view: &View<'_>) {
        if self.forces_vary {
            self.renew_forces(view);
        }
    }

    /// Applies equal and opposite forces to each attracting pair. The forces are not limited, since a limit would break conservation of
    /// momentum.
    fn attract(&mut self, view: &View<'_>, groups: &mut [TakenGroup]) {
        for (field, law) in view.fields.mutual() {
            let Attraction { attractors, forces } = &mut self.attraction;
            attractors.clear();
            let moving = self.bodies[..self.links.len()].iter().zip(&self.velocities);
            attractors.extend(moving.map(|(body, v)| attractor(field, &target(view, body, v))));
            for TakenGroup { group, .. } in groups.iter() {
                let particles = 0..group.positions().len();
                attractors.extend(particles.map(|i| attractor(field, &Target::of_particle(group, i))));
            }
            forces.clear();
            forces.resize(attractors.len(), Vec3::ZERO);
            law.attract(attractors, forces);
            let of_particles = groups.iter_mut().flat_map(|taken| taken.group.outer_forces().iter_mut());
            let of_bodies = self.bodies[..self.links.len()].iter_mut().map(|body| &mut body.force);
            for (sum, force) in of_bodies.chain(of_particles).zip(forces) {
                *sum += *force;
            }
        }
    }
}

fn target<'a>(view: &View<'a>, body: &SolverBody, v: &Vec6) -> Target<'a> {
    let velocity = Velocity { linear: linear(v), angular: angular(v) };
    Target::at(view.bodies.at(body.index), body.pose, velocity)
}
