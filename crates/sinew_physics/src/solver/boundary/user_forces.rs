//! Effects of the user's force objects on the moving bodies of an island, between its stages.

use crate::solver::IslandSolver;
use crate::solver::body::advance;
use crate::solver::view::{View, lasting_force};
use crate::spatial::{Vec6, ZERO6, add_scaled, dot};
use sinew_math::Vec3;

impl IslandSolver {
    /// Resets the forces before a substep; clears those of the last substep.
    pub fn renew_forces(&mut self, view: &View<'_>) {
        let moving = self.links.len();
        for body in &mut self.bodies[..moving] {
            (body.force, body.torque) = lasting_force(view.bodies.at(body.index), view);
        }
    }

    /// Adds to the force (N) and to the torque about the centre of mass (N·m) that `integrate_velocity` applies.
    pub fn add_force(&mut self, local: usize, force: Vec3, torque: Vec3) {
        self.disturbed |= force != Vec3::ZERO || torque != Vec3::ZERO;
        let body = &mut self.bodies[local];
        body.force += force;
        body.torque += torque;
    }

    /// Applies an impulse to a single body before the substep; `solve` applies the joints' reaction.
    pub fn push_loose(&mut self, local: usize, impulse: &Vec6) {
        self.disturbed |= *impulse != ZERO6;
        let change = self.bodies[local].velocity_change(impulse);
        add_scaled(&mut self.velocities[local], &change, 1.0);
    }

    /// Applies an impulse through the joints after bodies have moved.
    pub fn push_held(&mut self, local: usize, impulse: &Vec6) {
        self.pushed_from_outside = true;
        self.disturbed |= *impulse != ZERO6;
        if let Some(accounted) = self.accounted.get_mut(local) {
            add_scaled(accounted, impulse, 1.0);
        }
        self.answer_one(local, impulse);
    }

    /// Applies an impulse through the joints after bodies have moved, and moves them as the impulse would have in the
    /// finished substep.
    pub fn correct(&mut self, local: usize, impulse: &Vec6) {
        let moving = self.links.len();
        self.scratch.before.clear();
        self.scratch.before.extend_from_slice(&self.velocities[..moving]);
        self.push_held(local, impulse);
        let changes = self.velocities.iter().zip(&self.scratch.before);
        for (body, (now, before)) in self.bodies.iter_mut().zip(changes) {
            let mut change = *now;
            add_scaled(&mut change, before, -1.0);
            if change != ZERO6 {
                body.pose = advance(&body.pose, &change, self.h);
            }
        }
        self.displaced = true;
    }

    /// Response of a row on a body to the row's own impulse, including the tree joints.
    pub fn response_along(&mut self, local: usize, row: &Vec6) -> f32 {
        if !self.has_joints() {
            return dot(row, &self.bodies[local].velocity_change(row));
        }
        let s = &mut self.scratch;
        for list in [&mut s.impulses, &mut s.residuals, &mut s.dv] {
            list.clear();
            list.resize(self.links.len(), ZERO6);
        }
        s.impulses[local] = *row;
        self.answer_trees();
        dot(row, &self.scratch.dv[local])
    }

    /// True if a force object acted on the island in this step.
    pub fn is_disturbed(&self) -> bool {
        self.disturbed
    }

    fn answer_one(&mut self, local: usize, impulse: &Vec6) {
        self.scratch.impulses.clear();
        self.scratch.impulses.resize(self.links.len(), ZERO6);
        self.scratch.impulses[local] = *impulse;
        self.answer_impulses();
    }
}
