//! What the joints carry: from the momentum that the bodies gained beside the contacts.

use super::IslandSolver;
use super::limit_rows::add_row;
use super::tree::NONE;
use crate::spatial::{Vec6, ZERO6, add_scaled, angular, join, linear};

impl IslandSolver {
    /// Adds the impulses of this substep to the reactions of all joints: what the momentum of the subtree below gained
    /// since the forces acted, less what contacts and loops gave it. Torques are about the anchor of B. What
    /// saturated motors push counts among the forces, and adds itself.
    pub(super) fn add_reactions(&mut self) {
        if !self.is_articulated() {
            return;
        }
        let moving = self.links.len();
        self.scratch.impulses.clear();
        for i in 0..moving {
            let (body, v, before) = (&self.bodies[i], &self.velocities[i], &self.unconstrained[i]);
            let spin = body.angular_momentum(angular(v)) - body.momentum;
            let gained = join((linear(v) - linear(before)) * body.mass, spin);
            self.scratch.impulses.push(gained);
        }
        for rows in &self.manifolds {
            let push = rows.total_push();
            for (body, p) in [(rows.a, &push.0), (rows.b, &push.1)] {
                add_row(&mut self.scratch.impulses, body, p, -1.0);
            }
        }
        for k in 0..self.loops.joints.len() {
            let joint = &mut self.joints[self.loops.joints[k] as usize];
            let mut on_b = ZERO6;
            for row in 0..joint.rows.count {
                let impulse = joint.impulse[row];
                add_scaled(&mut on_b, &joint.rows.b[row], impulse);
                add_row(&mut self.scratch.impulses, joint.a, &joint.rows.a[row], -impulse);
                add_row(&mut self.scratch.impulses, joint.b, &joint.rows.b[row], -impulse);
            }
            joint.add_reaction(&on_b, joint.pose.arm_b);
        }
        self.pass_down();
    }

    /// Leaf to root: a joint gives its child what the child gained and what it passed on.
    fn pass_down(&mut self) {
        for i in (0..self.links.len()).rev() {
            let link = &self.links[i];
            if link.joint == NONE {
                continue;
            }
            let on_child = self.scratch.impulses[i];
            let (index, parent) = (link.joint as usize, link.parent as usize);
            let joint = &self.joints[index];
            let child_is_b = joint.b as usize == i;
            let (arm, other) = if child_is_b {
                (joint.pose.arm_b, joint.pose.arm_a)
            } else {
                (joint.pose.arm_a, joint.pose.arm_b)
            };
            // Torque at the anchor, then the same at the parent's centre.
            let torque = angular(&on_child) - arm.cross(linear(&on_child));
            if parent < self.links.len() {
                let through = join(linear(&on_child), torque + other.cross(linear(&on_child)));
                add_scaled(&mut self.scratch.impulses[parent], &through, 1.0);
            }
            let sign = if child_is_b { 1.0 } else { -1.0 };
            add_scaled(&mut self.joints[index].reaction, &join(linear(&on_child), torque), sign);
        }
    }
}

impl super::SolverJoint {
    /// Of an impulse on B at its centre, `arm` from its anchor.
    pub(super) fn add_reaction(&mut self, on_b: &Vec6, arm: sinew_math::Vec3) {
        let torque = angular(on_b) - arm.cross(linear(on_b));
        add_scaled(&mut self.reaction, &join(linear(on_b), torque), 1.0);
    }
}
